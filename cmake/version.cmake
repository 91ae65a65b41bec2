# Writes version.cpp, with the commit that is built, whenever that changed:
#   cmake -DSOURCE= -DTEMPLATE= -DOUTPUT= -DPROJECT_VERSION= -DCOMPILER= -P version.cmake
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  set(COMMIT "unknown commit")
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)

# Installs the build into an empty prefix, builds the consumer against it, and runs it.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()

set(folder ${BUILD}/tests/package-consumer)
file(REMOVE_RECURSE ${folder})
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
must(${CMAKE_COMMAND} -S ${CONSUMER} -B ${folder}/build -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_PREFIX_PATH=${folder}/prefix -DSANITIZE=${SANITIZE} -DEXAMPLE=${EXAMPLE})
must(${CMAKE_COMMAND} --build ${folder}/build)
must(${folder}/build/consumer ${DATA}/distances.csv ${DATA}/poses.csv)
must(${folder}/prefix/bin/paracal reproduce huang2016)

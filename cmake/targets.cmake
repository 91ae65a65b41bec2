# The library does the mathematics; what calls it is built for a short build. Of the inline functions that both have, Eigen's above all, the
# linker takes those that it meets first: the library's.
function(paracal_target_is_not_hot target)
  target_compile_options(${target} PRIVATE $<IF:$<CONFIG:Release>,-O1,-O0>)
  target_link_options(${target} PRIVATE "LINKER:--whole-archive,$<TARGET_FILE:paracal>,--no-whole-archive")
endfunction()

# What every target of this project is compiled with; nothing global, so that a parent project keeps its own flags.
function(paracal_target_defaults target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms of GCC 12 inside std::string (gcc.gnu.org bugs 105329 and 105651).
    target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-restrict)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")  # ccache: what was precompiled at another time is the same
  endif()
  if(PARACAL_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(PARACAL_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PARACAL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(PARACAL_NO_SANITIZE)
      target_compile_options(${target} PRIVATE -fno-sanitize=${PARACAL_NO_SANITIZE})
    endif()
    target_link_options(${target} PRIVATE -fsanitize=${PARACAL_SANITIZE})
  endif()
endfunction()

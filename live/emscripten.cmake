# What the live page's program is built with, given to CMake before the project (CMAKE_PROJECT_TOP_LEVEL_INCLUDES; preset live).
# CMakeLists.txt asks for packages as ever; here stands where they come from, as Debian's own are of another machine:
# headers by links in a folder of their own, four small libraries from the sources of their Debian packages
# (tools/live_page.sh fetches them), and oneTBB as its few calls one after another.
set(live ${CMAKE_CURRENT_LIST_DIR})
set(live_headers ${CMAKE_BINARY_DIR}/headers)
set(live_sources ${CMAKE_BINARY_DIR}/sources CACHE PATH "Unpacked sources of Debian: fmtlib, libcsv, libmd, nlopt")

file(MAKE_DIRECTORY ${live_headers})
foreach(name IN ITEMS boost CLI concepts eigen3 fast_float meta nlohmann range Random123 std toml++)
  file(CREATE_LINK /usr/include/${name} ${live_headers}/${name} SYMBOLIC)
endforeach()

# live_source(VARIABLE PATTERN): the one file or folder of the sources that fits.
function(live_source variable pattern)
  file(GLOB found ${live_sources}/${pattern})
  list(LENGTH found count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "${live_sources}/${pattern}: expected one, got ${count}; tools/live_page.sh fetches it")
  endif()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

# live_imported(TARGET LIBRARY): as if it had been found; what is exported of the project names it and does not ask where it is from.
function(live_imported target library)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_link_libraries(${target} INTERFACE ${library})
endfunction()

# live_library(NAME INCLUDES FILE...)
function(live_library name includes)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} SYSTEM PUBLIC ${includes})
  target_compile_features(${name} PUBLIC cxx_std_20)  # standard.hpp
endfunction()

macro(live_find_NLopt)
  enable_language(C)
  foreach(part IN ITEMS BUILD_SHARED_LIBS NLOPT_CXX NLOPT_GUILE NLOPT_MATLAB NLOPT_OCTAVE NLOPT_PYTHON NLOPT_SWIG WITH_THREADLOCAL)
    set(${part} OFF CACHE BOOL "" FORCE)
  endforeach()
  live_source(lists nlopt-*/CMakeLists.txt)
  get_filename_component(folder ${lists} DIRECTORY)
  add_subdirectory(${folder} ${CMAKE_BINARY_DIR}/nlopt EXCLUDE_FROM_ALL)
  live_imported(NLopt::nlopt nlopt)
endmacro()

macro(live_find_fmt)
  live_source(format fmtlib-*/src/format.cc)
  get_filename_component(folder ${format} DIRECTORY)
  live_library(live-fmt ${folder}/../include ${format} ${folder}/os.cc)
  live_imported(fmt::fmt live-fmt)
endmacro()

# Of pkg-config nothing is asked but libmd, of libmd nothing but SHA-256, which asks its config.h for one header.
macro(live_find_PkgConfig)
  macro(pkg_check_modules)
    live_source(sha2 libmd-*/src/sha2.c)
    get_filename_component(folder ${sha2} DIRECTORY)
    file(WRITE ${CMAKE_BINARY_DIR}/libmd/config.h "#define HAVE_UNISTD_H 1\n")
    live_library(live-md ${folder}/../include ${sha2} ${folder}/sha256hl.c)
    target_include_directories(live-md PRIVATE ${CMAKE_BINARY_DIR}/libmd)
    live_imported(PkgConfig::libmd live-md)
  endmacro()
  live_source(csv libcsv-*/libcsv.c)
  get_filename_component(LIBCSV_INCLUDE_DIR ${csv} DIRECTORY)
  live_library(live-csv ${LIBCSV_INCLUDE_DIR} ${csv})
  set(LIBCSV_LIBRARY live-csv)
endmacro()

macro(live_provide method package)
  set(CMAKE_CXX_COMPILE_OPTIONS_PIC "")  # nothing here is a shared object
  if(COMMAND live_find_${package})
    cmake_language(CALL live_find_${package})
  elseif("${package}" STREQUAL "TBB")
    add_library(TBB::tbb INTERFACE IMPORTED GLOBAL)  # live/include
  elseif("${package}" STREQUAL "Eigen3")
    add_library(Eigen3::Eigen INTERFACE IMPORTED GLOBAL)
    target_include_directories(Eigen3::Eigen SYSTEM INTERFACE ${live_headers}/eigen3)
  else()
    add_library(${package}::${package} INTERFACE IMPORTED GLOBAL)  # headers alone
  endif()
  set(${package}_FOUND TRUE)
endmacro()
cmake_language(SET_DEPENDENCY_PROVIDER live_provide SUPPORTED_METHODS FIND_PACKAGE)

# Exceptions of WebAssembly itself are smaller and quicker than those that go through JavaScript.
set(CMAKE_C_FLAGS_INIT -fwasm-exceptions)
set(CMAKE_CXX_FLAGS_INIT "-fwasm-exceptions -isystem ${live_headers} -I${live}/include -include standard.hpp -Xclang -fno-pch-timestamp")
# A module without a page or a place of its own: whoever loads it gives it files and a command (web/src/live).
list(APPEND settings -fwasm-exceptions -sMODULARIZE -sEXPORT_NAME=paracal -sINVOKE_RUN=0 -sEXIT_RUNTIME=1 -sFORCE_FILESYSTEM
  -sEXPORTED_RUNTIME_METHODS=FS,callMain -sALLOW_MEMORY_GROWTH -sABORTING_MALLOC -sDYNAMIC_EXECUTION=0 -sENVIRONMENT=web,worker,node)
list(JOIN settings " " CMAKE_EXE_LINKER_FLAGS_INIT)

# live/real_malloc.cpp says why; when all targets are there.
macro(live_own_malloc)
  set_property(TARGET paracal-app PROPERTY LINK_OPTIONS "")
  target_sources(paracal-app PRIVATE ${live}/real_malloc.cpp)
endmacro()
cmake_language(DEFER CALL live_own_malloc)

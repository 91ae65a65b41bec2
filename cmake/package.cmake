# Debian packages (tools/package.sh): paracal, libparacal-dev and, where a component `python` is installed, python3-paracal.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME paracal)
set(CPACK_PACKAGE_VENDOR "The paracal authors")
set(CPACK_PACKAGE_CONTACT "The paracal authors <paracal@localhost>" CACHE STRING "Who makes the packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(about "paracal says how far off a Delta or a four-limb pick-and-place robot is, which
dimensions it really has, and which joint angles bring it where you meant:
tolerance design, calibration with honest uncertainties, compensation.")
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME paracal)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${about}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libparacal-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libeigen3-dev, libfmt-dev, libtbb-dev, libnlopt-dev, libmd-dev, libcsv-dev, libtomlplusplus-dev, nlohmann-json3-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${about}\n.\nThis package is for programs that are built with it.")
get_cmake_property(components COMPONENTS)
if(python IN_LIST components)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-paracal)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "${about}")
endif()

# What Debian asks of every package: who may use it, what has changed, and, where its checker is not to be believed, why.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(made ${CMAKE_CURRENT_BINARY_DIR}/packaging/${package})
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES ${made}/copyright ${made}/changelog.Debian.gz DESTINATION ${documents} COMPONENT ${component} OPTIONAL)
  install(FILES ${made}/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${package}
    COMPONENT ${component} OPTIONAL)
endforeach()
include(CPack)

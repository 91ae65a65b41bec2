include(CMakePackageConfigHelpers)

install(TARGETS paracal EXPORT paracal-targets)
install(DIRECTORY include/paracal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT paracal-targets NAMESPACE paracal:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal)
configure_package_config_file(cmake/paracal-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/paracal-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/paracal-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/paracal-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/paracal-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal)
if(TARGET paracal-app)
  install(TARGETS paracal-app)
endif()

# Components: `program`, with its manual pages, completions, samples and schemas; `development`, the library; `mpi`, the program for many computers.
include(CMakePackageConfigHelpers)

install(TARGETS paracal EXPORT paracal-targets COMPONENT development)
install(DIRECTORY include/paracal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT paracal-targets NAMESPACE paracal:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal COMPONENT development)
configure_package_config_file(cmake/paracal-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/paracal-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/paracal-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/paracal-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/paracal-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/paracal COMPONENT development)
file(RELATIVE_PATH PARACAL_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)  # so that a prefix may be moved
configure_file(cmake/paracal.pc.in ${CMAKE_CURRENT_BINARY_DIR}/paracal.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/paracal.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(TARGET paracal-app)
  install(TARGETS paracal-app COMPONENT program)
  if(TARGET paracal-mpi)
    install(TARGETS paracal-mpi COMPONENT mpi)
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/paracal-mpi.1 ".so man1/paracal.1\n")
    execute_process(COMMAND gzip -9nf ${CMAKE_CURRENT_BINARY_DIR}/paracal-mpi.1)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/paracal-mpi.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT mpi)
  endif()
  set(manual ${CMAKE_CURRENT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual}/made WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}  # a relative name below: qemu reads / as that of arm64
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual} COMMAND ${CMAKE_COMMAND} -E make_directory ${manual}
    COMMAND paracal-app manual manual COMMAND gzip -9n ${manual}/*.1 COMMAND ${CMAKE_COMMAND} -E touch ${manual}/made
    DEPENDS paracal-app)
  add_custom_target(paracal-manual ALL DEPENDS ${manual}/made)
  install(DIRECTORY ${manual}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program FILES_MATCHING PATTERN *.1.gz)
  install(FILES ${manual}/paracal.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME paracal COMPONENT program)
  install(FILES ${manual}/paracal.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
  install(CODE [[
    set(zsh_folder site-functions)
    if(CMAKE_INSTALL_PREFIX STREQUAL /usr)
      set(zsh_folder vendor-completions)  # Debian's, of packages
    endif()]] COMPONENT program)
  install(FILES ${manual}/_paracal DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/\${zsh_folder}" COMPONENT program)
  install(DIRECTORY schema/ DESTINATION ${CMAKE_INSTALL_DATADIR}/paracal/schema COMPONENT program)
  install(DIRECTORY build/site/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/paracal/html COMPONENT program OPTIONAL)  # tools/site.sh
  install(DIRECTORY samples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/paracal/samples COMPONENT program)
  install(FILES data/huang2016/poses.csv data/huang2016/distances.csv data/huang2016/offsets.toml
    DESTINATION ${CMAKE_INSTALL_DATADIR}/paracal/samples COMPONENT program)
endif()

# paracal_embed(NAME FOLDER OUTPUT): a C++ file that holds every .csv, .toml, .h and .comp file of FOLDER as text, so that an installed program
# carries its published data and the templates of its exports. Declares
#   std::span<const EmbeddedFile> paracal::detail::NAME();      see src/embedded.hpp
function(paracal_embed name folder output)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.csv ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.toml
       ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.h ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.comp)
  set(entries "")
  foreach(path IN LISTS files)
    get_filename_component(file_name ${path} NAME)
    file(READ ${path} text)
    string(APPEND entries "    {\"${file_name}\", R\"~~~(${text})~~~\"},\n")
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  string(CONCAT code
    "#include \"embedded.hpp\"\n\nnamespace paracal::detail {\n\n"
    "std::span<const EmbeddedFile> ${name}() {\n"
    "  static constexpr EmbeddedFile kFiles[] = {\n${entries}  };\n  return kFiles;\n}\n\n"
    "}  // namespace paracal::detail\n")
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${output} CONTENT "${code}" @ONLY)
endfunction()

# Writes the C++ file of paracal_embed(): cmake -DNAME= -DOUTPUT= -DFILES=a|b -P embed_files.cmake
# The literals are views ("..."sv), so that no compiler has to count a page's length.
string(REPLACE "|" ";" files "${FILES}")
set(entries "")
foreach(path IN LISTS files)
  get_filename_component(file_name ${path} NAME)
  file(READ ${path} text)
  string(APPEND entries "    {\"${file_name}\", R\"~~~(${text})~~~\"sv},\n")
endforeach()
file(WRITE ${OUTPUT}
  "#include \"embedded.hpp\"\n\nnamespace paracal::detail {\n\nusing namespace std::string_view_literals;\n\n"
  "std::span<const EmbeddedFile> ${NAME}() {\n"
  "  static constexpr EmbeddedFile kFiles[] = {\n${entries}  };\n  return kFiles;\n}\n\n"
  "}  // namespace paracal::detail\n")

# paracal_embed(NAME OUTPUT FILE...): a C++ file, made at build time, that holds the files as text, so that an installed program carries
# its published data, the templates of its exports and the page of its reports. Declares
#   std::span<const EmbeddedFile> paracal::detail::NAME();      see src/embedded.hpp
set(PARACAL_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_files.cmake)
function(paracal_embed name output)
  list(JOIN ARGN "|" files)  # a semicolon would end the argument
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DNAME=${name} -DOUTPUT=${output} "-DFILES=${files}" -P ${PARACAL_EMBED_SCRIPT}
    DEPENDS ${ARGN} ${PARACAL_EMBED_SCRIPT} VERBATIM)
endfunction()

#pragma once

#include <span>
#include <string_view>

namespace paracal::detail {

/// A data file compiled into the program (cmake/embed.cmake).
struct EmbeddedFile {
  std::string_view name;
  std::string_view text;
};

/// The files of data/huang2016.
std::span<const EmbeddedFile> published_data();
/// The files of src/compensation/templates.
std::span<const EmbeddedFile> export_templates();

}  // namespace paracal::detail

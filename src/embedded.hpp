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
/// The files of data/robots.
std::span<const EmbeddedFile> robot_templates();
/// The files of src/compensation/templates.
std::span<const EmbeddedFile> export_templates();
/// The files of schema.
std::span<const EmbeddedFile> result_schemas();
/// The texts of paracal help TOPIC, in the program alone.
std::span<const EmbeddedFile> help_topics();
/// The page of reports, built from web/; in the program alone, so that the library needs no Node.js to build.
std::span<const EmbeddedFile> report_page();
/// The licences of the libraries that the program is made of, and of what is in the page; in the program alone.
std::span<const EmbeddedFile> licences();

}  // namespace paracal::detail

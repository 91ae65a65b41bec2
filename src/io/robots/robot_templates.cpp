#include <fmt/format.h>
#include <fmt/ranges.h>

#include "embedded.hpp"
#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"

namespace paracal::io {
namespace {

std::string_view kind_of(const detail::EmbeddedFile& file) { return file.name.substr(0, file.name.find('.')); }

}  // namespace

std::vector<std::string> robot_templates() {
  std::vector<std::string> kinds;
  kinds.reserve(detail::robot_templates().size());
  for (const detail::EmbeddedFile& file : detail::robot_templates()) kinds.emplace_back(kind_of(file));
  return kinds;
}

TextFile robot_template(std::string_view kind) {
  for (const detail::EmbeddedFile& file : detail::robot_templates()) {
    if (kind_of(file) == kind) return {std::string(file.name), std::string(file.text)};
  }
  throw InvalidArgument(
      fmt::format("expected a kind of robot ({}), got \"{}\"", fmt::join(robot_templates(), ", "), kind));
}

}  // namespace paracal::io

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace paracal::io {

/// A file's text together with the name that messages use.
struct TextFile {
  std::string name;
  std::string text;
};

/// @throws InputFileError when the file cannot be read.
TextFile read_file(const std::filesystem::path& path);

/// Writes the file whole or not at all: into a neighbour first, which is then renamed over it.
/// A link stays and its target is replaced, keeping its mode; pipes and devices are written into.
/// @throws Error when the folder cannot be written; what stood at `path` is then still there.
void write_file(const std::filesystem::path& path, std::string_view text);

/// SHA-256 in hexadecimal.
std::string sha256(std::string_view text);

}  // namespace paracal::io

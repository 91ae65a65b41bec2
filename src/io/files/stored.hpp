#pragma once

// Private to io and jobs: files that other runs of the program read again, as JSON, TOML or chunks of a job.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "paracal/io/json.hpp"

namespace paracal::io {

/// What a file may hold that is loaded as a whole. Nobody writes more; more would cost memory and time without end.
struct StoredLimits {
  std::size_t bytes = std::size_t{128} << 20;
  std::size_t toml_bytes = std::size_t{1} << 20;  ///< its parser takes 16 bytes and more for each; robots have 10 kB
  int levels = 64;                                ///< followed by recursion, which the stack limits
  std::size_t keys = 256;  ///< of a JSON object, where each new key is compared with all; ours have up to 60
  /// Memory of parsed JSON: so many times its text, and as much for any.
  std::size_t memory_per_byte = 8, memory_of_any = std::size_t{16} << 20;
};
inline constexpr StoredLimits kStoredLimits;

/// The bytes of a regular file.
/// @throws InputFileError for a folder, pipe or device, or one that is too long.
std::string stored_bytes(const std::filesystem::path& path);

/// A file that another file includes.
/// @throws InputFileError also for a file of another user in a folder that everybody fills, such as /tmp.
TextFile read_included(const std::filesystem::path& path);

/// Line of a byte of a text, from 1.
int line_at(std::string_view text, std::size_t byte);

/// Line of the first dotted key of a TOML text with more than StoredLimits::levels parts, from 1.
std::optional<int> line_of_endless_key(std::string_view text);

/// Line of the first value of a TOML text within more than StoredLimits::levels others, from 1.
std::optional<int> line_of_deep_nesting(std::string_view text);

}  // namespace paracal::io

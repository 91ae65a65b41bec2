#pragma once

// Private to io: files by their descriptors.

#include <filesystem>
#include <string_view>

namespace paracal::io {

/// @throws Error with what errno says.
[[noreturn]] void fail_to_write(const std::filesystem::path& path);

/// @param path  for the message.
/// @throws Error when it cannot be written to its end.
void write_all(int descriptor, std::string_view text, const std::filesystem::path& path);

}  // namespace paracal::io

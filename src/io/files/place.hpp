#pragma once

// Private to io: where a path leads, links included.

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "descriptor.hpp"

namespace paracal::io {

/// What a path names: an entry of a folder, reached through the folder, whatever happens to the path meanwhile.
struct Place {
  Descriptor folder = {};           ///< open with O_PATH
  std::string name = {};            ///< in the folder
  std::filesystem::path path = {};  ///< of the entry, as far as its links were followed
  struct stat entry {};             ///< all zero: there is none yet
  bool is_link_of_kernel = false;   ///< a link of /proc to an open file: only the kernel can follow it
  int error = 0;                    ///< errno where it cannot be reached; then nothing else counts
  bool is_foreign = false;          ///< this is why

  bool is_reached() const { return error == 0; }
  bool exists() const { return entry.st_mode != 0; }
  bool is_regular() const { return S_ISREG(entry.st_mode); }
  bool is_folder() const { return S_ISDIR(entry.st_mode); }

  /// Why it cannot be reached, in words.
  std::string why_not() const;

  /// Opens the entry itself, never through a link.
  /// @param flags  as of open().
  Descriptor open(int flags) const;
};

enum class Use : std::uint8_t { read, read_included, write };

/// Follows a path. In a folder to which everybody can write, links of other users are not used. If the folder is
/// sticky, as /tmp, their files are not written either, and not read if another file includes them. Their owners could
/// lead a program of root to any file. Linux has this rule as fs.protected_symlinks and fs.protected_regular, but not
/// every system switches it on.
/// @returns a place without an entry, too, if all folders before it are there.
/// @throws InvalidArgument for a path with a zero character, behind which the kernel reads nothing.
Place place_of(const std::filesystem::path& path, Use use);

}  // namespace paracal::io

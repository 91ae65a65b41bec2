#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

class StoredFile;

/// The file that a new file replaces, if that matters.
struct Replaced {
  std::string sha256 = {};   ///< of the file as it was read; if it has changed since, it stays
  std::string kept_as = {};  ///< new name of the old file in the same folder; empty: it is deleted
};

/// Writes files together: either all of them completely, or none. All files are written by this class.
///
/// Their text is first in unnamed files (Spool). commit() writes a file `.paracal-...` beside each target, flushes it
/// to the disk and exchanges it with the target, in one step if the file system supports that. Otherwise the old file
/// is copied first and restored if one of the files fails. SIGINT, SIGTERM and SIGHUP wait meanwhile (SignalsWait), and
/// no memory is allocated.
///
/// A new file takes owner, group, mode and extended attributes of the old one, if file system and process permit. A
/// file with another group does not become more readable. A link stays, and its target is replaced or created; pipes
/// and devices are written directly. A folder that is moved meanwhile takes the files with it. A file system may refuse
/// hard links, modes and fsync.
class Store {
 public:
  Store();
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// For a file that is written piece by piece; valid until commit().
  /// @throws Error when the folder cannot be written; so do the others.
  TextSink begin(const std::filesystem::path& path, Replaced replaced = {});
  void write(const std::filesystem::path& path, std::string_view text, Replaced replaced = {}) {
    begin(path, std::move(replaced))(text);
  }
  /// Puts all files into their places. If one fails, the earlier files are restored.
  /// @throws Error that also states where an earlier file is that could not be restored.
  void commit();

 private:
  std::vector<std::unique_ptr<StoredFile>> files_;
};

/// A store of one file.
void write_file(const std::filesystem::path& path, std::string_view text);

/// The same, unless the path exists: then it stays.
/// @returns whether the file was written.
bool write_new_file(const std::filesystem::path& path, std::string_view text);

/// A folder, unless it is there.
/// @returns whether it is new.
/// @throws Error when it cannot be made.
bool make_folder(const std::filesystem::path& path);

/// The same with all folders before it.
bool make_folders(const std::filesystem::path& path);

}  // namespace paracal::io

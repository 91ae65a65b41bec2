#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

class StoredFile;

/// What a new file finds in its place, where that matters.
struct Replaced {
  std::string sha256 = {};   ///< of what was read there; where anything else stands there by now, it stays
  std::string kept_as = {};  ///< a new name in the same folder, under which what stood there stays; empty: it goes
};

/// The one way in which files are written: files that come to be together, each whole, or none.
///
/// Their text waits where no name leads to it (Spool). commit() writes a neighbour of each, `.paracal-...`, brings it
/// onto the disk and exchanges it with what stands in its place, in one step where the file system can; elsewhere what
/// stood there is copied first and comes back where one of the files fails. SIGINT, SIGTERM and SIGHUP wait meanwhile
/// (SignalsWait), and no memory is asked for.
///
/// What is replaced hands on its owner, group, mode and extended attributes, as far as the file system has them and the
/// process may give them; a file whose group is another one is no more readable for it. A link stays and what it points
/// to is replaced or made; pipes and devices are written into at once. A folder that is moved meanwhile takes the files
/// along. A file system may refuse hard links, modes and fsync.
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
  /// Puts all files into their places. Where one cannot be, what was there before is there again.
  /// @throws Error that also says where an earlier file is that could not be put back.
  void commit();

 private:
  std::vector<std::unique_ptr<StoredFile>> files_;
};

/// A store of one file.
void write_file(const std::filesystem::path& path, std::string_view text);

/// The same, unless something stands there: then that stays.
/// @returns whether the file was written.
bool write_new_file(const std::filesystem::path& path, std::string_view text);

}  // namespace paracal::io

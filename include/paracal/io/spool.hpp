#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace paracal::io {

/// Text that waits until something else is known, however long it gets: up to 64 KiB in memory, what is more in a file
/// without a name, which is gone with this object or process.
class Spool {
 public:
  /// In the folder for temporary files ($TMPDIR, else /tmp).
  Spool() = default;
  /// In this folder, where its file system has files without a name.
  /// @param name  what messages call it there.
  Spool(std::filesystem::path folder, std::filesystem::path name)
      : folder_(std::move(folder)), name_(std::move(name)) {}
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  /// @throws Error when the file cannot be made or written.
  void write(std::string_view text);
  /// Gives all that was written, piece by piece.
  /// @throws Error when the file cannot be read.
  void read(const std::function<void(std::string_view)>& take) const;

  /// Gives the file a name, where there is a file and the file system can; it is then whole, and stays.
  /// @returns its descriptor, else -1: the name does not exist.
  /// @throws Error when the end of the text cannot be written.
  int give_name(const std::string& name);

 private:
  static constexpr std::size_t kPiece = 64 * 1024;

  void write_held();

  std::filesystem::path folder_ = {}, name_ = {};
  int descriptor_ = -1;    ///< -1: nothing is in a file
  std::string link_ = {};  ///< what leads to the file; empty where it can get no name
  std::string held_ = {};  ///< the end, not in the file
};

}  // namespace paracal::io

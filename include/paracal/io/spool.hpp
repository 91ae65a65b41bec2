#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace paracal::io {

/// Text of any length that is stored until it is needed: up to 64 KiB in memory, the rest in an unnamed file, which is
/// deleted with this object or process.
class Spool {
 public:
  /// In the folder for temporary files ($TMPDIR, else /tmp).
  Spool() = default;
  /// In this folder, if its file system supports unnamed files.
  /// @param name  of the file in messages.
  Spool(std::filesystem::path folder, std::filesystem::path name)
      : folder_(std::move(folder)), name_(std::move(name)) {}
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  /// @throws Error when the file cannot be created or written.
  void write(std::string_view text);
  /// Returns all written text, piece by piece.
  /// @throws Error when the file cannot be read.
  void read(const std::function<void(std::string_view)>& take) const;

  /// Gives the file a name, if there is a file and the file system supports it; it is then complete and stays.
  /// @returns its descriptor, else -1: the name does not exist.
  /// @throws Error when the end of the text cannot be written.
  int give_name(const std::string& name);

 private:
  static constexpr std::size_t kPiece = 64 * 1024;

  void write_held();

  std::filesystem::path folder_ = {}, name_ = {};
  int descriptor_ = -1;    ///< -1: no file
  std::string link_ = {};  ///< path of the file; empty if it cannot get a name
  std::string held_ = {};  ///< the end of the text, not in the file
};

}  // namespace paracal::io

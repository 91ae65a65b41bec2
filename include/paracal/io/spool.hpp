#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace paracal::io {

/// Text that waits until something else is known, however long it gets: up to 64 KiB in memory, what is more in a file
/// without a name in the folder for temporary files ($TMPDIR, else /tmp), which is gone with this object or process.
class Spool {
 public:
  Spool() = default;
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  /// @throws Error when the file cannot be made or written.
  void write(std::string_view text);
  /// Gives all that was written, piece by piece.
  /// @throws Error when the file cannot be read.
  void read(const std::function<void(std::string_view)>& take) const;

 private:
  static constexpr std::size_t kPiece = 64 * 1024;

  std::filesystem::path folder_ = {};
  int descriptor_ = -1;    ///< -1: nothing is in a file
  std::string held_ = {};  ///< the end, not in the file
};

}  // namespace paracal::io

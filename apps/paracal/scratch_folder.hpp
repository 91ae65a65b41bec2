#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace paracal::app {

/// A new, empty folder under $TMPDIR, the current one while this lives; gone with it.
class ScratchFolder {
 public:
  /// @throws std::exception when it cannot be made.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// Its files, by their names.
  std::map<std::string, std::string> files() const;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
  std::filesystem::path path_;
};

}  // namespace paracal::app

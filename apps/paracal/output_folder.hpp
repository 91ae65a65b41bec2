#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

namespace paracal::app {

/// A folder that a command fills: all of its files, or neither files nor folder.
class OutputFolder {
 public:
  /// @param who  what names it, for messages: a command or an option.
  /// @param is_own  entries that an earlier run of the same command wrote, and that may be written again.
  /// @throws WrongUsage unless the folder can be made, or has no other entries.
  OutputFolder(const std::string& who, const std::string& name,
               const std::function<bool(const std::filesystem::directory_entry&)>& is_own = {});

  const std::filesystem::path& path() const { return path_; }

  /// @param files  their texts, by their names.
  /// @throws std::exception when one cannot be written.
  void write(const std::map<std::string, std::string>& files) const;

 private:
  std::filesystem::path path_;
};

}  // namespace paracal::app

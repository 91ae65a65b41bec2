#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace paracal::app {

/// A folder that a command fills: all of its files, or neither files nor folder.
class OutputFolder {
 public:
  /// @param who  what names it, for messages: a command or an option.
  /// @throws WrongUsage unless the folder is empty, or can be made.
  OutputFolder(const std::string& who, const std::string& name);

  const std::filesystem::path& path() const { return path_; }

  /// @param files  their texts, by their names.
  /// @throws std::exception when one cannot be written.
  void write(const std::map<std::string, std::string>& files) const;

 private:
  std::filesystem::path path_;
};

}  // namespace paracal::app

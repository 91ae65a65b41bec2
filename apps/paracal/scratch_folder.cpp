#include "scratch_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "paracal/io/file.hpp"

namespace paracal::app {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
  std::string name = fs::temp_directory_path() / "paracal-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) throw fs::filesystem_error(name, {errno, std::generic_category()});
  path_ = name;
  try {
    fs::current_path(path_);
  } catch (...) {
    fs::remove(path_);
    throw;
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::current_path(before_, ignored);
  fs::remove_all(path_, ignored);
}

std::map<std::string, std::string> ScratchFolder::files() const {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(path_)) {
    all[entry.path().filename()] = io::read_file(entry.path()).text;
  }
  return all;
}

}  // namespace paracal::app

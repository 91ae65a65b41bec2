#include "output_folder.hpp"

#include <fmt/format.h>

#include "paracal/io/signals_wait.hpp"
#include "paracal/io/store.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

namespace fs = std::filesystem;

using IsOwn = std::function<bool(const fs::directory_entry&)>;

/// What speaks against filling it; empty: nothing.
std::string complaint(const fs::path& folder, const std::string& who, const IsOwn& is_own) {
  std::error_code error;
  if (folder.empty()) return "expected a folder, got \"\"";
  if (!fs::exists(folder, error)) {
    const fs::path parent = fs::absolute(folder).lexically_normal().parent_path();
    if (fs::is_directory(parent, error)) return {};
    return fmt::format("{}: expected an existing parent folder, got none: {}", folder.string(), parent.string());
  }
  if (!fs::is_directory(folder, error)) return fmt::format("expected a folder, got a file: {}", folder.string());
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_own && is_own(entry)) continue;
    return fmt::format("expected an empty or a new folder{}, got {} with {}; name another folder",
                       is_own ? fmt::format(", or one from an earlier {}", who) : std::string(), folder.string(),
                       entry.path().filename().string());
  }
  return {};
}

}  // namespace

OutputFolder::OutputFolder(const std::string& who, const std::string& name, const IsOwn& is_own) : path_(name) {
  if (!path_.has_filename()) path_ = path_.parent_path();
  const std::string against = complaint(path_, who, is_own);
  if (!against.empty()) throw WrongUsage(fmt::format("{}: {}", who, against));
}

void OutputFolder::write(const std::map<std::string, std::string>& files) const {
  const io::SignalsWait together;  // a folder without its files is neither
  const bool is_new = io::make_folder(path_);
  try {
    io::Store store;  // gone before the folder goes: until then it may hold what has no name yet
    for (const auto& [name, text] : files) store.write(path_ / name, text);
    store.commit();
  } catch (...) {
    std::error_code ignored;
    if (is_new) fs::remove(path_, ignored);
    throw;
  }
}

}  // namespace paracal::app

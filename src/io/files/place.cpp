#include "place.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstring>
#include <optional>
#include <vector>

#include "paracal/error.hpp"

namespace paracal::io {
namespace {

namespace fs = std::filesystem;

Descriptor open_at(const Descriptor& folder, const std::string& name, int flags) {
  return Descriptor(uninterrupted([&] { return openat(folder.number(), name.c_str(), flags | O_CLOEXEC); }));
}

/// All zero where there is none.
struct stat status_of(const Descriptor& file) {
  struct stat found {};
  if (file.is_open() && fstat(file.number(), &found) != 0) found = {};
  return found;
}

/// Of somebody else, in a folder where everybody can make such an entry.
bool is_foreign(const struct stat& entry, const struct stat& folder) {
  return (folder.st_mode & S_IWOTH) != 0 && entry.st_uid != geteuid() && entry.st_uid != folder.st_uid;
}

bool is_of_kernel(const Descriptor& folder) {
  constexpr long kProc = 0x9fa0;  // PROC_SUPER_MAGIC
  struct statfs system {};
  return fstatfs(folder.number(), &system) == 0 && static_cast<long>(system.f_type) == kProc;
}

std::optional<fs::path> target_of(const Descriptor& link) {
  std::array<char, PATH_MAX> text;
  const ssize_t length = readlinkat(link.number(), "", text.data(), text.size());
  if (length <= 0) return std::nullopt;
  return fs::path(std::string(text.data(), static_cast<std::size_t>(length)));
}

/// Follows a path part by part, each through the folder of the one before.
class Walk {
 public:
  Walk(const fs::path& path, Use use) : use_(use) { follow(path); }

  Place end() {
    while (place_.is_reached() && !rest_.empty()) step();
    return std::move(place_);
  }

 private:
  /// What the path says comes before what was still to follow.
  void follow(const fs::path& path) {
    if (path.is_absolute() || !place_.folder.is_open()) {
      place_.path = path.is_absolute() ? "/" : "";
      place_.folder = open_descriptor(path.is_absolute() ? "/" : ".", O_PATH | O_DIRECTORY);
      if (!place_.folder.is_open()) return fail(errno);
    }
    for (auto part = path.end(); part != path.begin();) {
      --part;
      if (!part->empty() && *part != "/" && *part != ".") rest_.push_back(part->string());
    }
    if (!rest_.empty()) return;
    place_.name = ".";
    place_.entry = status_of(place_.folder);
  }

  void step() {
    place_.name = std::move(rest_.back());
    rest_.pop_back();
    const bool is_last = rest_.empty();
    // O_DIRECTORY mounts what is mounted on demand.
    Descriptor entry = open_at(place_.folder, place_.name, O_PATH | O_NOFOLLOW | (is_last ? 0 : O_DIRECTORY));
    const bool may_be_link = !entry.is_open() && !is_last && (errno == ENOTDIR || errno == ELOOP);
    if (may_be_link) entry = open_at(place_.folder, place_.name, O_PATH | O_NOFOLLOW);
    place_.entry = status_of(entry);
    if (!place_.exists() && !(is_last && errno == ENOENT)) return fail(errno);
    if (S_ISLNK(place_.entry.st_mode)) return step_through(entry, is_last);
    if (is_last) return arrive();
    if (use_ == Use::read_included && is_of_another()) return refuse();
    place_.path /= place_.name;
    place_.folder = std::move(entry);
  }

  void step_through(const Descriptor& link, bool is_last) {
    constexpr int kMostLinks = 40;  // as Linux
    if (++links_ > kMostLinks) return fail(ELOOP);
    if (is_foreign(place_.entry, status_of(place_.folder))) return refuse();
    if (is_last && is_of_kernel(place_.folder)) {
      const struct stat behind = status_of(open_at(place_.folder, place_.name, O_PATH));
      place_.is_link_of_kernel = behind.st_mode != 0 && (use_ != Use::write || !S_ISREG(behind.st_mode));
      if (place_.is_link_of_kernel) {
        place_.entry = behind;
        return arrive();
      }
    }
    const std::optional<fs::path> target = target_of(link);
    if (!target) return fail(errno);
    follow(*target);
  }

  void arrive() {
    place_.path /= place_.name;
    if (use_ != Use::read && place_.exists() && !place_.is_folder() && is_of_another()) refuse();
  }

  /// In a folder where it would be removed by its owner alone.
  bool is_of_another() const {
    const struct stat folder = status_of(place_.folder);
    return (folder.st_mode & S_ISVTX) != 0 && is_foreign(place_.entry, folder);
  }

  void fail(int error) { place_.error = error; }
  void refuse() {
    place_.is_foreign = true;
    fail(EPERM);
  }

  Use use_;
  Place place_ = {};
  std::vector<std::string> rest_ = {};  ///< parts still to follow, the next one last
  int links_ = 0;
};

}  // namespace

std::string Place::why_not() const {
  if (!is_foreign) return std::strerror(error);
  return "it is of another user, in a folder to which everybody can write; use another folder or make it yours";
}

Descriptor Place::open(int flags) const { return open_at(folder, name, flags | (is_link_of_kernel ? 0 : O_NOFOLLOW)); }

Place place_of(const fs::path& path, Use use) {
  if (path.native().find('\0') != std::string::npos) {
    throw InvalidArgument(fmt::format("{}: expected a path without a zero character, got one", path.string()));
  }
  return Walk(path, use).end();
}

}  // namespace paracal::io

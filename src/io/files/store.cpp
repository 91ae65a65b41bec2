#include "paracal/io/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "descriptor.hpp"
#include "paracal/error.hpp"
#include "paracal/io/signals_wait.hpp"
#include "paracal/io/spool.hpp"
#include "place.hpp"

namespace paracal::io {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& target) {
  return target.has_parent_path() ? target.parent_path() : ".";
}

/// The mode of a file that replaces none: as readable as any other.
mode_t mode_of_new() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

/// Access lists among them. What cannot be handed on is left.
void hand_on_attributes(const char* from, int to) {
  constexpr std::size_t kMostNames = 4096, kLongest = 65536;  // bytes; the latter is what Linux allows
  std::array<char, kMostNames> names;
  std::array<char, kLongest> value;
  const ssize_t length = listxattr(from, names.data(), names.size());
  for (const char* name = names.data(); name < names.data() + length; name += std::strlen(name) + 1) {
    const ssize_t size = getxattr(from, name, value.data(), value.size());
    if (size >= 0) (void)fsetxattr(to, name, value.data(), static_cast<std::size_t>(size), 0);
  }
}

/// What a new file has of the one that it replaces. None of this fails: not every file system has owners and modes.
void take_attributes(const char* from, int to) {
  struct stat earlier {};
  if (stat(from, &earlier) != 0) {
    (void)uninterrupted([&] { return fchmod(to, mode_of_new()); });
    return;
  }
  mode_t mode = earlier.st_mode & 07777;
  const auto give_to = [&](uid_t owner) { return uninterrupted([&] { return fchown(to, owner, earlier.st_gid); }); };
  if (give_to(earlier.st_uid) != 0 && give_to(static_cast<uid_t>(-1)) != 0) {
    mode &= ~(S_ISUID | S_ISGID | S_IRWXG) | (mode & S_IRWXO) << 3;  // of the group no more than of others
  }
  (void)uninterrupted([&] { return fchmod(to, mode); });
  hand_on_attributes(from, to);
}

/// @throws Error when the disk lost it; that there is no such thing as bringing it there is none.
void bring_to_disk(int file, const std::filesystem::path& target) {
  if (uninterrupted([&] { return fsync(file); }) == 0) return;
  if (errno == EIO || errno == ENOSPC || errno == EDQUOT) fail_to_write(target);
}

/// Makes a file of this name, whose six X become letters.
/// @throws Error, with an empty name.
Descriptor make_neighbour(std::string& name, const std::filesystem::path& target) {
  Descriptor file(uninterrupted([&] { return mkostemp(name.data(), O_CLOEXEC); }));
  if (file.is_open()) return file;
  name.clear();
  fail_to_write(target);
}

void copy(const char* from, int to, const std::filesystem::path& target) {
  const Descriptor source = open_descriptor(from, O_RDONLY);
  if (!source.is_open()) fail_to_write(target);
  std::array<char, 16 * 1024> piece;
  for (;;) {
    const ssize_t count = uninterrupted([&] { return read(source.number(), piece.data(), piece.size()); });
    if (count < 0) fail_to_write(target);
    if (count == 0) return;
    write_all(to, {piece.data(), static_cast<std::size_t>(count)}, target);
  }
}

bool stands(const char* path) { return faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) == 0; }

/// Unless something has that name.
bool rename_to_new(const std::string& from, const std::string& to) {
  const auto rename_new = [&] { return renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE); };
  if (uninterrupted(rename_new) == 0) return true;
  if (errno == EEXIST || stands(to.c_str())) {
    errno = EEXIST;
    return false;
  }
  return uninterrupted([&] { return std::rename(from.c_str(), to.c_str()); }) == 0;  // where there is no such call
}

bool replace(const std::string& from, const std::string& to) {
  return uninterrupted([&] { return std::rename(from.c_str(), to.c_str()); }) == 0;
}

/// Whether this is what was read, and nobody is about to write into it.
bool is_as_read(const std::string& path, const std::string& hash) {
  const Descriptor file = open_descriptor(path.c_str(), O_RDONLY);
  // The system grants this lease where nobody has the file open for writing, or says that it grants none here.
  const bool is_being_written = fcntl(file.number(), F_SETLEASE, F_RDLCK) != 0 && errno == EAGAIN;
  Hash now{};
  return !is_being_written && hash_file(path.c_str(), now) && hash == now.data();
}

}  // namespace

/// One file of a store. Its names are made before they are needed: nothing may want memory once something has one.
class StoredFile {
 public:
  StoredFile(const std::filesystem::path& path, Replaced replaced) : target_(path), replaced_(std::move(replaced)) {
    Place place = place_of(path, Use::write);
    if (!place.is_reached()) fail_to_write(target_, place.why_not());
    if (place.is_folder()) fail_to_write(target_, "it is a folder");
    if (place.exists() && !place.is_regular()) {
      direct_ = place.open(O_WRONLY);
      if (!direct_.is_open()) fail_to_write(target_);
      return;
    }
    target_ = place.path;
    keep_folder(std::move(place));
    static std::atomic<unsigned> files = 0;
    const std::string folder = folder_of(place_);
    name_ = fmt::format("{}/.paracal-{}-{}", folder, getpid(), ++files);
    template_ = folder + "/.paracal-XXXXXX";
    template_of_copy_ = template_;
    kept_ = replaced_.kept_as.empty() ? "" : folder + "/" + replaced_.kept_as;
    text_.emplace(folder, target_);
  }
  ~StoredFile() {
    drop(fresh_);
    drop(earlier_);
  }
  StoredFile(const StoredFile&) = delete;
  StoredFile& operator=(const StoredFile&) = delete;

  void write(std::string_view text) {
    direct_.is_open() ? write_all(direct_.number(), text, target_) : text_->write(text);
  }

  /// Brings it onto the disk beside its place: nearly all that can fail.
  void settle() {
    if (direct_.is_open()) return;
    Descriptor made;
    int file = text_->give_name(name_);
    fresh_.swap(file >= 0 ? name_ : template_);
    if (file < 0) {
      made = make_neighbour(fresh_, target_);
      file = made.number();
      text_->read([&](std::string_view piece) { write_all(file, piece, target_); });
    }
    take_attributes(place_.c_str(), file);
    bring_to_disk(file, target_);
  }

  /// @throws Error; undo() then makes it as it was.
  void place() {
    if (direct_.is_open()) return;
    const auto exchange = [&] {
      return renameat2(AT_FDCWD, fresh_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE);
    };
    if (uninterrupted(exchange) == 0) {
      fresh_.swap(earlier_);
      is_placed_ = true;
      require_as_read();
    } else {
      if (stands(place_.c_str())) copy_earlier();
      require_as_read();
      if (!replace(fresh_, place_)) fail_to_write(target_);
      fresh_.clear();
      is_placed_ = true;
    }
    if (!kept_.empty()) keep_earlier();
  }

  /// @returns whether it stands in its place; false where something else does.
  bool place_as_new() {
    if (direct_.is_open()) return true;
    const bool placed = rename_to_new(fresh_, place_);
    if (!placed && errno != EEXIST) fail_to_write(target_);
    if (placed) fresh_.clear();
    return placed;
  }

  /// Drops what stood there and has no name of its own.
  void finish() {
    is_kept_ ? earlier_.clear() : drop(earlier_);
    const Descriptor folder = open_descriptor(folder_link_.c_str(), O_RDONLY | O_DIRECTORY);
    if (folder.is_open()) (void)uninterrupted([&] { return fsync(folder.number()); });
  }

  /// What stood there stands there again, or nothing if nothing did.
  /// @returns where it is, where that cannot be done; else empty.
  std::string undo() {
    if (!is_placed_) return {};
    is_placed_ = false;
    if (earlier_.empty()) {
      (void)uninterrupted([&] { return unlink(place_.c_str()); });
    } else if (!replace(earlier_, place_)) {
      const std::string left = std::filesystem::path(std::exchange(earlier_, {})).filename();
      return fmt::format("; the earlier {} is kept as {} in the same folder", target_.string(), left);
    }
    earlier_.clear();
    return {};
  }

 private:
  /// Sets folder_, folder_link_ and place_.
  void keep_folder(Place&& place) {
    folder_ = std::move(place.folder);
    const std::string link = of_descriptor(folder_);
    const bool has_link = access(link.c_str(), F_OK) == 0;
    folder_link_ = has_link ? link + "/." : folder_of(target_).string();
    place_ = has_link ? link + "/" + place.name : target_.string();
  }

  static void drop(std::string& name) {
    if (!name.empty()) (void)uninterrupted([&] { return unlink(name.c_str()); });
    name.clear();
  }

  void copy_earlier() {
    earlier_.swap(template_of_copy_);
    const Descriptor file = make_neighbour(earlier_, target_);
    copy(place_.c_str(), file.number(), target_);
    take_attributes(place_.c_str(), file.number());
    bring_to_disk(file.number(), target_);
  }

  void require_as_read() const {
    if (replaced_.sha256.empty() || (!earlier_.empty() && is_as_read(earlier_, replaced_.sha256))) return;
    throw Error(fmt::format(
        "{}: expected the file as it was read, got a changed one; it is not overwritten: run the command again",
        target_.string()));
  }

  void keep_earlier() {
    if (!rename_to_new(earlier_, kept_)) fail_to_write(target_.parent_path() / replaced_.kept_as);
    earlier_.swap(kept_);
    is_kept_ = true;
  }

  std::filesystem::path target_;  ///< what messages name
  Replaced replaced_;
  Descriptor direct_ = {};                     ///< a pipe or device
  Descriptor folder_ = {};                     ///< of the target
  std::string folder_link_ = {}, place_ = {};  ///< the folder and the target, reached through folder_
  std::optional<Spool> text_ = {};
  std::string name_ = {}, template_ = {}, template_of_copy_ = {}, kept_ = {};
  std::string fresh_ = {};    ///< the new file, while it is not in its place
  std::string earlier_ = {};  ///< what stood there
  bool is_placed_ = false;
  bool is_kept_ = false;  ///< earlier_ stays
};

Store::Store() = default;
Store::~Store() = default;

TextSink Store::begin(const std::filesystem::path& path, Replaced replaced) {
  StoredFile& file = *files_.emplace_back(std::make_unique<StoredFile>(path, std::move(replaced)));
  return [&file](std::string_view text) { file.write(text); };
}

void Store::commit() {
  const SignalsWait together;
  try {
    for (const auto& file : files_) file->settle();
    for (const auto& file : files_) file->place();
  } catch (const Error& failed) {
    std::string left;
    for (std::size_t k = files_.size(); k-- > 0;) left += files_[k]->undo();
    files_.clear();
    if (left.empty()) throw;
    throw Error(failed.what() + left);
  }
  for (const auto& file : files_) file->finish();
  files_.clear();
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  Store store;
  store.write(path, text);
  store.commit();
}

bool write_new_file(const std::filesystem::path& path, std::string_view text) {
  const SignalsWait whole;
  if (stands(path.c_str())) return false;  // a link to nothing, too
  StoredFile file(path, {});
  file.write(text);
  file.settle();
  const bool is_new = file.place_as_new();
  file.finish();
  return is_new;
}

bool make_folder(const std::filesystem::path& path) {
  std::error_code error;
  bool is_new = false;
  do {
    is_new = std::filesystem::create_directory(path, error);
  } while (error == std::errc::interrupted);  // as the other calls: uninterrupted()
  if (error) fail_to_write(path, error.message());
  return is_new;
}

bool make_folders(const std::filesystem::path& path) {
  const std::filesystem::path before = path.parent_path();
  std::error_code ignored;  // of a folder that cannot be looked at: making it says why
  if (!before.empty() && !std::filesystem::exists(before, ignored)) make_folders(before);
  return make_folder(path);
}

}  // namespace paracal::io

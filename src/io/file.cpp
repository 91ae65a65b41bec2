#include "paracal/io/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sha256.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "descriptor.hpp"
#include "paracal/error.hpp"
#include "paracal/io/signals_wait.hpp"
#include "utf8.hpp"

namespace paracal::io {

void fail_to_write(const std::filesystem::path& path) {
  throw Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

void write_all(int descriptor, std::string_view text, const std::filesystem::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_to_write(path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

namespace {

bool is_pipe_or_device(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  return exists(status) && !is_regular_file(status) && !is_directory(status);
}

/// A link stays a link: what it points to is replaced, or made.
std::filesystem::path behind_links(const std::filesystem::path& link) {
  constexpr int kMostLinks = 40;  // as Linux
  std::filesystem::path path = link;
  std::error_code ignored;
  for (int links = 0; links < kMostLinks && std::filesystem::is_symlink(path, ignored); ++links) {
    path = path.parent_path() / std::filesystem::read_symlink(path, ignored);
  }
  if (!std::filesystem::is_symlink(path, ignored)) return path;
  errno = ELOOP;
  fail_to_write(link);
}

std::filesystem::path folder_of(const std::filesystem::path& target) {
  return target.has_parent_path() ? target.parent_path() : ".";
}

/// A short name beside a file, whose own may be as long as names can be.
std::string neighbour_of(const std::filesystem::path& target) {
  return (target.parent_path() / ".paracal-XXXXXX").string();
}

std::string of_descriptor(const Descriptor& file) { return fmt::format("/proc/self/fd/{}", file.number()); }

/// A file without a name, of which nothing is left whatever ends this process; not open where the file system has none.
Descriptor open_nameless(const std::filesystem::path& folder) {
  Descriptor file(open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open() || access(of_descriptor(file).c_str(), F_OK) == 0) return file;
  file = Descriptor();  // without /proc it could never be given a name
  errno = EOPNOTSUPP;
  return file;
}

bool has_no_nameless_files(int error) { return error == EOPNOTSUPP || error == EISDIR || error == EINVAL; }

/// mkstemp makes private files: a result keeps the mode of the file it replaces, or is as readable as any other file.
mode_t mode_of_result(const std::filesystem::path& target) {
  struct stat earlier {};
  if (stat(target.c_str(), &earlier) == 0) return earlier.st_mode & 07777;
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

/// Gives a nameless file this name, or one that differs in its last letter where somebody has that.
bool give_name(const std::string& nameless, std::string& name) {
  for (char last = 'a'; last <= 'z'; ++last) {
    name.back() = last;
    if (linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
    if (errno != EEXIST) break;
  }
  return false;
}

}  // namespace

std::ifstream open_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputFileError(path.string(), 0, "expected a file, got a folder");
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputFileError(path.string(), 0, fmt::format("cannot be read: {}", std::strerror(errno)));
  return stream;
}

namespace {

void decode(TextFile& file) {
  try {
    if (std::optional<std::string> text = decoded(file.text)) {
      file.sha256 = sha256(file.text);
      file.text = *std::move(text);
    }
  } catch (const InvalidArgument& refused) {
    throw InputFileError(file.name, 0, refused.what());
  }
}

}  // namespace

TextFile read_file(const std::filesystem::path& path) {
  constexpr std::size_t kPiece = 1 << 20, kMostPieces = 128;
  std::ifstream stream = open_file(path);
  TextFile file{path.string(), {}};
  while (stream) {
    const std::size_t before = file.text.size();
    if (before >= kMostPieces * kPiece) {
      throw InputFileError(file.name, 0, fmt::format("expected at most {} MiB, got more", kMostPieces));
    }
    file.text.resize(before + kPiece);
    stream.read(file.text.data() + before, kPiece);
    file.text.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) throw InputFileError(file.name, 0, "cannot be read to its end");
  decode(file);
  return file;
}

Descriptor::~Descriptor() {
  if (is_open()) close(number_);
}

OutputFile::OutputFile(const std::filesystem::path& path) : target_(path) {
  if (is_pipe_or_device(path)) {
    file_ = Descriptor(open(path.c_str(), O_WRONLY | O_CLOEXEC));
  } else {
    replaces_ = true;
    target_ = behind_links(path);
    std::error_code ignored;
    if (std::filesystem::is_directory(target_, ignored))
      throw Error(fmt::format("{}: cannot be written: a folder", target_.string()));
    reach_place();
    file_ = open_nameless(folder_of(place_));
    if (file_.is_open()) {  // now: nothing may want memory between a file's getting a name and its place
      static std::atomic<unsigned> files = 0;
      nameless_ = of_descriptor(file_);
      name_ = fmt::format("{}-{}-{}-a", neighbour_of(place_), getpid(), ++files);
    }
    if (!file_.is_open() && has_no_nameless_files(errno)) {
      neighbour_ = neighbour_of(place_);
      file_ = Descriptor(mkostemp(neighbour_.data(), O_CLOEXEC));
      if (!file_.is_open()) neighbour_.clear();
    }
  }
  if (!file_.is_open()) fail_to_write(target_);
}

void OutputFile::reach_place() {
  place_ = target_;
  folder_ = Descriptor(open(folder_of(target_).c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder_.is_open()) fail_to_write(target_);
  const std::filesystem::path folder = of_descriptor(folder_);
  if (access(folder.c_str(), F_OK) == 0) place_ = folder / target_.filename();
}

OutputFile::~OutputFile() {
  if (!neighbour_.empty()) unlink(neighbour_.c_str());
}

void OutputFile::write(std::string_view text) { write_all(file_.number(), text, target_); }

void OutputFile::settle() {
  if (!replaces_) return;
  if (fchmod(file_.number(), mode_of_result(place_)) != 0 || fsync(file_.number()) != 0) fail_to_write(target_);
  if (neighbour_.empty()) {
    if (!give_name(nameless_, name_)) fail_to_write(target_);
    neighbour_ = std::move(name_);
  }
  is_settled_ = true;
}

void OutputFile::commit() {
  if (!replaces_) return;
  if (!is_settled_) settle();
  // What stood there moves into the neighbour, which goes with this object.
  const bool exchanged = renameat2(AT_FDCWD, neighbour_.c_str(), AT_FDCWD, place_.c_str(), RENAME_EXCHANGE) == 0;
  before_ = exchanged ? Before::in_neighbour : errno == ENOENT ? Before::nothing : Before::lost;
  if (!exchanged) {
    if (std::rename(neighbour_.c_str(), place_.c_str()) != 0) fail_to_write(target_);
    neighbour_.clear();
  }
  replaces_ = false;
}

void OutputFile::undo() noexcept {
  if (before_ == Before::in_neighbour) {
    (void)std::rename(neighbour_.c_str(), place_.c_str());
    neighbour_.clear();
  } else if (before_ == Before::nothing) {
    unlink(place_.c_str());
  }
  before_ = Before::lost;
}

bool OutputFile::commit_new() {
  if (!replaces_) return true;
  settle();
  const bool linked = link(neighbour_.c_str(), place_.c_str()) == 0;
  if (!linked && errno != EEXIST) fail_to_write(target_);
  unlink(neighbour_.c_str());
  neighbour_.clear();
  replaces_ = false;
  return linked;
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  const SignalsWait whole;
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string sha256(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> hex{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex.data());
  return hex.data();
}

std::string sha256(const TextFile& file) { return file.sha256.empty() ? sha256(file.text) : file.sha256; }

}  // namespace paracal::io

#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace paracal::io {

/// What somebody says of tables that do not say it themselves.
struct TableStyle {
  bool decimal_comma = false;                     ///< 1,5 is a number and 1.5 is none
  std::vector<std::string> ignored_columns = {};  ///< by their headings
};

/// A file's text together with the name that messages use.
struct TextFile {
  std::string name;
  std::string text;
  TableStyle style = {};
  std::string sha256 = {};  ///< of the bytes, where they are not this text
};

/// What some programs put before the first character of a file.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// A file's text as it comes, for files that are not held in memory.
struct TextStream {
  std::string name;
  std::istream& text;
  TableStyle style = {};
};

/// Takes a text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// @throws InputFileError when the file cannot be opened.
std::ifstream open_file(const std::filesystem::path& path);

/// The text as UTF-8 where the file is UTF-16 with its byte-order mark, as spreadsheets write it; else its bytes.
/// @throws InputFileError when the file cannot be read, or is larger than 128 MiB: no table that is held in memory is.
TextFile read_file(const std::filesystem::path& path);

/// An open file, closed with this.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}  ///< -1 for one that could not be opened
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// A file that comes to be whole or not at all: pieces go into a file without a name (where the file system has none,
/// into a neighbour), which commit() puts in its place. What is not committed is gone with this object or process, and
/// what stood at `path` is still there.
/// A link stays and its target is replaced, keeping its mode, or made; pipes and devices are written into. A folder
/// that is moved meanwhile takes the file along; none is left in one that takes its name.
class OutputFile {
 public:
  /// @throws Error when the folder cannot be written; so do the others.
  explicit OutputFile(const std::filesystem::path& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  void write(std::string_view text);
  /// Brings it onto the disk, beside its place: what is likely to fail of commit(), for those that commit several.
  void settle();
  void commit();
  /// After commit(): what stood there before stands there again, or nothing if nothing did. Where the file system
  /// cannot exchange files what was committed stays.
  void undo() noexcept;
  /// The same as commit(), unless something stands there by now: then that stays.
  /// @returns whether the file stands there.
  bool commit_new();

 private:
  /// Sets folder_ and place_.
  void reach_place();

  std::filesystem::path target_;  ///< what messages name
  Descriptor folder_ = {};
  std::filesystem::path place_ = {};       ///< the target, reached through folder_
  std::string nameless_ = {}, name_ = {};  ///< how to reach a file without a name, and the name that it is to get
  std::string neighbour_ = {};             ///< empty while the file has no name
  bool replaces_ = false;                  ///< a file, once; pipes and devices cannot be replaced
  bool is_settled_ = false;
  /// What stood there before commit(); lost: not committed, or a file system that cannot exchange two files.
  enum class Before : std::uint8_t { lost, nothing, in_neighbour } before_ = Before::lost;
  Descriptor file_ = {};
};

/// One text as an OutputFile.
void write_file(const std::filesystem::path& path, std::string_view text);

/// SHA-256 in hexadecimal.
std::string sha256(std::string_view text);
/// Of the file as it was read.
std::string sha256(const TextFile& file);

}  // namespace paracal::io

#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace paracal::io {

/// A file's text together with the name that messages use.
struct TextFile {
  std::string name;
  std::string text;
};

/// What some programs put before the first character of a file.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// A file's text as it comes, for files that are not held in memory.
struct TextStream {
  std::string name;
  std::istream& text;
};

/// @throws InputFileError when the file cannot be opened.
std::ifstream open_file(const std::filesystem::path& path);

/// @throws InputFileError when the file cannot be read, or is larger than 128 MiB: no table that is held in memory is.
TextFile read_file(const std::filesystem::path& path);

/// A file that comes to be whole or not at all: pieces go into a file without a name (where the file system has none,
/// into a neighbour), which commit() puts in its place. What is not committed is gone with this object or process, and
/// what stood at `path` is still there.
/// A link stays and its target is replaced, keeping its mode, or made; pipes and devices are written into.
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
  std::filesystem::path target_;
  std::string nameless_ = {}, name_ = {};  ///< how to reach a file without a name, and the name that it is to get
  std::string neighbour_ = {};             ///< empty while the file has no name
  bool replaces_ = false;                  ///< a file, once; pipes and devices cannot be replaced
  bool is_settled_ = false;
  /// What stood there before commit(); lost: not committed, or a file system that cannot exchange two files.
  enum class Before : std::uint8_t { lost, nothing, in_neighbour } before_ = Before::lost;
  int descriptor_ = -1;
};

/// One text as an OutputFile.
void write_file(const std::filesystem::path& path, std::string_view text);

/// SHA-256 in hexadecimal.
std::string sha256(std::string_view text);

}  // namespace paracal::io

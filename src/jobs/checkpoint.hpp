#pragma once

// Private to the programs: the folder that keeps the chunks of a long job.

#include <filesystem>
#include <string>

#include "paracal/error.hpp"
#include "paracal/io/json.hpp"

namespace paracal::jobs {

/// A chunk file that says nothing, or nothing that can be trusted.
class Damaged : public Error {
  using Error::Error;
};

/// The folder's job.json says what decides the results; every chunk is a file NAME.json.gz with the hash of that and of
/// its own content, written whole or not at all.
class Checkpoint {
 public:
  /// Opens or begins the folder.
  /// @param description  of the job. The entries below "chunks" may differ in a folder that was begun: `agreed()` has
  /// those that hold.
  /// @throws InputFileError for the folder of another job; Error when it cannot be written.
  Checkpoint(std::filesystem::path path, io::Json description);

  const io::Json& agreed() const { return description_; }
  /// Whether anything has the name of this chunk.
  bool has(const std::string& name) const;
  void write(const std::string& name, const std::string& result) const;
  /// @throws Damaged, and InputFileError for a chunk of another job and for what is no regular file.
  std::string read(const std::string& name) const;
  std::filesystem::path file_of(const std::string& name) const { return path_ / (name + ".json.gz"); }

 private:
  std::filesystem::path path_;
  io::Json description_;
  std::string hash_;
};

}  // namespace paracal::jobs

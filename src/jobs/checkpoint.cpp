#include "checkpoint.hpp"

#include <fmt/format.h>

#include <iterator>
#include <system_error>

#include "gzip.hpp"
#include "io/calibrations/nesting.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/store.hpp"

namespace paracal::jobs {
namespace {

using io::Json;

constexpr const char* kFolderFormat = "paracal job 1";
constexpr const char* kChunkFormat = "paracal chunk 2";

/// "expected seed 1, got 2" for the first entry in which two descriptions differ.
std::string first_difference(const Json& expected, const Json& got) {
  const Json one = expected.flatten(), other = got.flatten();
  const auto differs = [&](const std::string& place) { return one.value(place, Json()) != other.value(place, Json()); };
  for (const Json* description : {&one, &other}) {
    for (const auto& [place, value] : description->items()) {
      if (!differs(place)) continue;
      return fmt::format("expected {} {}, got {}", place.substr(1), one.value(place, Json()).dump(),
                         other.value(place, Json()).dump());
    }
  }
  return "expected other entries";
}

/// null where the text is no JSON.
Json or_null(std::string_view text) {
  try {
    return io::parse_shallow(text);
  } catch (const Json::exception&) {
    return {};
  }
}

/// The header of the folder, but for its chunks, is the description.
Json agreed_with(const io::TextFile& header, const Json& description) {
  Json got = or_null(header.text), expected = description;
  if (got.is_object() && got.contains("chunks")) expected["chunks"] = got["chunks"];
  if (got == expected) return got;
  const std::string complaint = got.is_object()
                                    ? first_difference(expected, got)
                                    : "expected job.json of a paracal command with --checkpoint, got something else";
  throw InputFileError(header.name, 0,
                       complaint + " (this folder belongs to another command; use another --checkpoint)");
}

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream stream = io::open_file(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, Json description) : path_(std::move(path)) {
  description["format"] = kFolderFormat;
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error) throw Error(fmt::format("{}: cannot be written: {}", path_.string(), error.message()));
  const std::filesystem::path header = path_ / "job.json";
  // Of several that begin in one folder at once, one comes first.
  const bool begins = !std::filesystem::exists(header) && io::write_new_file(header, description.dump(2) + "\n");
  description_ = begins ? std::move(description) : agreed_with(io::read_file(header), description);
  hash_ = io::sha256(description_.dump());
}

void Checkpoint::write(const std::string& name, const std::string& result) const {
  const Json content = Json::parse(result);
  const Json chunk{{"format", kChunkFormat},
                   {"job", hash_},
                   {"chunk", name},
                   {"content", content},
                   {"sha256", io::sha256(content.dump())}};
  io::write_file(file_of(name), gzip(chunk.dump() + "\n"));
}

std::string Checkpoint::read(const std::string& name) const {
  const std::filesystem::path file = file_of(name);
  const std::string bytes = bytes_of_file(file);
  try {
    const Json chunk = io::parse_shallow(gunzip(bytes));
    if (const auto job = chunk.at("job").get<std::string>(); job != hash_) {
      throw InputFileError(file.string(), 0, fmt::format("expected a chunk of job {}, got one of job {}", hash_, job));
    }
    std::string content = chunk.at("content").dump();
    if (chunk.at("chunk") != name || chunk.at("sha256") != io::sha256(content)) {
      throw Error(fmt::format("expected chunk {} with the hash of its content, got another hash", name));
    }
    return content;
  } catch (const InputFileError&) {
    throw;
  } catch (const std::exception& broken) {
    throw Damaged(broken.what());
  }
}

}  // namespace paracal::jobs

#include "checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "gzip.hpp"
#include "io/calibrations/json_node.hpp"
#include "io/files/place.hpp"
#include "io/files/stored.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/store.hpp"

namespace paracal::jobs {
namespace {

using io::Json;

constexpr const char* kFolderFormat = "paracal job 1";
constexpr const char* kChunkFormat = "paracal chunk 2";

/// "expected seed 1, got 2" for the first entry in which two descriptions differ.
std::string first_difference(const Json& expected, const Json& got, const std::string& place) {
  const auto below = [&](const std::string& key) { return place.empty() ? key : place + "/" + key; };
  if (expected.is_object() && got.is_object()) {
    for (const Json* description : {&expected, &got}) {
      for (const auto& item : description->items()) {
        const Json one = expected.value(item.key(), Json()), other = got.value(item.key(), Json());
        if (one != other) return first_difference(one, other, below(item.key()));
      }
    }
  }
  const bool are_lists = expected.is_array() && got.is_array();
  const auto entry = [](const Json& list, std::size_t k) { return k < list.size() ? list[k] : Json(); };
  for (std::size_t k = 0; are_lists && k < std::max(expected.size(), got.size()); ++k) {
    const Json one = entry(expected, k), other = entry(got, k);
    if (one != other) return first_difference(one, other, below(std::to_string(k)));
  }
  return fmt::format("expected {} {}, got {}", place, expected.dump(), got.dump());
}

/// The sizes of chunks that a folder was begun with. A size of 0 means that there are no such chunks.
void take_sizes(const io::JsonNode& header, Json& expected) {
  constexpr std::uint64_t kLargest = 1'000'000'000'000;  // machines of a batch
  if (!expected.contains("chunks")) return;
  const io::JsonNode chunks = header.object_at("chunks");
  for (auto& item : expected["chunks"].items()) {
    if (item.value() != 0) item.value() = chunks.at(item.key().c_str()).whole_number(1, kLargest);
  }
}

/// The header of the folder, but for the sizes of its chunks, is the description.
Json agreed_with(const io::TextFile& header, const Json& description) {
  Json got = io::parse_json(header), expected = description;
  if (got.is_object() && got.value("format", Json()) == kFolderFormat) {
    take_sizes(io::JsonNode(header, got, "a job"), expected);
  }
  if (got == expected) return got;
  const std::string complaint = got.is_object()
                                    ? first_difference(expected, got, "")
                                    : "expected job.json of a paracal command with --checkpoint, got something else";
  throw InputFileError(header.name, 0,
                       complaint + " (this folder belongs to another command; use another --checkpoint)");
}

/// Whether anything has this name, a link to nothing included.
bool is_taken(const std::filesystem::path& path) {
  return std::filesystem::exists(std::filesystem::symlink_status(path));
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, Json description) : path_(std::move(path)) {
  description["format"] = kFolderFormat;
  if (const io::Place place = io::place_of(path_, io::Use::write); place.is_foreign) {
    io::fail_to_write(path_, place.why_not());
  }
  io::make_folders(path_);
  const std::filesystem::path header = path_ / "job.json";
  // Of several that begin in one folder at once, one comes first.
  const bool begins = io::write_new_file(header, description.dump(2) + "\n");
  description_ = begins ? std::move(description) : agreed_with(io::read_stored(header), description);
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

bool Checkpoint::has(const std::string& name) const { return is_taken(file_of(name)); }

std::string Checkpoint::read(const std::string& name) const {
  const std::filesystem::path file = file_of(name);
  const std::string bytes = io::stored_bytes(file);
  std::string job, content;
  bool is_whole = false;
  try {
    const io::TextFile text{"content", gunzip(bytes)};
    const Json json = io::parse_json(text);
    const io::JsonNode chunk(text, json, "a chunk");
    if (chunk.at("format").text() != kChunkFormat) chunk.at("format").refuse_as(kChunkFormat);
    job = chunk.at("job").text();
    content = chunk.at("content").json().dump();
    is_whole = chunk.at("chunk").text() == name && chunk.at("sha256").text() == io::sha256(content);
  } catch (const Error& broken) {
    throw Damaged(broken.what());
  }
  if (job != hash_) {
    throw InputFileError(file.string(), 0, fmt::format("expected a chunk of job {}, got one of job {}", hash_, job));
  }
  if (!is_whole) throw Damaged(fmt::format("expected chunk {} with the hash of its content, got another hash", name));
  return content;
}

}  // namespace paracal::jobs

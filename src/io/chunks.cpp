#include "paracal/io/chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "nesting.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/store.hpp"
#include "tally_json.hpp"

namespace paracal::io {
namespace {

constexpr const char* kFolderFormat = "paracal batch 1";
constexpr const char* kChunkFormat = "paracal chunk 1";
constexpr std::string_view kPrefix = "machines-";

/// A chunk file that says nothing, or nothing that can be trusted.
class Damaged : public Error {
  using Error::Error;
};

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

/// The chunks of a batch by number; the last one may be smaller.
class Chunks {
 public:
  explicit Chunks(const BatchOptions& options) : machines_(options.machines), size_(options.chunk) {}

  std::uint64_t machines() const { return machines_; }
  std::uint64_t count() const { return (machines_ - 1) / size_ + 1; }
  std::uint64_t number_of(std::uint64_t machine) const { return machine / size_; }
  MachineRange operator[](std::uint64_t number) const {
    const std::uint64_t first = number * size_;
    return {first, std::min(size_, machines_ - first)};
  }
  /// Of some chunks.
  std::uint64_t machines_in(const std::vector<std::uint64_t>& numbers) const {
    std::uint64_t sum = 0;
    for (const std::uint64_t number : numbers) sum += (*this)[number].count;
    return sum;
  }

 private:
  std::uint64_t machines_, size_;
};

/// Place k of the numbers from 0 that are not in `present`, which ascends.
std::uint64_t missing_number(const std::vector<std::uint64_t>& present, std::uint64_t k) {
  for (const std::uint64_t number : present) {
    if (number > k) break;
    ++k;
  }
  return k;
}

/// The chunks of one batch on disk.
class ChunkFolder {
 public:
  /// Opens or begins the folder.
  ChunkFolder(const Batch& batch, const BatchOptions& options) : path_(options.checkpoint) {
    Json description{{"format", kFolderFormat}, {"chunk", options.chunk}};
    description.update(to_json(batch));
    hash_ = sha256(description.dump());
    std::error_code error;
    std::filesystem::create_directories(path_, error);
    if (error) throw Error(fmt::format("{}: cannot be written: {}", path_.string(), error.message()));
    const std::filesystem::path header = path_ / "batch.json";
    // Of several batches that begin in one folder at once, one comes first.
    if (!std::filesystem::exists(header) && write_new_file(header, description.dump(2) + "\n")) return;
    require_same(read_file(header), description);
  }

  bool has(MachineRange range) const { return std::filesystem::exists(file_of(range)); }

  /// Numbers of the chunks that are there, ascending, by one listing of the folder.
  std::vector<std::uint64_t> present(const Chunks& chunks) const {
    std::vector<std::uint64_t> numbers;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      const std::string name = entry.path().filename();
      std::uint64_t first = 0;
      if (!name.starts_with(kPrefix)) continue;
      std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), first);
      if (first < chunks.machines() && name == name_of(chunks[chunks.number_of(first)])) {
        numbers.push_back(chunks.number_of(first));
      }
    }
    std::ranges::sort(numbers);
    return numbers;
  }

  void write(MachineRange range, const Tally& tally) const {
    const Json content = tally_json(tally);
    const Json chunk{{"format", kChunkFormat}, {"batch", hash_},   {"first", range.first},
                     {"count", range.count},   {"tally", content}, {"sha256", sha256(content.dump())}};
    write_file(file_of(range), chunk.dump() + "\n");
  }

  /// @throws Damaged, and InputFileError for a chunk of another batch.
  Tally read(MachineRange range) const {
    const TextFile file = read_file(file_of(range));
    try {
      return tally_of(content_of(file, range), range.count);
    } catch (const Json::exception&) {
      throw Damaged(not_a_chunk(file));
    } catch (const std::out_of_range&) {
      throw Damaged(not_a_chunk(file));
    }
  }

 private:
  static std::string name_of(MachineRange range) {
    return fmt::format("{}{:012}-{}.json", kPrefix, range.first, range.count);
  }
  std::filesystem::path file_of(MachineRange range) const { return path_ / name_of(range); }
  static std::string not_a_chunk(const TextFile& file) {
    return fmt::format("{}: expected a chunk of a batch, got something else", file.name);
  }

  /// null where the text is no JSON.
  static Json or_null(std::string_view text) {
    try {
      return parse_shallow(text);
    } catch (const Json::exception&) {
      return {};
    }
  }

  static void require_same(const TextFile& header, const Json& expected) {
    const Json got = or_null(header.text);
    if (got == expected) return;
    const std::string complaint =
        got.is_object() ? first_difference(expected, got) : "expected the description of a batch, got something else";
    throw InputFileError(header.name, 0, complaint + " (this folder holds another batch)");
  }

  Json content_of(const TextFile& file, MachineRange range) const {
    const Json chunk = parse_shallow(file.text);
    if (const auto batch = chunk.at("batch").get<std::string>(); batch != hash_) {
      throw InputFileError(file.name, 0, fmt::format("expected a chunk of batch {}, got one of {}", hash_, batch));
    }
    const Json& content = chunk.at("tally");
    const std::string hash = sha256(content.dump());
    if (chunk.at("sha256") != hash) {
      throw Damaged(fmt::format("{}: expected the hash {}, got {}", file.name, chunk.at("sha256").dump(), hash));
    }
    if (chunk.at("first") != range.first || chunk.at("count") != range.count) {
      throw Damaged(fmt::format("{}: expected {} machines from {}, got {} from {}", file.name, range.count, range.first,
                                chunk.at("count").dump(), chunk.at("first").dump()));
    }
    return content;
  }

  std::filesystem::path path_;
  std::string hash_;
};

/// One rank's part of a batch.
class Run {
 public:
  Run(const Batch& batch, const BatchOptions& options, const std::atomic<bool>& stop)
      : batch_(batch), options_(options), stop_(stop), chunks_(options) {}

  BatchResult in_memory() const {
    BatchResult result;
    for (std::uint64_t number = 0; number < chunks_.count(); ++number) {
      report(chunks_[number].first);
      const std::optional<Tally> chunk = run_chunk(batch_, chunks_[number], options_.threads, stop_);
      if (!chunk) return result;
      result.tally.add(*chunk);
    }
    report(chunks_.machines());
    result.complete = true;
    return result;
  }

  BatchResult in_folder() const {
    const ChunkFolder folder(batch_, options_);
    // Not as an initialiser of `complete`: where that throws, GCC 12 destroys `tally` twice.
    BatchResult result;
    result.complete = make_own(folder) && make_missing(folder);
    if (options_.rank.number == 0) result.complete &= add_up(folder, result.tally);
    return result;
  }

 private:
  void report(std::uint64_t machines) const {
    if (options_.progress) options_.progress(machines);
  }

  /// False when it was stopped.
  bool make(const ChunkFolder& folder, MachineRange range) const {
    const std::optional<Tally> chunk = run_chunk(batch_, range, options_.threads, stop_);
    if (chunk) folder.write(range, *chunk);
    return chunk.has_value();
  }

  bool make_own(const ChunkFolder& folder) const {
    std::uint64_t done = chunks_.machines_in(folder.present(chunks_));
    report(done);
    for (std::uint64_t number = options_.rank.number; number < chunks_.count(); number += options_.rank.size) {
      if (folder.has(chunks_[number])) continue;
      if (!make(folder, chunks_[number])) return false;
      report(done += chunks_[number].count);
    }
    return true;
  }

  /// Ranks take different places of what is missing, so that they seldom meet.
  std::uint64_t place_among(std::uint64_t missing) const {
    const std::uint64_t apart = missing / std::min(missing, options_.rank.size);
    return options_.rank.number % missing * apart;
  }

  bool make_missing(const ChunkFolder& folder) const {
    for (;;) {
      const std::vector<std::uint64_t> present = folder.present(chunks_);
      report(chunks_.machines_in(present));
      const std::uint64_t missing = chunks_.count() - present.size();
      if (missing == 0) return true;
      if (!make(folder, chunks_[missing_number(present, place_among(missing))])) return false;
    }
  }

  /// Everything that is there; damaged chunks are made again, unless the run was stopped.
  bool add_up(const ChunkFolder& folder, Tally& sum) const {
    bool complete = true;
    for (const std::uint64_t number : folder.present(chunks_)) {
      const std::optional<Tally> chunk = read_or_make_again(folder, chunks_[number]);
      if (chunk) sum.add(*chunk);
      complete &= chunk.has_value();
    }
    return complete;
  }

  std::optional<Tally> read_or_make_again(const ChunkFolder& folder, MachineRange range) const {
    std::string complaint;
    try {
      return folder.read(range);
    } catch (const Damaged& damaged) {
      complaint = damaged.what();
    }
    const bool made = make(folder, range);
    if (options_.warning) options_.warning(complaint + (made ? "; made again" : "; left out"));
    return made ? std::optional(folder.read(range)) : std::nullopt;
  }

  const Batch& batch_;
  const BatchOptions& options_;
  const std::atomic<bool>& stop_;
  Chunks chunks_;
};

}  // namespace

BatchResult run_batch(const Batch& batch, const BatchOptions& options, const std::atomic<bool>& stop) {
  if (options.machines == 0 || options.chunk == 0) throw InvalidArgument("batch: expected at least one machine, got 0");
  if (options.rank.number >= options.rank.size || (options.rank.size > 1 && options.checkpoint.empty())) {
    throw InvalidArgument(fmt::format("batch: expected a checkpoint folder for {} ranks, and a rank below, got rank {}",
                                      options.rank.size, options.rank.number));
  }
  const Run run(batch, options, stop);
  return options.checkpoint.empty() ? run.in_memory() : run.in_folder();
}

}  // namespace paracal::io

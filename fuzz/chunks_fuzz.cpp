// The folder that keeps a batch, with one of its files edited: another batch is refused, a damaged chunk is named and
// left out, and nothing else changes what the batch adds up to. A chunk that got its hash anew after the edit adds up
// to its machines, if it is believed.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "fuzzing.hpp"
#include "jobs/batch_job.hpp"
#include "jobs/chunked_job.hpp"
#include "jobs/gzip.hpp"
#include "paracal/io/file.hpp"

namespace paracal::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMachines = 4, kChunk = 2;
constexpr std::array kFiles{"job.json", "exact-000000000000-2.json.gz", "exact-000000000002-2.json.gz"};

/// Some bytes of a file replaced by others.
struct Edit {
  std::size_t file = 0;    ///< of kFiles
  bool gets_hash = false;  ///< a chunk: the one of what it says then
  std::size_t from = 0, length = 0;
  std::string text = {};
};

Edit edit_of(const std::uint8_t* data, std::size_t size) {
  const auto number = [&](std::size_t at) { return data[at] + std::size_t{256} * data[at + 1]; };
  return {data[0] % kFiles.size(), data[0] / kFiles.size() % 2 == 1, number(1), number(3),
          std::string(reinterpret_cast<const char*>(data + 5), size - 5)};
}

std::string with_hash(const std::string& text) {
  const auto shallow = [](int depth, Json::parse_event_t /*event*/, Json& /*value*/) { return depth < 50; };
  Json chunk = Json::parse(text, shallow, false);
  if (chunk.is_object() && chunk.contains("content")) chunk["sha256"] = io::sha256(chunk["content"].dump());
  return chunk.dump();
}

std::string edited(std::string text, const Edit& edit) {
  const std::size_t from = edit.from % (text.size() + 1);
  text.replace(from, edit.length, edit.text);
  return edit.gets_hash && edit.file > 0 ? with_hash(text) : text;
}

template <typename Holds>
bool holds_for_each(const Tally& tally, Holds&& holds) {
  return std::ranges::all_of(kErrorKinds, [&](ErrorKind kind) {
    return holds(tally.before[kind], kind, true) && holds(tally.after[kind], kind, false);
  });
}

bool same(const Tally& one, const Tally& other) {
  return one.fates == other.fates && one.passed == other.passed &&
         holds_for_each(one, [&](const Histogram& histogram, ErrorKind kind, bool before) {
           return histogram.counts() == (before ? other.before : other.after)[kind].counts();
         });
}

bool could_be_of(std::uint64_t machines, const Tally& tally) {
  const std::uint64_t measured = tally.machines() - tally.of(Fate::does_not_close);
  return tally.machines() == machines && tally.passed <= measured &&
         holds_for_each(tally, [&](const Histogram& histogram, ErrorKind /*kind*/, bool /*before*/) {
           return histogram.total() == measured;
         });
}

/// A small batch in a folder of its own, which goes with this.
class Folder {
 public:
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "paracal-fuzz-XXXXXX";
    require(mkdtemp(name.data()) != nullptr);
    path_ = name;
    batch_.plan = settled(batch_.robot, paper_production(batch_.robot, tolerances_of(batch_.robot)));
    batch_.plan.limits[ErrorKind::volumetric_aligned] = 0.05;
    const std::atomic<bool> never = false;
    whole_ = run(never).tally;
    for (std::size_t chunk = 0; chunk < 2; ++chunk) {
      others_[chunk] = *exactly(batch_, {chunk == 0 ? kChunk : 0, kChunk}, 1, never);
    }
    for (std::size_t file = 0; file < kFiles.size(); ++file) {
      const std::string bytes = io::read_file(path_ / kFiles[file]).text;
      texts_[file] = file == 0 ? bytes : jobs::gunzip(bytes);
    }
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  void judge(const Edit& edit) {
    write(edit.file, edited(texts_[edit.file], edit));
    may_complain([&] {
      const std::atomic<bool> stopped = true;  // nothing is made again
      const jobs::BatchResult result = run(stopped);
      require(result.complete == warning_.empty());
      if (!result.complete) {
        require(edit.file > 0 && warning_.find(kFiles[edit.file]) != std::string::npos);
        return require(same(result.tally, others_[edit.file - 1]));
      }
      require(edit.gets_hash ? could_be_of(kMachines, result.tally) : same(result.tally, whole_));
    });
    write(edit.file, texts_[edit.file]);
  }

 private:
  jobs::BatchResult run(const std::atomic<bool>& stop) {
    warning_.clear();
    jobs::Alone alone;
    jobs::ChunkedJob job(alone, {.checkpoint = path_, .warning = [this](const std::string& text) { warning_ = text; }},
                         jobs::description(batch_, {.exact = kChunk}));
    return jobs::run_batch(batch_, {.machines = kMachines, .threads = 1}, jobs::chunk_sizes(job.agreed()), job, stop);
  }

  void write(std::size_t file, const std::string& text) const {
    std::ofstream(path_ / kFiles[file], std::ios::binary) << (file == 0 ? text : jobs::gzip(text));
  }

  std::filesystem::path path_;
  Batch batch_{.robot = robot(1), .plan = {}, .seed = 3};
  Tally whole_;
  std::array<Tally, 2> others_;  ///< without a chunk
  std::array<std::string, kFiles.size()> texts_;
  std::string warning_;
};

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace paracal::fuzz;
  static Folder folder;
  if (size >= 5) folder.judge(edit_of(data, size));
  return 0;
}

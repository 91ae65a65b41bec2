#include "batch_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "paracal/error.hpp"
#include "paracal/io/tally_json.hpp"

namespace paracal::jobs {
namespace {

using io::Json;
using Compute = std::function<std::optional<Tally>(MachineRange)>;

/// Machines first ... last - 1 in chunks of one size; the last one may be smaller.
class MachineStage : public JobStage {
 public:
  MachineStage(std::string name, MachineRange machines, std::uint64_t size, Compute compute)
      : name_(std::move(name)),
        begin_(machines.first),
        end_(machines.first + machines.count),
        size_(size),
        compute_(std::move(compute)) {}

  std::uint64_t first() const override { return begin_ / size_; }
  std::uint64_t last() const override { return (end_ + size_ - 1) / size_; }
  std::string name_of(std::uint64_t chunk) const override {
    return fmt::format("{}-{:012}-{}", name_, range(chunk).first, range(chunk).count);
  }
  std::optional<std::string> compute(std::uint64_t chunk) override {
    const std::optional<Tally> tally = compute_(range(chunk));
    return tally ? std::optional(io::tally_json(*tally).dump()) : std::nullopt;
  }
  void check(std::uint64_t chunk, std::string_view result) const override {
    if (machines_in(result) != range(chunk).count) {
      throw Error(fmt::format("expected the sums of {} machines, got something else", range(chunk).count));
    }
  }
  void add(std::string_view result) override { tally_.add(io::tally_of(Json::parse(result))); }
  std::string total() const override { return io::tally_json(tally_).dump(); }
  void clear() override { tally_ = {}; }

  const Tally& tally() const { return tally_; }

 private:
  static std::optional<std::uint64_t> machines_in(std::string_view result) {
    try {
      return io::tally_of(Json::parse(result)).machines();
    } catch (const std::exception&) {
      return std::nullopt;
    }
  }
  MachineRange range(std::uint64_t chunk) const { return {chunk * size_, std::min(size_, end_ - chunk * size_)}; }

  std::string name_;
  std::uint64_t begin_, end_, size_;
  Compute compute_;
  Tally tally_;
};

}  // namespace

Json description(const Batch& batch, ChunkSizes sizes) {
  Json json = io::to_json(batch);
  json["chunks"] = {{"first_order", sizes.first_order}, {"exact", sizes.exact}};
  return json;
}

ChunkSizes chunk_sizes(const Json& description) {
  const Json& chunks = description.at("chunks");
  const ChunkSizes sizes{chunks.at("first_order").get<std::uint64_t>(), chunks.at("exact").get<std::uint64_t>()};
  if (sizes.exact == 0) throw InvalidArgument("chunks: expected at least one machine per chunk, got 0");
  return sizes;
}

ExactMachines exact_machines(std::uint64_t machines) {
  constexpr std::uint64_t kOneIn = 16, kEnough = 4096;  // z^2 / n < 0.001 at 95 %
  const std::uint64_t half = machines / 2 / kLargestExactChunk * kLargestExactChunk;
  const std::uint64_t most = std::min(machines, std::max(exact_round(0), half));
  return {std::min({machines / kOneIn, kEnough, most}), most};
}

BatchResult run_batch(const Batch& batch, const BatchJobOptions& options, ChunkSizes sizes, LongJob& job,
                      const std::atomic<bool>& stop) {
  if (options.machines == 0) throw InvalidArgument("batch: expected at least one machine, got 0");
  if (batch.surrogate && kLargestExactChunk % sizes.exact != 0) {
    throw InvalidArgument(
        fmt::format("chunks: expected a divisor of {} exact machines, got {}", kLargestExactChunk, sizes.exact));
  }
  BatchResult result;
  const auto run = [&](const std::string& name, MachineRange machines, std::uint64_t size, auto compute) {
    MachineStage stage(name, machines, size,
                       [&](MachineRange range) { return compute(batch, range, options.threads, stop); });
    result.complete = job.run(stage);
    result.tally.add(stage.tally());
    return result.complete;
  };
  if (!batch.surrogate) {
    run("exact", {0, options.machines}, sizes.exact, exactly);
    return result;
  }
  if (!run("first-order", {0, options.machines}, sizes.first_order, to_first_order)) return result;
  const auto [fewest_of_any, most] = exact_machines(options.machines);
  const std::uint64_t fewest = std::max(options.least_exact, fewest_of_any);
  std::uint64_t done = 0;
  for (std::uint64_t round = 0; done < most; ++round) {
    if (done >= fewest && done > 0 && relative_interval(result.tally, options.confidence) <= options.interval) {
      break;
    }
    const std::uint64_t next = std::min(most, exact_round(round));
    if (next <= done) continue;
    if (!run("exact", {done, next - done}, sizes.exact, exactly)) return result;
    done = next;
  }
  return result;
}

}  // namespace paracal::jobs

#include "yield_plan.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>

#include "interruption.hpp"
#include "jobs/batch_job.hpp"
#include "jobs/gzip.hpp"
#include "paracal/io/tally_json.hpp"

namespace paracal::app {
namespace {

constexpr std::array kCores{1, 2, 16, 128, 1024};
constexpr double kMostBytes = 1e4;  // of a chunk: when no bin is empty, more machines add little

struct Measured {
  Tally tally;
  double seconds = 0.0, bytes = 0.0;  ///< bytes: of the chunk's file
};

template <typename Compute>
Measured measured(const Batch& batch, std::uint64_t machines, Compute&& compute) {
  const auto begin = std::chrono::steady_clock::now();
  std::optional<Tally> tally = compute(batch, {0, machines}, 1, flag_of_interruption());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!tally) end_by_interruption();
  const auto bytes = static_cast<double>(jobs::gzip(io::tally_json(*tally).dump()).size());
  return {*std::move(tally), took.count(), bytes};
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::uint64_t chunks_of(std::uint64_t machines, std::uint64_t size) { return (machines + size - 1) / size; }

/// The interval shrinks with the root of the number.
std::uint64_t expected_exact(const Tally& tally, std::uint64_t machines, double interval, double confidence) {
  const double ratio = relative_interval(tally, confidence) / interval;
  const auto [fewest, most] = jobs::exact_machines(machines);
  const double wanted = static_cast<double>(tally.produced()) * std::max(ratio * ratio, 1.0);
  return std::clamp(static_cast<std::uint64_t>(std::min(wanted, static_cast<double>(most))), fewest, most);
}

std::string time_text(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < kMinute) return fmt::format("{:.2g} s", seconds);
  if (seconds < kHour) return fmt::format("{:.0f} min", seconds / kMinute);
  return fmt::format("{:.3g} h", seconds / kHour);
}

}  // namespace

YieldPlan measured_plan(const Batch& batch, ChunkSizes sizes, std::uint64_t machines, double interval,
                        double confidence) {
  YieldPlan plan{.machines = machines, .exact_machines = machines};
  constexpr std::uint64_t kTried = 64;  // a third of a second
  Measured exact = measured(batch, std::min(machines, batch.surrogate ? exact_round(0) : kTried), exactly);
  const auto tried = static_cast<double>(exact.tally.produced());
  plan.exact_ms = 1e3 * exact.seconds / tried;
  plan.bytes_a_chunk = std::min(exact.bytes * static_cast<double>(sizes.exact) / tried, kMostBytes);
  plan.longest_chunk_s = 1e-3 * plan.exact_ms * static_cast<double>(sizes.exact);
  if (batch.surrogate) {
    const std::uint64_t few = std::min(machines, sizes.first_order);
    const Measured linear = measured(batch, few, to_first_order);
    exact.tally.add(linear.tally);
    plan.first_order_us = 1e6 * linear.seconds / static_cast<double>(few);
    plan.bytes_a_chunk = std::max(plan.bytes_a_chunk, linear.bytes);
    plan.longest_chunk_s =
        std::max(plan.longest_chunk_s, 1e-6 * plan.first_order_us * static_cast<double>(sizes.first_order));
    plan.exact_machines = expected_exact(exact.tally, machines, interval, confidence);
    plan.chunks = chunks_of(machines, sizes.first_order);
  }
  plan.chunks += chunks_of(plan.exact_machines, sizes.exact);
  plan.core_seconds = 1e-3 * plan.exact_ms * static_cast<double>(plan.exact_machines) +
                      1e-6 * plan.first_order_us * static_cast<double>(machines);
  plan.megabytes = peak_megabytes();
  return plan;
}

std::string text_of(const YieldPlan& plan) {
  std::string text =
      fmt::format("predicted cost of a batch of {} machines, from rates measured now on one core\n", plan.machines);
  const auto out = std::back_inserter(text);
  if (plan.first_order_us > 0.0) {
    fmt::format_to(out, "  first-order model: {:.3g} us per machine\n", plan.first_order_us);
  }
  fmt::format_to(out, "  exact model: {:.3g} ms per machine, for about {} machines\n", plan.exact_ms,
                 plan.exact_machines);
  fmt::format_to(out, "  total: {} on one core; shortest time on\n", time_text(plan.core_seconds));
  for (const int cores : kCores) {
    const double seconds = std::max(plan.core_seconds / cores, plan.longest_chunk_s);
    fmt::format_to(out, "  {:>6} core{} {:>9}\n", cores, cores == 1 ? " " : "s", time_text(seconds));
  }
  fmt::format_to(out,
                 "  memory: {:.0f} MB per process; a process that fails loses {} of work\n"
                 "  with --checkpoint: {} files of at most {:.1f} kB, {:.3g} MB in total\n",
                 plan.megabytes, time_text(plan.longest_chunk_s), plan.chunks, plan.bytes_a_chunk / 1e3,
                 static_cast<double>(plan.chunks) * plan.bytes_a_chunk / 1e6);
  return text;
}

io::Json json_of(const YieldPlan& plan) {
  const auto on = [&](int cores) {
    return io::Json{{"cores", cores}, {"seconds", std::max(plan.core_seconds / cores, plan.longest_chunk_s)}};
  };
  return {{"machines", plan.machines},
          {"exact_machines", plan.exact_machines},
          {"exact_machine_ms", plan.exact_ms},
          {"first_order_machine_us", plan.first_order_us},
          {"core_seconds", plan.core_seconds},
          {"cores", io::json_array(kCores, on)},
          {"chunks", plan.chunks},
          {"bytes_a_chunk", plan.bytes_a_chunk},
          {"chunk_seconds", plan.longest_chunk_s},
          {"process_mb", plan.megabytes}};
}

}  // namespace paracal::app

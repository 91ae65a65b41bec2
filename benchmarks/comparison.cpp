#include "comparison.hpp"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host.hpp"
#include "interleaved_timing.hpp"

namespace paracal::benchmark {
namespace {

using nlohmann::json;

json host_record() {
  const Host host = this_host();
  return {{"version", host.version}, {"build", host.build},       {"cpu", host.cpu},
          {"cores", host.cores},     {"compiler", host.compiler}, {"flags", host.flags}};
}

/// The first record of a process says where it ran.
void append(const json& record) {
  static const char* const path = std::getenv("PARACAL_COMPARISON");
  if (path == nullptr) return;
  static std::ofstream file = [] {
    std::ofstream opened(path, std::ios::app);
    opened << host_record() << '\n';
    return opened;
  }();
  file << record << std::endl;
}

double in_unit(double seconds, const std::string& unit) {
  if (unit.starts_with("ms")) return 1e3 * seconds;
  if (unit.starts_with("us")) return 1e6 * seconds;
  return unit.starts_with("ns") ? 1e9 * seconds : seconds;
}

}  // namespace

void compare(const Comparison& comparison, const Work& ours, const Work& theirs) {
  const Quartiles times = ratio_quartiles(theirs.seconds, ours.seconds);
  const double by_count = ours.count / theirs.count;
  const auto each = [&](const Work& work) {
    return in_unit(spread_of(work.seconds).median / work.count, comparison.unit);
  };
  append({{"task", comparison.task},
          {"opponent", comparison.opponent},
          {"unit", comparison.unit},
          {"threads", comparison.threads},
          {"note", comparison.note},
          {"rounds", ours.seconds.size()},
          {"ours", each(ours)},
          {"theirs", each(theirs)},
          {"times", {by_count * times.low, by_count * times.median, by_count * times.high}}});
}

void not_installed(const std::string& task, const std::string& opponent, const std::string& package) {
  append({{"task", task}, {"opponent", opponent}, {"missing", package}});
}

void compare_with_peak(const std::string& task, const std::string& unit, double count, double operations,
                       const std::vector<double>& seconds, const Peak& peak, const std::vector<double>& peak_seconds,
                       const std::vector<double>& compiled_seconds) {
  const double median = spread_of(seconds).median, work = count * operations;
  append({{"task", task},
          {"unit", unit},
          {"ours", in_unit(median / count, unit)},
          {"gflops", 1e-9 * work / median},
          {"peak", peak.name},
          {"peak_gflops", 1e-9 * peak.operations / spread_of(peak_seconds).median},
          {"compiled_gflops", 1e-9 * compiled_peak().operations / spread_of(compiled_seconds).median},
          {"share", median_ratio(peak_seconds, seconds) * work / peak.operations},
          {"share_compiled", median_ratio(compiled_seconds, seconds) * work / compiled_peak().operations}});
}

void state(const std::string& what, double value, const std::string& unit) {
  append({{"what", what}, {"value", value}, {"unit", unit}});
}

}  // namespace paracal::benchmark

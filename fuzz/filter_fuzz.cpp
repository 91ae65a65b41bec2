// G-code and pose tables through the filters that correct their targets. As many lines come out as go in; where nothing
// was corrected, the same bytes.

#include <algorithm>
#include <sstream>

#include "fuzzing.hpp"
#include "paracal/filter/target_filter.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::fuzz {
namespace {

const TargetCorrection& correction(unsigned choice) {
  const auto of = [](unsigned which) {
    RandomStream random(1, which);
    return TargetCorrection(robot(which), draw_errors(robot(which), tolerances_of(robot(which)), random));
  };
  static const std::array all{of(0), of(1), of(2)};
  return all[choice % all.size()];
}

void filter(const Input& input) {
  std::istringstream text(input.text);
  std::string out;
  const io::TextSink sink = [&](std::string_view piece) { out += piece; };
  const TargetCorrection& machine = correction(input.choice / 2);
  const io::FilterSummary summary = input.choice % 2 == 0
                                        ? io::filter_gcode({"part.gcode", text}, sink, machine, {.threads = 1})
                                        : io::filter_pose_table({"targets.csv", text}, sink, machine, 1);
  const auto added = std::ranges::count(out, '\n') - std::ranges::count(input.text, '\n');
  // The last line may have no end, and then the pieces before it have one.
  require(added == summary.added);
  require(summary.corrected > 0 || out == input.text);
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return paracal::fuzz::run(data, size, paracal::fuzz::filter);
}

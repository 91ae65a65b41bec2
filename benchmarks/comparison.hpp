#pragma once

#include <string>
#include <vector>

#include "peak.hpp"

namespace paracal::benchmark {

// Records for tools/comparison.sh: lines of JSON, appended to the file named by PARACAL_COMPARISON. Without it nothing
// is written.

/// One candidate of interleave().
struct Work {
  const std::vector<double>& seconds;  ///< round by round
  double count = 1.0;                  ///< how often a pass does what is compared
};

struct Comparison {
  std::string task;
  std::string opponent;
  std::string unit;       ///< "ms per fit": s, ms, us or ns first
  int threads = 1;        ///< of both
  std::string note = {};  ///< where the two differ in what they do
};

/// Theirs over ours, round by round.
void compare(const Comparison& comparison, const Work& ours, const Work& theirs);

/// An opponent that is not there.
void not_installed(const std::string& task, const std::string& opponent, const std::string& package);

/// What share of a core's multiply-add peak a function gets to: of the processor's widest registers, and of the
/// instructions that this was compiled with.
/// @param operations  floating point operations of each of the `count` times that a pass does it
void compare_with_peak(const std::string& task, const std::string& unit, double count, double operations,
                       const std::vector<double>& seconds, const Peak& peak, const std::vector<double>& peak_seconds,
                       const std::vector<double>& compiled_seconds);

/// A time, or another figure, by itself.
void state(const std::string& what, double value, const std::string& unit);

}  // namespace paracal::benchmark

#pragma once

#include <string>

namespace paracal::benchmark {

/// Multiplications and additions as fast as one core does them: the limit that the kinematics are held against.
/// Independent accumulators, all in registers, hide the latency.
struct Peak {
  std::string name;   ///< of the instructions
  double operations;  ///< floating point operations of one pass
  void (*pass)();
};

/// With the flags that this was compiled with.
Peak compiled_peak();

/// With the widest multiply-add that this processor has.
Peak machine_peak();

}  // namespace paracal::benchmark

#pragma once

#include <string>

namespace paracal::benchmark {

/// Multiplications and additions at the full speed of one core: the limit to which the kinematics are compared.
/// Independent accumulators in registers hide the latency.
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

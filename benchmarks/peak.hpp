#pragma once

namespace paracal::benchmark {

/// Floating point operations of one call of peak_pass().
double peak_operations();

/// Multiplications and additions as fast as one core does them with the flags that this was compiled with: the limit
/// that the kinematics are held against. Independent accumulators, all in registers, hide the latency.
void peak_pass();

}  // namespace paracal::benchmark

#pragma once

#include <string>

#include "paracal/batch/batch.hpp"
#include "paracal/io/json.hpp"

namespace paracal::app {

/// What a batch would cost, from rates that are measured here and now on one core.
struct YieldPlan {
  std::uint64_t machines = 0, exact_machines = 0, chunks = 0;
  double exact_ms = 0.0, first_order_us = 0.0;  ///< of a machine; first order: 0 where all are exact
  double core_seconds = 0.0, longest_chunk_s = 0.0, megabytes = 0.0, bytes_a_chunk = 0.0;
};

/// Computes two chunks to measure them.
/// @param interval  that ends the exact rounds of a batch with a surrogate
YieldPlan measured_plan(const Batch& batch, ChunkSizes sizes, std::uint64_t machines, double interval,
                        double confidence);

std::string text_of(const YieldPlan& plan);
io::Json json_of(const YieldPlan& plan);

}  // namespace paracal::app

#pragma once

#include <functional>

namespace paracal::benchmark {

/// Largest resident memory of a process that only runs `task`, MB. It is forked from this process, so its memory is
/// included.
double peak_memory(const std::function<void()>& task);

}  // namespace paracal::benchmark

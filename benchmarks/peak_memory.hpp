#pragma once

#include <functional>

namespace paracal::benchmark {

/// Largest resident memory of a process that does nothing but `task`, MB; it is forked from this one, whose resident
/// memory counts as well.
double peak_memory(const std::function<void()>& task);

}  // namespace paracal::benchmark

#pragma once

#include "task.hpp"

namespace paracal::benchmark {

/// Speed of the G-code filter, compared with the same lines as comments, and its memory for a short and a long program.
void report_filter(const Task& task);

}  // namespace paracal::benchmark

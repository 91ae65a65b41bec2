#pragma once

#include <string>

namespace paracal::benchmark {

/// What the figures were measured on: CPU model, compiler, build type and flags, one a line.
std::string host_description();

}  // namespace paracal::benchmark

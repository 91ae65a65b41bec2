#pragma once

#include <string>
#include <string_view>

namespace paracal::benchmark {

/// What the figures were measured on: CPU model, compiler, build type and flags, one a line.
/// @param use  of its cores
std::string host_description(std::string_view use = "one thread is used unless stated");

}  // namespace paracal::benchmark

#pragma once

// Private to the programs: texts as gzip keeps them.

#include <string>
#include <string_view>

namespace paracal::jobs {

std::string gzip(std::string_view text);

/// @throws Error for what gzip has not made, is not whole, or is longer than 64 MiB.
std::string gunzip(std::string_view bytes);

}  // namespace paracal::jobs

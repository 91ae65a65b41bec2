#pragma once

// Private to the programs: texts as gzip keeps them.

#include <string>
#include <string_view>

namespace paracal::jobs {

std::string gzip(std::string_view text);

/// Of a chunk: fifteen histograms of 16,384 bins take 1 MB, thousands of pairs as much.
inline constexpr std::size_t kLongestText = std::size_t{4} << 20;

/// @throws Error for what gzip has not made, is not whole, or is longer than kLongestText.
std::string gunzip(std::string_view bytes);

}  // namespace paracal::jobs

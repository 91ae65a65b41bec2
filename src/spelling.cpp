#include "paracal/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace paracal {
namespace {

/// Letters to insert, delete, change or swap with their neighbours until one word is the other (Damerau and
/// Levenshtein, no letter twice).
std::size_t distance(std::string_view one, std::string_view other) {
  const std::size_t width = other.size() + 1;
  std::vector<std::size_t> needed((one.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t k) -> std::size_t& { return needed[i * width + k]; };
  for (std::size_t i = 0; i <= one.size(); ++i) at(i, 0) = i;
  for (std::size_t k = 0; k <= other.size(); ++k) at(0, k) = k;
  for (std::size_t i = 1; i <= one.size(); ++i) {
    for (std::size_t k = 1; k <= other.size(); ++k) {
      const std::size_t changed = at(i - 1, k - 1) + (one[i - 1] == other[k - 1] ? 0 : 1);
      at(i, k) = std::min({changed, at(i - 1, k) + 1, at(i, k - 1) + 1});
      const bool swapped = i > 1 && k > 1 && one[i - 1] == other[k - 2] && one[i - 2] == other[k - 1];
      if (swapped) at(i, k) = std::min(at(i, k), at(i - 2, k - 2) + 1);
    }
  }
  return needed.back();
}

}  // namespace

std::optional<std::string> meant_by(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t kLettersAMistake = 3, kLongest = 100;
  if (known.empty() || word.size() > kLongest) return std::nullopt;
  const auto letters = static_cast<std::size_t>(std::ranges::count_if(word, [](char one) { return one != '-'; }));
  const auto nearest = std::ranges::min_element(known, {}, [&](const std::string& one) { return distance(word, one); });
  if (distance(word, *nearest) > std::max<std::size_t>(1, (letters + 1) / kLettersAMistake)) return std::nullopt;
  return *nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const auto meant = meant_by(word, known);
  return meant ? fmt::format(" (did you mean {}?)", *meant) : std::string();
}

}  // namespace paracal

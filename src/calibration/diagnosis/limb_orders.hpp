#pragma once

// Private to calibration: in which other orders joints may have been connected.

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace paracal::detail {

/// Other orders of limbs: all of a few; of many those that begin elsewhere, run the other way round, or swap two.
inline std::vector<std::vector<Eigen::Index>> limb_orders(std::size_t count) {
  constexpr std::size_t kFew = 4;
  std::vector<Eigen::Index> order(count);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const std::vector<Eigen::Index> right = order;
  std::vector<std::vector<Eigen::Index>> all;
  if (count <= kFew) {
    while (std::ranges::next_permutation(order).found) all.push_back(order);
    return all;
  }
  for (const bool reversed : {false, true}) {
    for (std::size_t first = 0; first < count; ++first) {
      order = right;
      if (reversed) std::reverse(order.begin(), order.end());
      std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(first), order.end());
      if (order != right) all.push_back(order);
    }
  }
  for (std::size_t one = 0; one < count; ++one) {
    for (std::size_t other = one + 1; other < count; ++other) {
      order = right;
      std::swap(order[one], order[other]);
      all.push_back(order);
    }
  }
  return all;
}

}  // namespace paracal::detail

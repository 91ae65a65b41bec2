#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

namespace paracal::detail {

/// The upper one of an even number. @param values  at least one.
inline double median(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, half);
  return *half;
}

/// Components in which `values` have their medians.
inline Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    column.reserve(values.size());
    for (const Eigen::Vector3d& value : values) column.push_back(value(axis));
    middle(axis) = median(std::move(column));
  }
  return middle;
}

}  // namespace paracal::detail

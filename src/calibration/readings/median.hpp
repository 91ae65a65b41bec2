#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace paracal::detail {

/// Components in which `values` have their medians.
inline Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    column.reserve(values.size());
    for (const Eigen::Vector3d& value : values) column.push_back(value(axis));
    const auto half = column.begin() + static_cast<std::ptrdiff_t>(column.size() / 2);
    std::ranges::nth_element(column, half);
    middle(axis) = *half;
  }
  return middle;
}

}  // namespace paracal::detail

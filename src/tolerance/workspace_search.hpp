#pragma once

#include <functional>

#include "paracal/tolerance/sensitivity.hpp"

namespace paracal::detail {

/// Largest value of a function over the workspace: the best three points of a polar grid with all rotations and tilts,
/// each refined in cylindrical coordinates without leaving the workspace.
ValueAtPose largest_in_workspace(const Robot& robot, const std::function<double(const Pose&)>& value);

}  // namespace paracal::detail

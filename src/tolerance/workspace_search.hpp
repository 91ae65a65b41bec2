#pragma once

#include <functional>

#include "paracal/tolerance/sensitivity.hpp"

namespace paracal::detail {

/// Largest value of a function over the workspace: the six best points of a polar grid with all rotations and tilts
/// that are not near each other, each refined in cylindrical coordinates without leaving the workspace. (The best three
/// of all are neighbours as a rule, and of several tops the highest need not have the best point of the grid.)
ValueAtPose largest_in_workspace(const Robot& robot, const std::function<double(const Pose&)>& value);

}  // namespace paracal::detail

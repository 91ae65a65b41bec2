#pragma once

// Private to mechanism: what is asked of a plate on struts before it is a robot.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// @throws InvalidArgument naming the quantity.
void require_positive_mm(std::string_view quantity, double value);

/// Six of them, each with places and a length, no two between the same joints.
void check_struts(const std::vector<Strut>& struts);

/// The whole workspace is on one side of the base, and its tilt less than a right angle.
void check_side(const Workspace& workspace);

/// Struts reach everywhere, but do not hold the plate everywhere: at the centre of the workspace and its rims they do.
void check_hold(const Machine& machine, const Geometry& geometry, const Workspace& workspace);

/// Why there can be no such strut; empty where there can.
std::optional<std::string> absurd_strut(const Strut& strut, const SourceErrors& errors, std::size_t limb);

}  // namespace paracal::detail

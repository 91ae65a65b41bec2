#pragma once

// Private to mechanism: what is asked of a plate on limbs with one rod before it is a robot.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// @throws InvalidArgument naming the quantity.
void require_positive_mm(std::string_view quantity, double value);

/// Lengths, and how far the joints stand from the middle, with what a refusal calls them.
std::vector<std::pair<std::string, double>> dimensions_of(const Geometry& geometry);

/// As many as the plate has freedoms, each with places, lengths and directions, no two alike.
void check_single_rods(const Geometry& geometry);

/// The whole workspace is on one side of the base, or in the plane in which guides hold the plate, and its tilt less
/// than a right angle.
void check_side(const Workspace& workspace, const PlateFreedoms& freedoms);

/// Why there can be no such limb; empty where there can.
std::optional<std::string> absurd_single_rod(const Geometry& geometry, const SourceErrors& errors, std::size_t limb);

/// The same of a drive that is a length: it goes forward with its joint, whatever its gain.
std::optional<std::string> backward_drive(const SourceErrors& errors, std::size_t limb);

}  // namespace paracal::detail

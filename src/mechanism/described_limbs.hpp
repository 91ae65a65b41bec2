#pragma once

// Private to mechanism: what is asked of limbs with their own dimensions before they are a robot.

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

/// At least as many as the plate has degrees of freedom, each with places, lengths and directions, no two alike.
void check_described_limbs(const Geometry& geometry, bool has_slide);

/// The whole workspace is on one side of the base, or in the plane in which guides hold the plate, and its tilt less
/// than a right angle.
void check_side(const Workspace& workspace, const PlateFreedoms& freedoms);

}  // namespace paracal::detail

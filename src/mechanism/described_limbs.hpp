#pragma once

// Private to mechanism: what is asked of limbs before they are a robot.

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
std::vector<std::pair<std::string, double>> dimensions_of(const Limbs& limbs);

/// At least as many as the plate has degrees of freedom, each with places, lengths and directions, no two alike.
void check_described_limbs(const Limbs& limbs, const PlateFreedoms& freedoms, bool has_slide);

/// The workspace is flat where guides hold the plate in a plane, and only there; its tilt is less than a right angle.
void check_workspace_of_limbs(const Workspace& workspace, const PlateFreedoms& freedoms);

}  // namespace paracal::detail

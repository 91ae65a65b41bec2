#pragma once

#include <string_view>
#include <vector>

#include "paracal/mechanism/robot.hpp"

/// The robots of the catalogue.
namespace paracal::catalogue {

/// The pick-and-place robot (4 degrees of freedom, articulated plate) of [huang2016, Table 1]. Tolerances: Table 2
/// for the tilt group. The paper states none for the position group: default values, about twice the largest error of
/// its Table 4.
Robot huang2016();

/// A rotary Delta: three limbs, rigid plate. Arms 400 mm and rods 950 mm as in the Delta of [shang2025];
/// the other dimensions are round numbers of the same class.
Robot rotary_delta();

/// A linear-delta printer: three rails, rigid plate. Round numbers of a desktop printer (delta radius 185 - 20 - 35 =
/// 130 mm, rods 290 mm) with the towers as in the firmwares.
Robot linear_delta();

/// Names for find().
std::vector<std::string_view> names();

/// @throws InvalidArgument when no robot has that name; the message lists the names.
Robot find(std::string_view name);

}  // namespace paracal::catalogue

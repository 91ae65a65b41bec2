#pragma once

#include <string_view>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// @param task  what is not done for plates on limbs with one rod.
/// @throws InvalidArgument naming it, unless parallelograms keep the plate level.
void check_level(const Robot& robot, std::string_view task);

}  // namespace paracal

#pragma once

#include <string_view>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// @param task  what is not done for plates with six freedoms.
/// @throws InvalidArgument naming it, unless the plate stays level.
void check_level(const Robot& robot, std::string_view task);

}  // namespace paracal

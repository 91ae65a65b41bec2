#include "paracal/mechanism/level.hpp"

#include <fmt/format.h>

#include "paracal/error.hpp"

namespace paracal {

void check_level(const Robot& robot, std::string_view task) {
  if (!robot.on_single_rods()) return;
  throw InvalidArgument(
      fmt::format("{}: expected a robot whose plate stays level on parallelograms, got {}, whose limbs have one rod "
                  "each: this function does not support them (docs/hexapods.md)",
                  task, robot.name()));
}

}  // namespace paracal

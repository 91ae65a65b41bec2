#include "paracal/mechanism/level.hpp"

#include <fmt/format.h>

#include "paracal/error.hpp"

namespace paracal {

void check_level(const Robot& robot, std::string_view task) {
  if (robot.is_level()) return;
  throw InvalidArgument(
      fmt::format("{}: expected a robot whose plate three or four parallelograms keep level, got {}: this "
                  "function does not support it (docs/hexapods.md)",
                  task, robot.name()));
}

}  // namespace paracal

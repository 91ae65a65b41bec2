#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "export_text.hpp"
#include "paracal/error.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

std::string coordinates(std::string_view of, std::size_t limb, const Eigen::Vector3d& point) {
  std::string text;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    text += fmt::format("setp genhexkins.{}.{}.{} {}\n", of, limb, "xyz"[axis], point(axis));
  }
  return text;
}

/// "strut.0,strut.1,..."
std::string names(std::string_view name) {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i) text += fmt::format("{}{}.{}", i == 0 ? "" : ",", name, i);
  return text;
}

std::string scale(std::string_view name, std::size_t limb, double gain, double offset) {
  return fmt::format("setp {0}.{1}.gain {2}\nsetp {0}.{1}.offset {3}\naddf {0}.{1} servo-thread\n", name, limb, gain,
                     offset);
}

}  // namespace

std::string genhexkins(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  const auto is_strut = [](Actuator kind) { return kind.drive == Drive::strut; };
  const bool has_struts = robot.limb_count() == 6 && std::ranges::all_of(kinds_of(robot.limbs()), is_strut);
  if (!has_struts || robot.nominal().has_guides) {
    throw InvalidArgument(fmt::format("genhexkins: expected a plate on six struts, got {}", robot.name()));
  }
  const Machine machine = build(robot, errors);
  std::string base, platform, lengths, drives;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& strut = machine.limbs[i];
    if (strut.turn.sine != 0.0 || strut.turn.cosine != 0.0) {
      throw InvalidArgument(fmt::format(
          "genhexkins: expected struts without errors of each turn, got turn_sine and turn_cosine of limb {}: "
          "LinuxCNC's "
          "own kinematics have no place for them. Use --target linuxcnc, which does, or calibrate with --fix "
          "turn_sine,turn_cosine",
          i + 1));
    }
    const double length = strut.joint_offset, growth = strut.gain();
    base += coordinates("base", i, as_eigen(strut.base));
    platform += coordinates("platform", i, as_eigen(strut.plate));
    lengths += fmt::format("#   [JOINT_{}] LENGTH {} GROWTH {}\n", i, length, growth);
    drives += scale("strut", i, 1.0 / growth, -length / growth) + scale("strut-back", i, growth, length);
  }
  Values values = head(robot, origin);
  values.emplace_back("BASE", base);
  values.emplace_back("PLATFORM", platform);
  values.emplace_back("LENGTHS", lengths);
  values.emplace_back("STRUTS", names("strut"));
  values.emplace_back("STRUTS_BACK", names("strut-back"));
  values.emplace_back("DRIVES", drives);
  return filled_template("genhexkins.hal", values);
}

}  // namespace paracal

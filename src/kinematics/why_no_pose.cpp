#include <fmt/format.h>

#include <string_view>

#include "paracal/kinematics/forward.hpp"

namespace paracal {
namespace {

std::string_view reason(const Machine& machine, const ForwardResult& result) {
  const bool misses = result.residual > ForwardOptions{}.max_residual;
  switch (result.status) {
    case ForwardStatus::strained:
      return machine.spare_limbs() > 0 ? "the joints of its limbs disagree" : "the rods do not meet";
    case ForwardStatus::singular:
      return misses ? "the rods do not meet" : "the joints do not hold the plate";
    case ForwardStatus::other_mode:
      return "the rods meet in another assembly mode, outside of the workspace";
    default:
      return misses ? "the rods do not meet" : "the iteration did not converge";
  }
}

}  // namespace

std::string why_no_pose(const Machine& machine, const ForwardResult& result) {
  return fmt::format("{} (largest rod residual {:.3g} mm after {} iterations)", reason(machine, result),
                     result.residual, result.iterations);
}

}  // namespace paracal

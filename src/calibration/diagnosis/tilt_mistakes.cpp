#include "mistakes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "command_mistakes.hpp"

namespace paracal::detail {
namespace {

/// "tilt_x and tilt_z"
std::string tilts_named(const Eigen::Vector3d& of) {
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis) {
    if (of(axis) != 0.0) names.push_back(fmt::format("tilt_{}", "xyz"[axis]));
  }
  return fmt::format("{}", fmt::join(names, " and "));
}

std::string rotations_named(const RotationOrder& order) {
  std::vector<std::string> factors;
  for (const int axis : order) factors.push_back(fmt::format("Rot({0}, tilt_{0})", "xyz"[axis]));
  return fmt::format("{}", fmt::join(factors, " "));
}

}  // namespace

std::vector<Mistake> tilt_mistakes(const Input& given) {
  if (!commands_count(given.measurements) || !commands_tilt(given.measurements)) return {};
  std::vector<Mistake> all;
  const auto add = [&](std::string text, std::function<void(Measurements&)> undo) {
    all.push_back(mistake_of_measurements("tilt", std::move(text), std::move(undo)));
  };
  const auto changed = [&](std::string text, const Eigen::Matrix3d& change) {
    add(std::move(text), [change](Measurements& m) { change_tilts(m, change); });
  };
  changed("the commanded tilts are in rad, not deg", kRadInDegrees * Eigen::Matrix3d::Identity());
  changed("the commanded tilts have the opposite sign", -Eigen::Matrix3d::Identity());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d one = Eigen::Vector3d::Unit(axis), others = Eigen::Vector3d::Ones() - one;
    for (const Eigen::Vector3d& wrong : {one, others}) {
      changed(fmt::format("the commanded {} {} the opposite sign", tilts_named(wrong), wrong == one ? "has" : "have"),
              (Eigen::Vector3d::Ones() - 2.0 * wrong).asDiagonal());
    }
    Eigen::Matrix3d swapped = Eigen::Matrix3d::Identity();
    swapped.col((axis + 1) % 3).swap(swapped.col((axis + 2) % 3));
    changed(fmt::format("the commanded {} are swapped", tilts_named(others)), swapped);
  }
  constexpr RotationOrder kOurs{0, 1, 2};
  for (RotationOrder order = kOurs; std::ranges::next_permutation(order).found;) {
    add(fmt::format("the commanded tilts are of {}, not of {}", rotations_named(order), rotations_named(kOurs)),
        [order](Measurements& m) { reorder_tilts(m, order); });
  }
  return all;
}

}  // namespace paracal::detail

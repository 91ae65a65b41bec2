// Displacements of the plate centre that a dial gauge shows along a known direction u_0, from wherever it was zeroed:
//
//   dial       u . r - zero,     u = (u_0 + a e_1 + b e_2) / |...|,   e_1, e_2, u_0 orthonormal
//
// with the zero sought, and the small angles a and b by which it is set up askew, as far as options allow for them.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "length_model.hpp"
#include "numerics/median.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

constexpr double kAskew = to_radians(0.5);  // a gauge set up with a square

/// u as the angles have it, and how it changes with them.
struct Plunger {
  Eigen::Vector3d along;
  Eigen::Matrix<double, 3, 2> by_angles;
};

Plunger plunger(const LengthSeries& series, double a, double b) {
  const Eigen::Vector3d meant = series.at.value_or(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = meant.unitOrthogonal();
  across.col(1) = meant.cross(across.col(0));
  const Eigen::Vector3d sum = meant + across * Eigen::Vector2d(a, b);
  const Eigen::Vector3d along = sum.normalized();
  return {along, (across - along * (along.transpose() * across)) / sum.norm()};
}

class Dial final : public LengthModel {
 public:
  LengthWords words() const override {
    return {.kind = LengthKind::dial,
            .name = "dial",
            .noun = "dial reading",
            .plural = "dial readings",
            .column = "dial_mm",
            .list = "dial_readings",
            .set_ups = "dials",
            .reversed = "the dial has the opposite sign",
            .at_columns = {"direction_x", "direction_y", "direction_z"},
            .at = "the direction that it measures",
            .needs_at = true,
            .unknowns = 1};
  }
  bool shows_scale() const override { return false; }

  SetUp units(const CalibrationOptions& options) const override {
    constexpr double kZero = 100.0;  // mm
    return Eigen::Vector3d(kZero, askew(options), askew(options));
  }

  LengthShown shown(const Eigen::Vector3d& place, const SetUp& set_up, const LengthSeries& series) const override {
    const Plunger plunger = detail::plunger(series, set_up(1), set_up(2));
    LengthShown shown{plunger.along.dot(place) - set_up(0), plunger.along.transpose(), Eigen::RowVector3d::Zero()};
    shown.by_set_up(0) = -1.0;
    shown.by_set_up.tail<2>() = place.transpose() * plunger.by_angles;
    return shown;
  }

  StartedSetUp start(const LengthsRead& read, const LengthSeries& series,
                     const CalibrationOptions& options) const override {
    const Plunger straight = plunger(series, 0.0, 0.0);
    std::vector<double> zeros;
    for (std::size_t k = 0; k < read.places.size(); ++k) {
      zeros.push_back(straight.along.dot(read.places[k]) - read.lengths[k]);
    }
    StartedSetUp started{Eigen::Vector3d(zeros.empty() ? 0.0 : median(zeros), 0.0, 0.0)};
    if (!options.noise.dial_angle) {
      started.assumed =
          fmt::format("the dial of {} points along the stated direction within {:g} deg (standard deviation)",
                      series.name, to_degrees(kAskew));
    }
    return started;
  }

  void add_priors(const Eigen::VectorXd& unknowns, Eigen::Index first, const CalibrationOptions& options,
                  InformationRoot& root) const override {
    for (const Eigen::Index angle : {first + 1, first + 2}) {
      root.add_prior(angle, unknowns(angle), 0.0, askew(options));
    }
  }

  std::vector<std::pair<std::string_view, double>> told(const SetUp& set_up,
                                                        const LengthSeries& series) const override {
    const Eigen::Vector3d along = plunger(series, set_up(1), set_up(2)).along;
    return {{"zero_mm", set_up(0)}, {"direction_x", along.x()}, {"direction_y", along.y()}, {"direction_z", along.z()}};
  }

  /// Zeroed at home.
  SetUp typical(const Robot& robot, const LengthSeries& series) const override {
    return Eigen::Vector3d(plunger(series, 0.0, 0.0).along.dot(robot.workspace().centre()), 0.0, 0.0);
  }

  SetUp random(const Robot& robot, const LengthSeries& series, RandomStream& random) const override {
    constexpr double kZeroed = 1.0;  // mm
    const double zero = kZeroed * random.normal(), a = random.normal(), b = random.normal();
    return typical(robot, series) + Eigen::Vector3d(zero, kAskew * a, kAskew * b);
  }

 private:
  /// An angle that is known exactly is one known to a nanometre on a metre.
  static double askew(const CalibrationOptions& options) {
    return std::max(options.noise.dial_angle.value_or(kAskew), 1e-9);
  }
};

}  // namespace

const LengthModel& dial() {
  static const Dial kModel;
  return kModel;
}

}  // namespace paracal::detail

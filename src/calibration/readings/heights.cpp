// Heights above a plane, or above a paraboloid about the robot's axis:
//
//   height     z - (z_0 + s_x x + s_y y + c (x^2 + y^2))
//
// with z_0 and the slopes sought, and c where its standard deviation is stated.

#include <fmt/format.h>

#include "length_model.hpp"
#include "numerics/median.hpp"

namespace paracal::detail {
namespace {

class Heights final : public LengthModel {
 public:
  LengthWords words() const override {
    return {.kind = LengthKind::height,
            .name = "height",
            .noun = "height",
            .plural = "heights",
            .column = "height_mm",
            .list = "heights",
            .set_ups = "planes",
            .reversed = "the heights are positive downwards",
            .at = "a point of the plane, mm"};
  }
  bool shows_scale() const override { return false; }

  /// A plane tells the robot's own height and level apart from its errors less than a frame's many points do.
  SetUp units(const CalibrationOptions& options) const override {
    if (!options.plane_curvature) return Eigen::Vector3d(100.0, 0.1, 0.1);
    return Eigen::Vector4d(100.0, 0.1, 0.1, 1e-3);
  }

  LengthShown shown(const Eigen::Vector3d& place, const SetUp& plane, const LengthSeries& /*series*/) const override {
    const Eigen::RowVector4d above(1.0, place.x(), place.y(), place.head<2>().squaredNorm());
    const double curvature = plane.size() > 3 ? plane(3) : 0.0;
    const Eigen::Vector2d slope = plane.segment<2>(1) + 2.0 * curvature * place.head<2>();
    return {place.z() - above.head(plane.size()).dot(plane), Eigen::RowVector3d(-slope.x(), -slope.y(), 1.0),
            -above.head(plane.size())};
  }

  /// As level as the robot, and flat.
  StartedSetUp start(const LengthsRead& read, const LengthSeries& series,
                     const CalibrationOptions& options) const override {
    std::vector<double> levels;
    for (std::size_t k = 0; k < read.places.size(); ++k) {
      levels.push_back(read.places[k].z() - read.lengths[k]);
    }
    SetUp level = SetUp::Zero(units(options).size());
    if (!levels.empty()) level(0) = median(levels);
    if (options.plane_curvature) return {level};
    return {level, fmt::format("the surface below the heights of {} is flat: these readings cannot distinguish a "
                               "curved surface from errors of the machine",
                               series.name)};
  }

  void add_priors(const Eigen::VectorXd& unknowns, Eigen::Index first, const CalibrationOptions& options,
                  InformationRoot& root) const override {
    if (options.plane_curvature) root.add_prior(first + 3, unknowns(first + 3), 0.0, *options.plane_curvature);
    if (!options.plane_slope) return;
    root.add_prior(first + 1, unknowns(first + 1), 0.0, *options.plane_slope);
    root.add_prior(first + 2, unknowns(first + 2), 0.0, *options.plane_slope);
  }

  std::vector<std::pair<std::string_view, double>> told(const SetUp& plane,
                                                        const LengthSeries& /*series*/) const override {
    return {{"z_mm", plane(0)}, {"slope_x", plane(1)}, {"slope_y", plane(2)}};
  }

  /// Level.
  SetUp typical(const Robot& /*robot*/, const LengthSeries& series) const override {
    return Eigen::Vector3d(series.at ? series.at->z() : 0.0, 0.0, 0.0);
  }

  /// About as level as beds and surface plates are, somewhere under the robot.
  SetUp random(const Robot& /*robot*/, const LengthSeries& /*series*/, RandomStream& random) const override {
    constexpr double kFar = 300.0, kSlope = 2e-3;
    const double height = kFar * random.normal(), slope_x = kSlope * random.normal(),
                 slope_y = kSlope * random.normal();
    return Eigen::Vector3d(height, slope_x, slope_y);
  }
};

}  // namespace

const LengthModel& heights() {
  static const Heights kModel;
  return kModel;
}

}  // namespace paracal::detail

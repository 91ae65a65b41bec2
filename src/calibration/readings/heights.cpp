// Heights above a plane:
//
//   height     z - (z_0 + s_x x + s_y y)
//
// with z_0 and the slopes sought.

#include "length_model.hpp"

#include "median.hpp"

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
            .reversed = "the heights count downwards",
            .at = "a point of the plane, mm"};
  }
  bool shows_scale() const override { return false; }

  /// A plane tells the robot's own height and level apart from its errors less than a frame's many points do.
  SetUp units(const CalibrationOptions& /*options*/) const override { return Eigen::Vector3d(100.0, 0.1, 0.1); }

  LengthShown shown(const Eigen::Vector3d& place, const SetUp& plane, const LengthSeries& /*series*/) const override {
    const Eigen::RowVector3d above(1.0, place.x(), place.y());
    return {place.z() - above.dot(plane), Eigen::RowVector3d(-plane(1), -plane(2), 1.0), -above};
  }

  /// As level as the robot.
  StartedSetUp start(const LengthsRead& read, const LengthSeries& /*series*/,
                     const CalibrationOptions& /*options*/) const override {
    std::vector<double> levels;
    for (std::size_t k = 0; k < read.places.size(); ++k) {
      levels.push_back(read.places[k].z() - read.lengths[k]);
    }
    return {Eigen::Vector3d(levels.empty() ? 0.0 : median(levels), 0.0, 0.0)};
  }

  void add_priors(const Eigen::VectorXd& unknowns, Eigen::Index first, const CalibrationOptions& options,
                  InformationRoot& root) const override {
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

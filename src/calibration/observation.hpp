#pragma once

// Private to calibration: readings as a function of what is not known.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/information_root.hpp"
#include "paracal/calibration/least_squares.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/rigid_fit.hpp"
#include "paracal/kinematics/closure.hpp"

namespace paracal::detail {

/// Where the machine stands at one station, and how that changes with the sought source errors.
struct StationState {
  PlateState plate;
  double rotation = 0.0;  ///< phi, rad
  /// Rows: position (mm), phi (rad), tilt_x, tilt_y, tilt_z (rad). Columns: the sought sources.
  Eigen::Matrix<double, 7, Eigen::Dynamic> jacobian;
};

enum class ReadingKind : std::uint8_t { distance, point, height };

/// One reading (small: half a million distances are no rarity): 1 or 2 rows for a distance (and its rotation), up to 7
/// for a point (both reflectors, rotation), 1 for a height.
struct Group {
  double weight = 1.0;        ///< of its squared residuals, while a robust loss seeks gross errors
  std::uint32_t series = 0;   ///< of a point or a height
  std::uint32_t index = 0;    ///< into the series' readings or the distances
  std::uint32_t station = 0;  ///< of a point or a height
  ReadingKind kind = ReadingKind::distance;
  bool stated = false;  ///< its standard deviation is known; otherwise noise_scale multiplies it
  bool active = true;   ///< takes part in the fit

  bool is_point() const { return kind == ReadingKind::point; }
  bool is_height() const { return kind == ReadingKind::height; }
  bool is_distance() const { return kind == ReadingKind::distance; }
};

/// All readings as a function of the unknowns
///
///   (nuisance of every series: frame turn, frame shift, [encoder zero], [second reflector];
///    of every plane: z_0, s_x, s_y; [bias of the distances] | sought source errors)
///
/// with the exact machine behind it:
///
///   distance   |r_to - r_from| + bias
///   height     z - (z_0 + s_x x + s_y y)
///   point      t + Q r            r: exact plate centre; Q = exp([turn]) Q_0, Q_0 from a robust rigid fit
///   second     t + Q (r + M rho)  M: rotation of the plate, or of the end-effector
///   rotation   phi - zero
class Observation {
 public:
  Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
              std::vector<SoughtSource> sought);

  Eigen::Index nuisance_count() const { return nuisance_count_; }
  Eigen::Index unknown_count() const { return nuisance_count_ + source_count(); }
  Eigen::Index source_count() const { return static_cast<Eigen::Index>(sought_.size()); }
  const std::vector<SoughtSource>& sought() const { return sought_; }
  std::vector<Group>& groups() { return groups_; }
  const std::vector<Group>& groups() const { return groups_; }
  /// Multiplies the standard deviations that no one stated.
  void set_noise_scale(double scale) { noise_scale_ = scale; }
  double noise_scale() const { return noise_scale_; }
  /// Derivatives at the nominal machine whatever the unknowns: the paper's chord method.
  void keep_nominal_derivative();

  /// Unknowns with these source errors, and the nuisance that then fits best; empty when the machine does not close.
  std::optional<Eigen::VectorXd> start(const SourceErrors& errors);
  /// The source errors of a vector of unknowns; those not sought as at start().
  SourceErrors errors(const Eigen::VectorXd& unknowns) const;
  /// The machine at every station; empty when it does not close at one of them. The last answer is kept: what a fit
  /// settles at is asked for again and again.
  std::shared_ptr<const std::vector<StationState>> stations(const Eigen::VectorXd& unknowns) const;

  /// Rows [J | r] of one reading, r = predicted - measured, divided by the standard deviations. `block` is resized.
  void rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
            Eigen::MatrixXd& block) const;
  /// Adds the rows of all active readings that are chosen; false where the machine does not close.
  template <typename Choice>
  bool add_rows(const Eigen::VectorXd& unknowns, InformationRoot& root, Choice&& chosen) const {
    const auto states = stations(unknowns);
    if (!states) return false;
    Eigen::MatrixXd block;
    for (const Group& group : groups_) {
      if (!group.active || !chosen(group)) continue;
      rows(group, *states, unknowns, block);
      root.add(block);
    }
    return true;
  }
  bool operator()(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
    return add_rows(unknowns, root, [](const Group&) { return true; });
  }

  /// Predicted minus measured point, mm, in the robot's frame.
  Eigen::Vector3d point_residual(const Group& group, const StationState& station,
                                 const Eigen::VectorXd& unknowns) const;
  /// Frame of a series: instrument = frame(robot).
  RigidMotion frame(std::size_t series, const Eigen::VectorXd& unknowns) const;
  /// Rotation reading minus its zero, minus the predicted rotation, with the sign of a residual; empty without one.
  std::optional<double> rotation_residual(const Group& group, const std::vector<StationState>& stations,
                                          const Eigen::VectorXd& unknowns) const;
  /// What was found of a series' set-up; empty where there was nothing to find.
  std::optional<double> rotation_zero(std::size_t series, const Eigen::VectorXd& unknowns) const;
  std::optional<Eigen::Vector3d> second_reflector(std::size_t series, const Eigen::VectorXd& unknowns) const;
  /// Predicted minus measured, mm.
  double distance_residual(const Group& group, const std::vector<StationState>& stations,
                           const Eigen::VectorXd& unknowns) const;
  double height_residual(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns) const;
  /// z_0, s_x, s_y of a plane.
  Eigen::Vector3d plane(std::size_t series, const Eigen::VectorXd& unknowns) const;
  std::optional<double> distance_bias(const Eigen::VectorXd& unknowns) const;
  /// Adds what is known beforehand, as rows: of the sought errors, one by one and together, of slopes and of the bias.
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const;
  std::size_t series_count() const { return nuisance_.size(); }
  const PointReading& point(const Group& group) const {
    return measurements_.series[group.series].readings[group.index];
  }
  const DistanceReading& distance(const Group& group) const { return measurements_.distances[group.index]; }
  const HeightReading& height(const Group& group) const {
    return measurements_.planes[group.series].readings[group.index];
  }
  /// Standard deviation before noise_scale, mm: of a distance; of a coordinate, as a mean over the three.
  double sigma_of(const DistanceReading& reading) const {
    return reading.distance_sigma.value_or(options_.noise.distance);
  }
  double sigma_of(const Group& group) const {
    if (group.is_height()) return height(group).sigma.value_or(options_.noise.height);
    if (group.is_distance()) return sigma_of(distance(group));
    return std::sqrt(3.0) / whitening_of(point(group), point(group).point).norm();
  }

 private:
  /// Where the nuisance of a series begins; -1 where it has none of that kind.
  struct Nuisance {
    Eigen::Index frame = -1, zero = -1, second = -1;
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  ///< Q_0
  };

  std::shared_ptr<const std::vector<StationState>> evaluate(const Eigen::VectorXd& unknowns) const;
  void lay_out_nuisance();
  void lay_out_priors();
  void add_groups();
  void align(std::size_t series, const std::vector<StationState>& stations, Eigen::VectorXd& unknowns);
  void distance_rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                     Eigen::MatrixXd& block) const;
  void height_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                   Eigen::MatrixXd& block) const;
  void point_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                  Eigen::MatrixXd& block) const;
  StationState state_of(const Machine& machine, const PlateState& plate, const Joints& joints) const;
  Eigen::Matrix3d whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const;

  const Robot& robot_;
  const Measurements& measurements_;
  const CalibrationOptions& options_;
  std::vector<SoughtSource> sought_;
  SourceErrors held_;
  std::vector<Joints> joints_;
  std::vector<Group> groups_;
  std::vector<Nuisance> nuisance_;
  std::vector<Eigen::Index> planes_;  ///< where the nuisance of each plane begins
  Eigen::Index bias_ = -1;
  Eigen::MatrixXd common_prior_;  ///< W, W^T W the inverse prior covariance of the sought errors, where they share some
  std::vector<StationState> nominal_;
  Eigen::Index nuisance_count_ = 0;
  double noise_scale_ = 1.0;
  mutable Eigen::VectorXd last_unknowns_;
  mutable std::shared_ptr<const std::vector<StationState>> last_stations_;
};

/// Some sought error has a prior: the fit then determines everything, in silence by the prior.
inline bool has_priors(const Observation& observation) {
  return std::ranges::any_of(observation.sought(), [](const SoughtSource& one) { return one.prior_std.has_value(); });
}

/// Readings as rows, and what was known before as rows. `observation` must outlive the model.
RowModel with_priors(const Observation& observation);

}  // namespace paracal::detail

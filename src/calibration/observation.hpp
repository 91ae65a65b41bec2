#pragma once

// Private to calibration: readings as a function of what is not known.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
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

/// Rotation in {O} of what carries the second reflector.
Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount);

/// Singular values of column-scaled readings below this share of the largest count as zero.
inline constexpr double kRankTolerance = 1e-7;

/// How the plate moves: position (mm), phi (rad), tilt_x, tilt_y, tilt_z (rad), a column for each cause.
using PlateMotions = Eigen::Matrix<double, 7, Eigen::Dynamic>;

/// Where the machine stands at one station, and how that changes.
struct StationState {
  PlateState plate;
  double rotation = 0.0;  ///< phi, rad
  PlateMotions jacobian;  ///< by the sought sources
  PlateMotions by_joint;  ///< by the joint coordinates: how the plate moves when a joint stands elsewhere than believed
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
  bool stated = false;  ///< its standard deviation is known; its factor is that of stated noise
  bool active = true;   ///< takes part in the fit

  bool is_point() const { return kind == ReadingKind::point; }
  bool is_height() const { return kind == ReadingKind::height; }
  bool is_distance() const { return kind == ReadingKind::distance; }
};

/// How uncertain the readings are: what a fit finds of them besides its unknowns.
struct VarianceComponents {
  double unstated_noise = 1.0;  ///< factor of the standard deviations that no one stated
  double stated_noise = 1.0;    ///< factor of those that were stated
  /// Standard deviation of where each joint stands at each station from where the model has it, the same at every visit
  /// (backlash, friction, load, an encoder that is not round), rad or mm; 0: the model is right at every pose.
  double joint = 0.0;
};

/// The rows [H | J | r] of the active readings of one station whose joints may be off by dq ~ N(0, s^2): H by dq, J by
/// the unknowns. Seen without dq they have covariance V = I + s^2 H H^T, and
///
///   V^-1 = I - H P H^T,   P = (H^T H + I / s^2)^-1,   dq = -P H^T r.
struct StationRows {
  std::vector<std::size_t> groups;  ///< whose rows these are, in order
  std::vector<Eigen::Index> first;  ///< row of each
  Eigen::MatrixXd by_joint;         ///< H
  Eigen::MatrixXd rows;             ///< [J | r]
  Eigen::MatrixXd smoother;         ///< P H^T
  Eigen::MatrixXd spread;           ///< P
};

/// All readings as a function of the unknowns
///
///   (nuisance of every series: frame turn, frame shift, [encoder zero], [second reflector], [scale];
///    of every plane: z_0, s_x, s_y; [bias of the distances], [scale of the distances] | sought source errors)
///
/// with the exact machine behind it:
///
///   distance   (1 + scale) |r_to - r_from| + bias
///   height     z - (z_0 + s_x x + s_y y)
///   point      t + (1 + scale) Q r            r: exact plate centre; Q = exp([turn]) Q_0, Q_0 from a robust rigid fit
///   second     t + (1 + scale) Q (r + M rho)  M: rotation of the plate, or of the end-effector
///   rotation   phi - zero
class Observation {
 public:
  /// @param seeks_scale  the scale of the instruments is an unknown, where options give it a standard deviation.
  Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
              std::vector<SoughtSource> sought, bool seeks_scale = false);

  Eigen::Index nuisance_count() const { return nuisance_count_; }
  Eigen::Index unknown_count() const { return nuisance_count_ + source_count(); }
  Eigen::Index source_count() const { return static_cast<Eigen::Index>(sought_.size()); }
  const std::vector<SoughtSource>& sought() const { return sought_; }
  std::vector<Group>& groups() { return groups_; }
  const std::vector<Group>& groups() const { return groups_; }
  VarianceComponents& components() { return components_; }
  const VarianceComponents& components() const { return components_; }
  /// Multiplies the prior standard deviations of some of the sought errors.
  void widen_priors(const std::vector<std::size_t>& places, double factor);
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
  /// @param by_joint  where not null: H, the same by the joint coordinates of its station (of a distance: of `to`).
  void rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
            Eigen::MatrixXd& block, Eigen::MatrixXd* by_joint = nullptr) const;
  /// Points and heights of a station, together; of no rows where it has none in use. Only while joints may be off.
  StationRows station_rows(std::size_t station, const std::vector<StationState>& stations,
                           const Eigen::VectorXd& unknowns) const;
  /// Points and heights (by their places among the groups) that were read at a station.
  const std::vector<std::vector<std::uint32_t>>& groups_of_stations() const { return at_station_; }
  /// Adds the rows of all active readings, each station's whitened by V; false where the machine does not close.
  bool operator()(const Eigen::VectorXd& unknowns, InformationRoot& root) const;
  /// Calls look(place of the group, rows [J - H P H^T J_s | r - H P H^T r_s], own) for every reading, in use or not:
  /// the rows less what the other readings of its station say of the joints, s: those in use; own: its part of V^-1, or
  /// I + H P H^T when it is not in use. Without joint effects: [J | r] and I.
  void check_each(const Eigen::VectorXd& unknowns,
                  const std::function<void(std::size_t, const Eigen::MatrixXd&, const Eigen::MatrixXd&)>& look) const;
  /// log det V of all active readings, in units of the standard deviations before any factor.
  double log_determinant(const Eigen::VectorXd& unknowns) const;

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
  /// Readings of a series, or of the distances, are this much longer than the machine: 1 + scale.
  double series_scale(std::size_t series, const Eigen::VectorXd& unknowns) const;
  double distance_scale(const Eigen::VectorXd& unknowns) const;
  /// Places of the scales among the unknowns.
  std::vector<Eigen::Index> scale_columns() const;
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
  /// Standard deviation before any factor, mm: of a distance; of a coordinate, as a mean over the three.
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
    Eigen::Index frame = -1, zero = -1, second = -1, scale = -1;
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  ///< Q_0
  };

  std::shared_ptr<const std::vector<StationState>> evaluate(const Eigen::VectorXd& unknowns) const;
  void lay_out_nuisance();
  void lay_out_priors();
  void add_groups();
  void list_stations();
  void align(std::size_t series, const std::vector<StationState>& stations, Eigen::VectorXd& unknowns);
  /// A reading's rows by the plate's motion at its station: rows x 7.
  using ByPlate = Eigen::Matrix<double, Eigen::Dynamic, 7, 0, 7, 7>;
  /// Each sets the set-up's columns and the residual of `block` and returns the derivative by the plate's motion.
  ByPlate distance_rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                        Eigen::MatrixXd& block) const;
  ByPlate height_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                      Eigen::MatrixXd& block) const;
  ByPlate point_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                     Eigen::MatrixXd& block) const;
  ByPlate setup_rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                     Eigen::MatrixXd& block) const;
  /// Variances of a distance's rows when the joints of both its stations may be off, over those when they are not.
  Eigen::VectorXd widening(const DistanceReading& reading, const std::vector<StationState>& stations,
                           const ByPlate& by_plate) const;
  void check_station(
      std::size_t station, const std::vector<StationState>& states, const Eigen::VectorXd& unknowns,
      const std::function<void(std::size_t, const Eigen::MatrixXd&, const Eigen::MatrixXd&)>& look) const;
  StationState state_of(const Machine& machine, const PlateState& plate, const Joints& joints) const;
  Eigen::Matrix3d whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const;

  const Robot& robot_;
  const Measurements& measurements_;
  const CalibrationOptions& options_;
  bool seeks_scale_;
  std::vector<SoughtSource> sought_;
  Eigen::VectorXd prior_factor_;  ///< by which priors were widened
  SourceErrors held_;
  std::vector<Joints> joints_;
  std::vector<Group> groups_;
  std::vector<Nuisance> nuisance_;
  std::vector<Eigen::Index> planes_;  ///< where the nuisance of each plane begins
  Eigen::Index bias_ = -1, distance_scale_ = -1;
  std::vector<std::vector<std::uint32_t>> at_station_;
  Eigen::MatrixXd common_prior_;  ///< W, W^T W the inverse prior covariance of the sought errors, where they share some
  std::vector<StationState> nominal_;
  Eigen::Index nuisance_count_ = 0;
  VarianceComponents components_;
  mutable Eigen::VectorXd last_unknowns_;
  mutable std::shared_ptr<const std::vector<StationState>> last_stations_;
};

/// Rotation of what carries the second reflector.
Eigen::Matrix3d carrier(const StationState& station, ReflectorMount mount);

/// Some sought error has a prior: the fit then determines everything, in silence by the prior.
inline bool has_priors(const Observation& observation) {
  return std::ranges::any_of(observation.sought(), [](const SoughtSource& one) { return one.prior_std.has_value(); });
}

/// Every reading states its standard deviation.
inline bool all_stated(const Observation& observation) {
  return std::ranges::all_of(observation.groups(), &Group::stated);
}

/// Root mean square of the standard deviations with which the readings in use entered, mm: of a coordinate; of a
/// distance where no points were read, of a height where neither.
double reading_noise(const Observation& observation);

/// Readings as rows, and what was known before as rows. `observation` must outlive the model.
RowModel with_priors(const Observation& observation);

}  // namespace paracal::detail

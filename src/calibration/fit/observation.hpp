#pragma once

// Private to calibration: readings as a function of what is not known.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calibration/readings/series.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/numerics/information_root.hpp"
#include "paracal/numerics/least_squares.hpp"

namespace paracal::detail {

/// Singular values of column-scaled readings below this share of the largest count as zero.
inline constexpr double kRankTolerance = 1e-7;

/// How uncertain the readings of a series are, as factors of the standard deviations with which they enter.
struct SeriesNoise {
  double stated = 1.0;       ///< of those that were stated
  double unstated = 1.0;     ///< of those that no one stated
  double orientation = 1.0;  ///< of unstated orientations, over that of the positions beside them

  bool operator==(const SeriesNoise&) const = default;
};
using NoiseOfSeries = std::vector<SeriesNoise>;

inline double largest_unstated(const NoiseOfSeries& noise) {
  return std::ranges::max(noise, {}, &SeriesNoise::unstated).unstated;
}

/// All readings as a function of the unknowns
///
///   (set-up of every series of readings | sought source errors)
///
/// with the exact machine behind it. What each kind reads, and what of its set-up is sought: readings/.
class Observation {
 public:
  /// @param seeks_scale  the scale of the instruments is an unknown, where options give it a standard deviation.
  Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
              std::vector<SoughtSource> sought, bool seeks_scale = false);

  const Robot& robot() const { return robot_; }
  Eigen::Index nuisance_count() const { return nuisance_count_; }
  Eigen::Index unknown_count() const { return nuisance_count_ + source_count(); }
  Eigen::Index source_count() const { return static_cast<Eigen::Index>(sought_.size()); }
  const std::vector<SoughtSource>& sought() const { return sought_; }
  /// As commanded, at every station.
  const std::vector<Joints>& joints() const { return joints_; }
  std::vector<Group>& groups() { return groups_; }
  const std::vector<Group>& groups() const { return groups_; }
  NoiseOfSeries& noise() { return noise_; }
  const NoiseOfSeries& noise() const { return noise_; }
  /// Of the noisiest series.
  double unstated_noise() const { return largest_unstated(noise_); }
  /// Of all series, stated or not.
  void let_noise_be(double factor) {
    for (SeriesNoise& one : noise_) one.stated = one.unstated = factor;
  }
  /// Makes the prior standard deviations of the sought errors as many times as large as they were given.
  void widen_priors(const Eigen::VectorXd& factors);
  /// paracal::detail::prior_covariance() of the sought errors.
  Eigen::MatrixXd prior_covariance() const;
  /// W, W^T W the inverse of it: nothing of errors without a prior.
  Eigen::MatrixXd prior_root() const;
  /// Derivatives at the nominal machine whatever the unknowns: the paper's chord method.
  void keep_nominal_derivative();

  /// Standard deviation of where each joint stands at each station from where the model has it, the same at every
  /// visit, rad or mm; no entries: the model is right at every pose.
  void let_joints_err(Eigen::VectorXd std) { joint_std_ = std::move(std); }
  const Eigen::VectorXd& joint_std() const { return joint_std_; }

  /// Corrects what was read: a reading is less by these rows, which are as rows() has them now.
  void take_off(std::size_t group, const Eigen::VectorXd& rows);
  /// Corrects all readings as those of another observation of them.
  void take_off_as(const Observation& other) { taken_off_ = other.taken_off_; }

  /// Unknowns with these source errors, and the nuisance that then fits best; empty when the machine does not close.
  std::optional<Eigen::VectorXd> start(const SourceErrors& errors);
  /// The source errors of a vector of unknowns; those not sought as at start().
  SourceErrors errors(const Eigen::VectorXd& unknowns) const;
  /// The machine at every station; empty when it does not close at one of them. The last answer is kept: what a fit
  /// settles at is asked for again and again.
  std::shared_ptr<const std::vector<StationState>> stations(const Eigen::VectorXd& unknowns) const;

  /// Those kept with the station, else taken into `fresh`.
  const StationMotions& motions_of(std::size_t station, const StationState& state, StationMotions& fresh) const;

  /// Rows [J | r] of one reading, r = predicted - measured, divided by the standard deviations. `block` is resized.
  /// @param by_joint  where not null: H, the same by the joint coordinates of the station where it was taken; of a
  /// relative reading then by those of the station that it is relative to.
  void rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
            Eigen::MatrixXd& block, Eigen::MatrixXd* by_joint = nullptr) const;
  /// Rows of one reading by the plate's position at its station, less that at what it is relative to, divided by the
  /// standard deviations.
  Eigen::MatrixXd by_position(const Group& group, const Placed& at) const;
  /// Readings (by their places among the groups) at a station that are not relative to another.
  const std::vector<std::vector<std::uint32_t>>& groups_of_stations() const { return at_station_; }
  /// Adds the rows of all active readings; false where the machine does not close. Where joints may be off by dq ~ N(0,
  /// S^2), those of each station together, whitened by V = I + H S^2 H^T.
  bool operator()(const Eigen::VectorXd& unknowns, InformationRoot& root) const;
  /// Of the active readings, where the machine closes.
  InformationRoot information(const Eigen::VectorXd& unknowns) const {
    InformationRoot root(unknown_count());
    (void)(*this)(unknowns, root);
    return root;
  }
  /// Calls look(place of the group, rows [J | r]) for every reading, in use or not.
  void check_each(const Eigen::VectorXd& unknowns,
                  const std::function<void(std::size_t, const Eigen::MatrixXd&)>& look) const;
  /// Variances of a reading's rows when the joints may be off by these standard deviations, in units of its own noise.
  Eigen::VectorXd widening(const Group& group, const Placed& at, const Eigen::VectorXd& joint_std) const;

  /// Reflectors are taken to be at the plate's centre.
  bool has_centred_reflectors() const { return options_.reflector_is_at_centre; }
  /// Places of the scales of instruments among the unknowns.
  std::vector<Eigen::Index> scale_columns() const;
  /// Adds what is known beforehand, as rows: of the sought errors, one by one and together, and of the set-up.
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const;
  /// The same of the set-up alone: slopes, the bias, scales, the place of a body.
  void add_set_up_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const;
  const std::vector<std::shared_ptr<const ReadingSeries>>& series() const { return series_; }
  const ReadingSeries& series_of(const Group& group) const { return *series_[group.series]; }
  /// The readings of a series.
  std::span<const Group> groups_of(std::size_t series) const {
    return std::span(groups_).subspan(first_group_[series], series_[series]->size());
  }
  Residual residual(const Group& group, const Placed& at) const { return series_of(group).residual(group.index, at); }
  /// Standard deviation before any factor, mm: of a distance or height; of a coordinate, as a mean over the three.
  double sigma_of(const Group& group) const { return series_of(group).sigma(group.index); }
  Eigen::Index orientation_rows(const Group& group) const { return series_of(group).orientation_rows(group.index); }
  /// Factors of the standard deviations of a reading's rows.
  double noise_factor(const Group& group) const { return noise_factor(group, noise_); }
  static double noise_factor(const Group& group, const NoiseOfSeries& noise) {
    return group.stated ? noise[group.series].stated : noise[group.series].unstated;
  }
  double orientation_factor(const Group& group) const {
    return group.stated || orientation_rows(group) == 0 ? 1.0 : noise_[group.series].orientation;
  }

 private:
  std::shared_ptr<const std::vector<StationState>> evaluate(const Eigen::VectorXd& unknowns) const;
  void lay_out_priors();
  void add_groups();
  void list_stations();
  /// Of the set-up and the residual, divided by the standard deviations. @returns the same by the plate's motion.
  ByPlate scaled_rows(const Group& group, const Placed& at, Eigen::MatrixXd& block) const;
  /// Variances of a reading's rows when the joints may be off, over those when they are not.
  Eigen::VectorXd widening(const Group& group, const std::vector<StationState>& stations, const ByPlate& by_plate,
                           const Eigen::VectorXd& joint_std) const;
  /// Rows by the joints of a station.
  Eigen::MatrixXd by_joints(const Group& group, const ByPlate& by_plate, const StationMotions& motions) const;
  /// Rows [J | r] of the active readings of one station that are not relative to another, whitened by V; none where it
  /// has none in use.
  Eigen::MatrixXd whitened_rows(std::size_t station, const std::vector<StationState>& stations,
                                const Eigen::VectorXd& unknowns) const;
  StationState state_of(const DifferentiableMachine& machine, const PlateState& plate, std::size_t station) const;
  /// @returns motions of no columns where the machine is singular.
  StationMotions motions_at(const StationState& state, std::size_t station) const;
  void add_joint_readings();
  ForwardOptions start_of(std::size_t station) const { return starts_.empty() ? ForwardOptions{} : starts_[station]; }

  const Robot& robot_;
  const CalibrationOptions& options_;
  std::vector<SoughtSource> sought_;
  Eigen::VectorXd prior_std_;     ///< as given, 0 where there is none
  Eigen::VectorXd prior_factor_;  ///< by which they were widened
  /// What is sought, then the offset of every joint, which moves the plate as the joint does.
  std::vector<SoughtSource> moving_;
  SourceErrors held_;
  std::vector<Joints> joints_;
  std::vector<Eigen::MatrixXd> gap_bases_;  ///< of the gaps of the joints at each station, where these are readings
  std::vector<ForwardOptions> starts_;      ///< from where the plate is sought; empty: anywhere
  /// Derivatives stay with the stations. They are 3 kB where 56 errors are sought, 300 MB of a hundred thousand
  /// stations; taking them again costs less than folding the rows that they go into.
  bool keeps_motions_ = true;
  std::vector<std::shared_ptr<const ReadingSeries>> series_;  ///< shared with copies until one of them starts anew
  std::vector<Group> groups_;                                 ///< series by series
  std::vector<std::size_t> first_group_;                      ///< of each series
  std::vector<std::vector<std::uint32_t>> at_station_;
  Eigen::MatrixXd common_prior_;  ///< W, W^T W the inverse prior covariance of the sought errors, where they share some
  std::vector<StationState> nominal_;
  Eigen::VectorXd joint_std_;  ///< empty: none
  /// Of each reading, before any factor of its standard deviation; empty: none.
  std::vector<Eigen::VectorXd> taken_off_;
  Eigen::Index nuisance_count_ = 0;
  NoiseOfSeries noise_;
  mutable Eigen::VectorXd last_sources_;
  mutable std::shared_ptr<const std::vector<StationState>> last_stations_;
};

/// Some sought error has a prior: the fit then determines everything, in silence by the prior.
inline bool has_priors(const Observation& observation) {
  return std::ranges::any_of(observation.sought(), [](const SoughtSource& one) { return one.prior_std.has_value(); });
}

/// Every reading states its standard deviation.
inline bool all_stated(const Observation& observation) {
  return std::ranges::all_of(observation.groups(), &Group::stated);
}

/// Some reading has an orientation whose noise nobody stated.
inline bool seeks_orientation_noise(const Observation& observation) {
  return std::ranges::any_of(observation.groups(), [&](const Group& group) {
    return !group.stated && observation.orientation_rows(group) > 0;
  });
}

/// Root mean square of the standard deviations with which the readings in use entered, mm: of a coordinate; of a
/// distance where no points were read, of a height where neither.
double reading_noise(const Observation& observation);
/// The same if the noise were this.
double reading_noise(const Observation& observation, const NoiseOfSeries& noise);
/// The same of orientations about each axis, rad; empty where none were read.
std::optional<double> orientation_noise(const Observation& observation);

/// Readings as rows, and what was known before as rows. `observation` must outlive the model.
RowModel with_priors(const Observation& observation);

}  // namespace paracal::detail

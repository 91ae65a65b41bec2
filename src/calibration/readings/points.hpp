#pragma once

// Private to calibration: points that an instrument read in a frame of its own.

#include "paracal/calibration/rigid_fit.hpp"
#include "series.hpp"

namespace paracal::detail {

/// Rotation in {O} of what carries the second reflector.
Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount);

///   point      t + (1 + scale) Q r            r: exact plate centre; Q = exp([turn]) Q_0, Q_0 from a robust rigid fit
///   second     t + (1 + scale) Q (r + M rho)  M: rotation of the plate, or of the end-effector
///   rotation   phi - zero
///
/// with the frame (turn, t), the zero of the encoder, the second reflector rho and the scale sought as far as options
/// leave them open: 3 to 7 rows.
class Points final : public ReadingSeries {
 public:
  Points(const PointSeries& series, const CalibrationOptions& options);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<Points>(*this); }
  std::size_t size() const override { return readings_.size(); }
  Group group(std::size_t index) const override;
  double sigma(std::size_t index) const override;
  Quantity quantity() const override { return Quantity::coordinate; }
  void take_columns(Eigen::Index& next, bool seeks_scale) override;
  void start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) override;
  void add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const override;
  void set_units(Eigen::VectorXd& unit) const override;
  ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const override;
  /// In the robot's frame.
  Residual residual(std::size_t index, const Placed& at) const override;
  std::string label(std::size_t index, const std::vector<Station>& stations) const override;
  std::string explanation(std::size_t index, const Placed& at, const std::vector<Station>& stations) const override;
  bool shows_gross_at_start() const override { return true; }
  void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const override;
  void list(const Group& group, const std::vector<Station>& stations, const Residual& before, const Residual& after,
            Calibration& calibration) const override;
  void state_setup(const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& covariance,
                   Calibration& calibration) const override;
  /// instrument = frame(robot)
  RigidMotion frame(const Eigen::VectorXd& unknowns) const;
  /// Measured points in the robot's frame beside the machine's poses, one pair a station, repeats averaged, home (or
  /// the first station read) first. Readings left out do not count.
  std::vector<PosePair> station_pairs(std::span<const Group> of_series, const Placed& at) const;

 private:
  std::optional<double> rotation_zero(const Eigen::VectorXd& unknowns) const;
  std::optional<Eigen::Vector3d> second_reflector(const Eigen::VectorXd& unknowns) const;
  Eigen::Matrix3d carrier(const StationState& station) const;
  Eigen::Matrix3d whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const;
  /// Three rows: a reflector that stands at x in the robot's frame.
  /// @returns their derivative by x.
  Eigen::Matrix3d reflector_rows(Eigen::Index row, const Eigen::Vector3d& x, const Eigen::Vector3d& read,
                                 const PointReading& reading, const Eigen::VectorXd& unknowns,
                                 Eigen::MatrixXd& block) const;
  /// Of a point if it had been taken at this station, mm.
  Eigen::Vector3d off(const PointReading& reading, const StationState& station, const Eigen::VectorXd& unknowns) const;
  double rotation_off(const PointReading& reading, const StationState& station, const Eigen::VectorXd& unknowns) const;

  const std::vector<PointReading>& readings_;
  const CalibrationOptions& options_;
  Eigen::Index frame_ = -1, zero_ = -1, second_ = -1;     ///< columns; -1 where none is sought
  Eigen::Matrix3d turned_ = Eigen::Matrix3d::Identity();  ///< Q_0
};

}  // namespace paracal::detail

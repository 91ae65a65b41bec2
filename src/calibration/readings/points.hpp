#pragma once

// Private to calibration: points, and poses of a body, that an instrument read in a frame of its own.

#include "body.hpp"
#include "paracal/numerics/rigid_fit.hpp"
#include "series.hpp"

namespace paracal::detail {

/// Rotation in {O} of what carries the second reflector or a body.
Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount);

///   point      t + (1 + scale) Q r            r: exact plate centre; Q = exp([turn]) Q_0, Q_0 from a robust rigid fit
///              t + (1 + scale) Q (r + M b)    where the reflector may be anywhere on its mount
///   second     t + (1 + scale) Q (r + M rho)  M: rotation of the plate, or of the end-effector
///   rotation   phi - zero
///
/// or, of a body that sits at (B, b) on the same mount,
///
///   point        t + (1 + scale) Q (r + M b)
///   orientation  Q M B                          weighted by the angles of exp([off]) = M B R^T Q, R as read
///
/// with the frame (turn, t), the zero of the encoder, the second reflector rho, the body and the scale sought as far as
/// options leave them open: 3 to 7 rows. Only a plate that turns shows b; else the frame takes it up, and its prior
/// keeps it within reach of the plate.
class Points final : public ReadingSeries {
 public:
  Points(const PointSeries& series, const CalibrationOptions& options);

  std::unique_ptr<ReadingSeries> copy() const override { return std::make_unique<Points>(*this); }
  std::size_t size() const override { return readings_.size(); }
  Group group(std::size_t index) const override;
  double sigma(std::size_t index) const override;
  double orientation_sigma(std::size_t index) const override;
  Quantity quantity() const override { return Quantity::coordinate; }
  void take_columns(Eigen::Index& next, bool seeks_scale) override;
  void start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) override;
  std::vector<Eigen::Index> zero_columns() const override;
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
            FitResiduals& all) const override;
  void add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& remarks) const override;
  Eigen::Index orientation_rows(std::size_t index) const override { return readings_[index].orientation ? 3 : 0; }
  Eigen::Index rotation_rows(std::size_t index) const override { return readings_[index].rotation ? 1 : 0; }
  /// instrument = frame(robot)
  RigidMotion frame(const Eigen::VectorXd& unknowns) const;
  /// Measured points in the robot's frame beside the machine's poses, one pair a station, repeats averaged, home (or
  /// the first station read) first. Readings left out do not count.
  std::vector<PosePair> station_pairs(std::span<const Group> of_series, const Placed& at) const;

 private:
  static constexpr double kBodyReach = 100.0;  ///< mm an axis: as far from the plate centre a body is put

  /// carrier = body(body); as it is where none was read.
  RigidMotion body(const Eigen::VectorXd& unknowns) const;
  /// phi is read, by an encoder or by a body that turns with it.
  bool shows_rotation() const;
  /// Mean rotation of the mount over the readings.
  Eigen::Matrix3d middle_carrier(const std::vector<StationState>& stations) const;
  /// Whether carriers turn so much, about all axes, that readings show where the body sits on them.
  bool shows_place(const std::vector<StationState>& stations) const;
  RigidMotion started_frame(const std::vector<StationState>& stations) const;
  BodySetUp started_body(const std::vector<StationState>& stations) const;
  BodySetUp started_reflector(const std::vector<StationState>& stations) const;
  std::optional<double> rotation_zero(const Eigen::VectorXd& unknowns) const;
  std::optional<Eigen::Vector3d> second_reflector(const Eigen::VectorXd& unknowns) const;
  Eigen::Matrix3d carrier(const StationState& station) const;
  Eigen::Matrix3d whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const;
  /// Three rows: a reflector that stands at x in the robot's frame.
  /// @returns their derivative by x.
  Eigen::Matrix3d reflector_rows(Eigen::Index row, const Eigen::Vector3d& x, const Eigen::Vector3d& read,
                                 const PointReading& reading, const Eigen::VectorXd& unknowns,
                                 Eigen::MatrixXd& block) const;
  /// Three rows each: of what the mount carries, at the place that the columns from `lever` on hold; and of a body's
  /// orientation.
  void carried_rows(Eigen::Index row, Eigen::Index lever, const Eigen::Vector3d& read, const PointReading& reading,
                    const Placed& at, Eigen::MatrixXd& block, ByPlate& by_plate) const;
  void orientation_rows(Eigen::Index row, std::size_t index, const Placed& at, Eigen::MatrixXd& block,
                        ByPlate& by_plate) const;
  /// Of a point if it had been taken at this station, mm.
  Eigen::Vector3d off(const PointReading& reading, const StationState& station, const Eigen::VectorXd& unknowns) const;
  /// The turn from the orientation read to that predicted, in the robot's frame, rad.
  Eigen::Vector3d orientation_off(const PointReading& reading, const StationState& station,
                                  const Eigen::VectorXd& unknowns) const;
  double rotation_off(const PointReading& reading, const StationState& station, const Eigen::VectorXd& unknowns) const;

  const PointSeries& series_;
  const std::vector<PointReading>& readings_;
  const CalibrationOptions& options_;
  Eigen::Index frame_ = -1, zero_ = -1, second_ = -1;     ///< columns; -1 where none is sought
  Eigen::Index body_ = -1, place_ = -1;                   ///< turn of a body; where it or the reflector is on the mount
  Eigen::Matrix3d turned_ = Eigen::Matrix3d::Identity();  ///< Q_0
  Eigen::Matrix3d body_turned_ = Eigen::Matrix3d::Identity();  ///< B_0
  /// With a place the frame's columns hold t + (1 + scale) Q middle b: those of b then show what the plate's turns
  /// show.
  Eigen::Matrix3d middle_ = Eigen::Matrix3d::Zero();
  bool place_is_shown_ = false;  ///< else it has to be guessed
};

}  // namespace paracal::detail

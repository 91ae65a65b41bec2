#include "points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "body.hpp"
#include "kinematics/turns.hpp"
#include "numerics/dense.hpp"
#include "numerics/median.hpp"
#include "numerics/small.hpp"

namespace paracal::detail {
namespace {

constexpr Eigen::Index kFrame = 6;

}  // namespace

Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount) {
  return plate_rotation(plate.tilt).matrix * Eigen::AngleAxisd(turns_per_phi(mount) * phi, Eigen::Vector3d::UnitZ());
}

Points::Points(const PointSeries& series, const CalibrationOptions& options)
    : ReadingSeries(series.name), series_(series), readings_(series.readings), options_(options) {}

Group Points::group(std::size_t index) const {
  const PointReading& reading = readings_[index];
  const bool states_turn = !reading.orientation || reading.orientation_sigma;
  return {.station = static_cast<std::uint32_t>(reading.station),
          .stated = states_turn && (reading.sigma.has_value() || options_.noise.tracker.has_value())};
}

double Points::sigma(std::size_t index) const {
  const PointReading& reading = readings_[index];
  return std::sqrt(3.0) / whitening_of(reading, reading.point).norm();
}

double Points::orientation_sigma(std::size_t index) const {
  const PointReading& reading = readings_[index];
  return reading.orientation ? reading.orientation_sigma.value_or(options_.noise.rotation) : 0.0;
}

void Points::take_columns(Eigen::Index& next, bool seeks_scale) {
  if (options_.frame == Frame::unknown) frame_ = take(next, kFrame);
  const bool turns = std::ranges::any_of(readings_, [](const auto& r) { return r.rotation.has_value(); });
  if (turns && options_.rotation_zero == RotationZero::unknown) zero_ = take(next, 1);
  if (std::ranges::any_of(readings_, [](const auto& r) { return r.second.has_value(); })) second_ = take(next, 3);
  if (series_.is_of_body() && options_.body == BodyPlace::unknown) {
    body_ = take(next, kFrame);
    place_ = body_ + 3;
  }
  if (!series_.is_of_body() && !options_.reflector_is_at_centre) place_ = take(next, 3);
  if (seeks_scale) scale_ = take(next, 1);
}

void Points::start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) {
  const BodySetUp found = place_ < 0  ? BodySetUp{started_frame(stations), {}}
                          : body_ < 0 ? started_reflector(stations)
                                      : started_body(stations);
  if (frame_ >= 0) {
    turned_ = found.frame.rotation;
    unknowns.segment<3>(frame_).setZero();
    unknowns.segment<3>(frame_ + 3) = found.frame.translation;
  }
  if (body_ >= 0) {
    body_turned_ = found.body.rotation;
    unknowns.segment<3>(body_).setZero();
  }
  if (place_ >= 0) {
    unknowns.segment<3>(place_) = found.body.translation;
    place_is_shown_ = shows_place(stations);
  }
  if (place_ >= 0 && frame_ >= 0) {
    middle_ = middle_carrier(stations);
    unknowns.segment<3>(frame_ + 3) += turned_ * middle_ * found.body.translation;
  }
  std::vector<Eigen::Vector3d> seconds;
  std::vector<double> zeros;
  for (const PointReading& reading : readings_) {
    const StationState& station = stations[reading.station];
    if (reading.rotation) zeros.push_back(station.rotation - *reading.rotation);
    if (reading.second) {
      seconds.emplace_back(carrier(station).transpose() * turned_.transpose() * (*reading.second - reading.point));
    }
  }
  if (zero_ >= 0) unknowns(zero_) = median(zeros);
  if (second_ >= 0) unknowns.segment<3>(second_) = median(seconds);
}

Eigen::Matrix3d Points::middle_carrier(const std::vector<StationState>& stations) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PointReading& reading : readings_) sum += carrier(stations[reading.station]);
  return sum / static_cast<double>(readings_.size());
}

bool Points::shows_place(const std::vector<StationState>& stations) const {
  constexpr double kTurned = 0.02;  // rad, as a mean about the axis about which carriers turn least
  const Eigen::Matrix3d middle = middle_carrier(stations);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const PointReading& reading : readings_) {
    const Eigen::Matrix3d turned = carrier(stations[reading.station]) - middle;
    squares += turned.transpose() * turned / static_cast<double>(readings_.size());
  }
  return symmetric_eigenvalues(squares).minCoeff() > kTurned * kTurned;
}

RigidMotion Points::started_frame(const std::vector<StationState>& stations) const {
  if (frame_ < 0) return {};
  std::vector<Eigen::Vector3d> predicted, measured;
  for (const PointReading& reading : readings_) {
    predicted.push_back(stations[reading.station].plate.position);
    measured.push_back(reading.point);
  }
  return robust_rigid_fit(predicted, measured);
}

BodySetUp Points::started_body(const std::vector<StationState>& stations) const {
  std::vector<RigidMotion> carriers, read;
  for (const PointReading& reading : readings_) {
    const StationState& station = stations[reading.station];
    carriers.push_back({carrier(station), station.plate.position});
    read.push_back({reading.orientation->normalized().toRotationMatrix(), reading.point});
  }
  return place_body(carriers, read, frame_ >= 0);
}

BodySetUp Points::started_reflector(const std::vector<StationState>& stations) const {
  std::vector<RigidMotion> carriers;
  std::vector<Eigen::Vector3d> read;
  for (const PointReading& reading : readings_) {
    const StationState& station = stations[reading.station];
    carriers.push_back({carrier(station), station.plate.position});
    read.push_back(reading.point);
  }
  return place_reflector(carriers, read, frame_ >= 0);
}

std::vector<Eigen::Index> Points::zero_columns() const {
  if (frame_ < 0) return {};
  return {frame_ + 3, frame_ + 4, frame_ + 5};
}

void Points::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (scale_ >= 0) root.add_prior(scale_, unknowns(scale_), 0.0, options_.scale_std);
  const bool guessed = place_ >= 0 && !place_is_shown_;
  for (Eigen::Index k = place_; guessed && k < place_ + 3; ++k) {
    root.add_prior(k, unknowns(k), 0.0, kBodyReach);
  }
}

void Points::set_units(Eigen::VectorXd& unit) const {
  constexpr double kTurn = 0.005;  // of the frame and of a body
  if (frame_ >= 0) unit.segment<3>(frame_).setConstant(kTurn);
  if (body_ >= 0) unit.segment<3>(body_).setConstant(kTurn);
  if (place_ >= 0) unit.segment<3>(place_).setConstant(kBodyReach);
}

Eigen::Matrix3d Points::reflector_rows(Eigen::Index row, const Eigen::Vector3d& x, const Eigen::Vector3d& read,
                                       const PointReading& reading, const Eigen::VectorXd& unknowns,
                                       Eigen::MatrixXd& block) const {
  RigidMotion motion = frame(unknowns);
  if (frame_ >= 0) motion.translation = unknowns.segment<3>(frame_ + 3);
  const Eigen::Matrix3d whiten = whitening_of(reading, read);
  const Eigen::Vector3d turned = motion.rotation * x;
  const double longer = scale(unknowns);
  block.block<3, 1>(row, unknowns.size()) = whiten * (longer * turned + motion.translation - read);
  if (scale_ >= 0) block.block<3, 1>(row, scale_) = whiten * turned;
  if (frame_ >= 0) {
    // exp([w + dw]) v = exp([w]) v - [exp([w]) v] J_l(w) dw
    block.block<3, 3>(row, frame_) = -longer * whiten * cross(turned) * left_jacobian(unknowns.segment<3>(frame_));
    block.block<3, 3>(row, frame_ + 3) = whiten;
  }
  return longer * whiten * motion.rotation;
}

void Points::carried_rows(Eigen::Index row, Eigen::Index lever, const Eigen::Vector3d& read,
                          const PointReading& reading, const Placed& at, Eigen::MatrixXd& block,
                          ByPlate& by_plate) const {
  const StationState& station = at.stations[reading.station];
  const Eigen::Matrix3d carried = carrier(station);
  const Eigen::Vector3d found = at.unknowns.segment<3>(lever), arm = carried * found;
  const Eigen::Vector3d& r = station.plate.position;
  const Eigen::Matrix3d moves = reflector_rows(row, r + arm - middle_ * found, read, reading, at.unknowns, block);
  const PlateRotation<double> plate = plate_rotation(station.plate.tilt);
  by_plate.block<3, 3>(row, 0) = moves;
  by_plate.block<3, 3>(row, 4) = -moves * cross(arm) * plate.axes;
  by_plate.block<3, 1>(row, 3) = turns_per_phi(options_.reflectors) * (moves * plate.matrix.col(2).cross(arm));
  block.block<3, 3>(row, lever) = moves * (carried - middle_);
}

void Points::orientation_rows(Eigen::Index row, std::size_t index, const Placed& at, Eigen::MatrixXd& block,
                              ByPlate& by_plate) const {
  const PointReading& reading = readings_[index];
  const StationState& station = at.stations[reading.station];
  const double sigma = orientation_sigma(index);
  // In the body's frame, R^T F C B = exp([off]), which motions of all of the robot and those of the plate that its body
  // goes along with leave as it is: what no reading shows is no row. A turn d of the carrier makes it exp([off])
  // exp([(C B)^T d]), and log(exp([off]) exp([d])) = off + J(-off)^-1 d.
  const Eigen::Matrix3d stands = carrier(station) * body(at.unknowns).rotation;
  const Eigen::Vector3d off = stands.transpose() * orientation_off(reading, station, at.unknowns);
  const Eigen::Matrix3d moves = inverse_left_jacobian(-off) / sigma * stands.transpose();
  const PlateRotation<double> plate = plate_rotation(station.plate.tilt);
  by_plate.block<3, 3>(row, 4) = moves * plate.axes;
  by_plate.block<3, 1>(row, 3) = turns_per_phi(options_.reflectors) * (moves * plate.matrix.col(2));
  if (body_ >= 0) {
    block.block<3, 3>(row, body_) = moves * carrier(station) * left_jacobian(at.unknowns.segment<3>(body_));
  }
  block.block<3, 1>(row, at.unknowns.size()) = off / sigma;
  if (frame_ < 0) return;
  block.block<3, 3>(row, frame_) =
      moves * frame(at.unknowns).rotation.transpose() * left_jacobian(at.unknowns.segment<3>(frame_));
}

ByPlate Points::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const PointReading& reading = readings_[index];
  const StationState& station = at.stations[reading.station];
  const bool more = reading.second || reading.orientation;
  const Eigen::Index rotation = more ? 6 : 3;
  block.setZero(rotation + (reading.rotation ? 1 : 0), at.unknowns.size() + 1);
  ByPlate by_plate = ByPlate::Zero(block.rows(), 7);
  if (place_ >= 0) {
    carried_rows(0, place_, reading.point, reading, at, block, by_plate);
  } else {
    by_plate.block<3, 3>(0, 0) = reflector_rows(0, station.plate.position, reading.point, reading, at.unknowns, block);
  }
  if (reading.orientation) orientation_rows(3, index, at, block, by_plate);
  if (reading.second) carried_rows(3, second_, *reading.second, reading, at, block, by_plate);
  if (!reading.rotation) return by_plate;
  const double sigma = options_.noise.rotation;
  by_plate(rotation, 3) = 1.0 / sigma;
  if (zero_ >= 0) block(rotation, zero_) = -1.0 / sigma;
  block(rotation, at.unknowns.size()) = rotation_off(reading, station, at.unknowns) / sigma;
  return by_plate;
}

Residual Points::residual(std::size_t index, const Placed& at) const {
  const PointReading& reading = readings_[index];
  const StationState& station = at.stations[reading.station];
  Residual residual{off(reading, station, at.unknowns)};
  if (reading.orientation) residual.orientation = orientation_off(reading, station, at.unknowns);
  if (reading.rotation) residual.rotation = rotation_off(reading, station, at.unknowns);
  const double turns = turns_per_phi(options_.reflectors);
  if (residual.orientation && !residual.rotation && turns != 0.0) {
    residual.rotation = turns * plate_rotation(station.plate.tilt).matrix.col(2).dot(*residual.orientation);
  }
  return residual;
}

bool Points::shows_rotation() const {
  const bool turns = series_.is_of_body() && turns_per_phi(options_.reflectors) != 0.0;
  return turns || std::ranges::any_of(readings_, [](const auto& reading) { return reading.rotation.has_value(); });
}

Eigen::Vector3d Points::orientation_off(const PointReading& reading, const StationState& station,
                                        const Eigen::VectorXd& unknowns) const {
  const Eigen::Matrix3d read = reading.orientation->normalized().toRotationMatrix();
  return turn_of(carrier(station) * body(unknowns).rotation * read.transpose() * frame(unknowns).rotation);
}

double Points::rotation_off(const PointReading& reading, const StationState& station,
                            const Eigen::VectorXd& unknowns) const {
  return station.rotation - rotation_zero(unknowns).value_or(0.0) - *reading.rotation;
}

Eigen::Vector3d Points::off(const PointReading& reading, const StationState& station,
                            const Eigen::VectorXd& unknowns) const {
  Eigen::Vector3d stands = station.plate.position;
  if (place_ >= 0) stands += carrier(station) * unknowns.segment<3>(place_);
  return stands - frame(unknowns).inverse()(reading.point) / scale(unknowns);
}

RigidMotion Points::frame(const Eigen::VectorXd& unknowns) const {
  if (frame_ < 0) return {};
  RigidMotion frame{turn_by(unknowns.segment<3>(frame_)) * turned_, unknowns.segment<3>(frame_ + 3)};
  if (place_ >= 0) {
    frame.translation -= scale(unknowns) * (frame.rotation * (middle_ * unknowns.segment<3>(place_)));
  }
  return frame;
}

RigidMotion Points::body(const Eigen::VectorXd& unknowns) const {
  if (body_ < 0) return {};
  return {turn_by(unknowns.segment<3>(body_)) * body_turned_, unknowns.segment<3>(place_)};
}

std::optional<double> Points::rotation_zero(const Eigen::VectorXd& unknowns) const {
  return zero_ < 0 ? std::nullopt : std::optional(unknowns(zero_));
}

std::optional<Eigen::Vector3d> Points::second_reflector(const Eigen::VectorXd& unknowns) const {
  if (second_ < 0) return std::nullopt;
  return Eigen::Vector3d(unknowns.segment<3>(second_));
}

Eigen::Matrix3d Points::carrier(const StationState& station) const {
  return mount_rotation(station.plate, station.rotation, options_.reflectors);
}

Eigen::Matrix3d Points::whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const {
  if (reading.sigma) return Eigen::Matrix3d::Identity() / *reading.sigma;
  if (options_.noise.tracker) return whitening(*options_.noise.tracker, point);
  return Eigen::Matrix3d::Identity() / (reading.orientation ? options_.noise.body : options_.noise.point);
}

}  // namespace paracal::detail

#include "points.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "median.hpp"

namespace paracal::detail {
namespace {

constexpr Eigen::Index kFrame = 6;

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Eigen::Matrix3d turn_by(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  return angle == 0.0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                      : Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

}  // namespace

Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount) {
  return plate_rotation(plate.tilt).matrix * Eigen::AngleAxisd(turns_per_phi(mount) * phi, Eigen::Vector3d::UnitZ());
}

Points::Points(const PointSeries& series, const CalibrationOptions& options)
    : ReadingSeries(series.name), readings_(series.readings), options_(options) {}

Group Points::group(std::size_t index) const {
  const PointReading& reading = readings_[index];
  return {.station = static_cast<std::uint32_t>(reading.station),
          .stated = reading.sigma.has_value() || options_.noise.tracker.has_value()};
}

double Points::sigma(std::size_t index) const {
  const PointReading& reading = readings_[index];
  return std::sqrt(3.0) / whitening_of(reading, reading.point).norm();
}

void Points::take_columns(Eigen::Index& next, bool seeks_scale) {
  if (options_.frame == Frame::unknown) frame_ = take(next, kFrame);
  const bool turns = std::ranges::any_of(readings_, [](const auto& r) { return r.rotation.has_value(); });
  if (turns && options_.rotation_zero == RotationZero::unknown) zero_ = take(next, 1);
  if (std::ranges::any_of(readings_, [](const auto& r) { return r.second.has_value(); })) second_ = take(next, 3);
  if (seeks_scale) scale_ = take(next, 1);
}

void Points::start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) {
  std::vector<Eigen::Vector3d> predicted, measured, seconds;
  std::vector<double> zeros;
  for (const PointReading& reading : readings_) {
    predicted.push_back(stations[reading.station].plate.position);
    measured.push_back(reading.point);
  }
  if (frame_ >= 0) {
    const RigidMotion motion = robust_rigid_fit(predicted, measured);
    turned_ = motion.rotation;
    unknowns.segment<3>(frame_).setZero();
    unknowns.segment<3>(frame_ + 3) = motion.translation;
  }
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

void Points::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (scale_ >= 0) root.add_prior(scale_, unknowns(scale_), 0.0, options_.scale_std);
}

void Points::set_units(Eigen::VectorXd& unit) const {
  constexpr double kTurn = 0.005;  // of the frame
  if (frame_ >= 0) unit.segment<3>(frame_).setConstant(kTurn);
}

Eigen::Matrix3d Points::reflector_rows(Eigen::Index row, const Eigen::Vector3d& x, const Eigen::Vector3d& read,
                                       const PointReading& reading, const Eigen::VectorXd& unknowns,
                                       Eigen::MatrixXd& block) const {
  const RigidMotion motion = frame(unknowns);
  const Eigen::Matrix3d whiten = whitening_of(reading, read);
  const Eigen::Vector3d turned = motion.rotation * x;
  const double longer = scale(unknowns);
  block.block<3, 1>(row, unknowns.size()) = whiten * (longer * turned + motion.translation - read);
  if (scale_ >= 0) block.block<3, 1>(row, scale_) = whiten * turned;
  if (frame_ >= 0) {
    // exp([w + dw]) v = exp([w]) v - [exp([w]) v] J_l(w) dw,  J_l = I + [w] / 2 to first order
    const Eigen::Matrix3d left =
        Eigen::Matrix3d::Identity() + 0.5 * cross(Eigen::Vector3d(unknowns.segment<3>(frame_)));
    block.block<3, 3>(row, frame_) = -longer * whiten * cross(turned) * left;
    block.block<3, 3>(row, frame_ + 3) = whiten;
  }
  return longer * whiten * motion.rotation;
}

ByPlate Points::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const PointReading& reading = readings_[index];
  const StationState& station = at.stations[reading.station];
  const Eigen::Vector3d& r = station.plate.position;
  const Eigen::Index last = at.unknowns.size();
  block.setZero(3 + (reading.second ? 3 : 0) + (reading.rotation ? 1 : 0), last + 1);
  ByPlate by_plate = ByPlate::Zero(block.rows(), 7);
  by_plate.block<3, 3>(0, 0) = reflector_rows(0, r, reading.point, reading, at.unknowns, block);
  if (reading.second) {
    const Eigen::Matrix3d carried = carrier(station);
    const Eigen::Vector3d lever = carried * at.unknowns.segment<3>(second_);
    const Eigen::Matrix3d moves = reflector_rows(3, r + lever, *reading.second, reading, at.unknowns, block);
    const PlateRotation<double> plate = plate_rotation(station.plate.tilt);
    by_plate.block<3, 3>(3, 0) = moves;
    by_plate.block<3, 3>(3, 4) = -moves * cross(lever) * plate.axes;
    by_plate.block<3, 1>(3, 3) = turns_per_phi(options_.reflectors) * (moves * plate.matrix.col(2).cross(lever));
    block.block<3, 3>(3, second_) = moves * carried;
  }
  if (!reading.rotation) return by_plate;
  const Eigen::Index row = block.rows() - 1;
  const double sigma = options_.noise.rotation;
  by_plate(row, 3) = 1.0 / sigma;
  if (zero_ >= 0) block(row, zero_) = -1.0 / sigma;
  block(row, last) = rotation_off(reading, station, at.unknowns) / sigma;
  return by_plate;
}

Residual Points::residual(std::size_t index, const Placed& at) const {
  const PointReading& reading = readings_[index];
  const StationState& station = at.stations[reading.station];
  Residual residual{off(reading, station, at.unknowns)};
  if (reading.rotation) residual.rotation = rotation_off(reading, station, at.unknowns);
  return residual;
}

double Points::rotation_off(const PointReading& reading, const StationState& station,
                            const Eigen::VectorXd& unknowns) const {
  return station.rotation - rotation_zero(unknowns).value_or(0.0) - *reading.rotation;
}

Eigen::Vector3d Points::off(const PointReading& reading, const StationState& station,
                            const Eigen::VectorXd& unknowns) const {
  return station.plate.position - frame(unknowns).inverse()(reading.point) / scale(unknowns);
}

RigidMotion Points::frame(const Eigen::VectorXd& unknowns) const {
  if (frame_ < 0) return {};
  return {turn_by(unknowns.segment<3>(frame_)) * turned_, unknowns.segment<3>(frame_ + 3)};
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
  return Eigen::Matrix3d::Identity() / options_.noise.point;
}

std::string Points::label(std::size_t index, const std::vector<Station>& stations) const {
  const std::size_t station = readings_[index].station;
  const auto same = [&](const PointReading& reading) { return reading.station == station; };
  std::string text = fmt::format("{} of {}", stations[station].name, name());
  if (std::ranges::count_if(readings_, same) > 1) {
    const auto before =
        std::count_if(readings_.begin(), readings_.begin() + static_cast<std::ptrdiff_t>(index) + 1, same);
    text += fmt::format(", repeat {}", before);
  }
  return text;
}

/// The station where the machine stood closest to it. Two readings that explain each other were swapped.
std::string Points::explanation(std::size_t index, const Placed& at, const std::vector<Station>& stations) const {
  constexpr double kNear = 2.0;  // mm: a calibrated machine's reading lies this close to its station
  const auto near = [&](const PointReading& reading, std::size_t station) {
    return off(reading, at.stations[station], at.unknowns).norm() < kNear;
  };
  const PointReading& reading = readings_[index];
  for (const PointReading& other : readings_) {
    if (other.station == reading.station || !near(reading, other.station)) continue;
    const bool swapped = std::ranges::any_of(
        readings_, [&](const PointReading& one) { return one.station == other.station && near(one, reading.station); });
    return fmt::format("{} {}", swapped ? "swapped with" : "it was taken at", stations[other.station].name);
  }
  return {};
}

std::vector<PosePair> Points::station_pairs(std::span<const Group> of_series, const Placed& at) const {
  struct Mean {
    PosePair pair;
    int points = 0, rotations = 0;
  };
  std::map<std::size_t, Mean> means;
  for (const Group& group : of_series) {
    if (!group.active) continue;
    const StationState& station = at.stations[group.station];
    Mean& mean = means[group.station];
    if (mean.points == 0) {
      const Pose meant{station.plate.position, station.rotation};
      mean.pair = {meant, {Eigen::Vector3d::Zero(), meant.rotation}};
    }
    const Residual residual = this->residual(group.index, at);
    const Eigen::Vector3d measured = station.plate.position - residual.length;
    mean.pair.actual.position += (measured - mean.pair.actual.position) / ++mean.points;
    if (residual.rotation) {
      const double read = station.rotation - *residual.rotation;
      mean.pair.actual.rotation += (read - mean.pair.actual.rotation) / ++mean.rotations;
    }
  }
  std::vector<PosePair> pairs;
  pairs.reserve(means.size());
  for (const auto& [station, mean] : means) pairs.push_back(mean.pair);
  return pairs;
}

void Points::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  const std::vector<PosePair> pairs = station_pairs(of_series, at);
  const bool rotations = std::ranges::any_of(readings_, [](const auto& r) { return r.rotation.has_value(); });
  const PoseErrorSummary one = summarize(pairs, rotations);
  PoseErrorSummary& all = tally.summary;
  all.max_abs_distance = std::max(all.max_abs_distance, one.max_abs_distance);
  all.max_volumetric = std::max(all.max_volumetric, one.max_volumetric);
  all.max_volumetric_aligned = std::max(all.max_volumetric_aligned, one.max_volumetric_aligned);
  tally.widen_rotation(one.max_abs_rotation);
  tally.distances.squares += one.rms_distance * one.rms_distance * static_cast<double>(pairs.size() - 1);
  tally.distances.count += pairs.size() - 1;
}

void Points::list(const Group& group, const std::vector<Station>& stations, const Residual& before,
                  const Residual& after, Calibration& calibration) const {
  calibration.points.push_back({name(), stations[group.station].name, before.length, after.length, before.rotation,
                                after.rotation, !group.active});
}

void Points::state_setup(const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& /*covariance*/,
                         Calibration& calibration) const {
  calibration.frames.push_back({name(), frame(unknowns), rotation_zero(unknowns), second_reflector(unknowns)});
}

}  // namespace paracal::detail

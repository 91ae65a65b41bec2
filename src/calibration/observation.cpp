#include "observation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal::detail {
namespace {

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

/// Components in which `values` have their medians.
Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    column.reserve(values.size());
    for (const Eigen::Vector3d& value : values) column.push_back(value(axis));
    const auto half = column.begin() + static_cast<std::ptrdiff_t>(column.size() / 2);
    std::ranges::nth_element(column, half);
    middle(axis) = *half;
  }
  return middle;
}

/// Rotation of what carries the second reflector, and the axes about which tilt and phi turn it.
Eigen::Matrix3d carrier(const StationState& station, ReflectorMount mount) {
  Eigen::Matrix3d plate = plate_rotation(station.plate.tilt).matrix;
  if (mount == ReflectorMount::plate) return plate;
  return plate * Eigen::AngleAxisd(station.rotation, Eigen::Vector3d::UnitZ());
}

constexpr Eigen::Index kFrame = 6;

}  // namespace

Observation::Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                         std::vector<SoughtSource> sought)
    : robot_(robot), measurements_(measurements), options_(options), sought_(std::move(sought)) {
  joints_.reserve(measurements.stations.size());
  for (const Station& station : measurements.stations) joints_.push_back(believed_joints(robot, station));
  lay_out_nuisance();
  add_groups();
}

void Observation::lay_out_nuisance() {
  for (const PointSeries& series : measurements_.series) {
    Nuisance nuisance;
    const auto take = [&](Eigen::Index count) { return std::exchange(nuisance_count_, nuisance_count_ + count); };
    if (options_.frame == Frame::unknown) nuisance.frame = take(kFrame);
    const bool turns = std::ranges::any_of(series.readings, [](const auto& r) { return r.rotation.has_value(); });
    if (turns && options_.rotation_zero == RotationZero::unknown) nuisance.zero = take(1);
    if (std::ranges::any_of(series.readings, [](const auto& r) { return r.second.has_value(); })) {
      nuisance.second = take(3);
    }
    nuisance_.push_back(nuisance);
  }
}

void Observation::add_groups() {
  std::size_t count = measurements_.distances.size();
  for (const PointSeries& series : measurements_.series) count += series.readings.size();
  groups_.reserve(count);
  const auto add = [&](bool is_point, std::size_t series, std::size_t index, std::size_t station, bool stated) {
    groups_.push_back({.series = static_cast<std::uint32_t>(series),
                       .index = static_cast<std::uint32_t>(index),
                       .station = static_cast<std::uint32_t>(station),
                       .is_point = is_point,
                       .stated = stated || options_.noise_is_known});
  };
  for (std::size_t s = 0; s < measurements_.series.size(); ++s) {
    const std::vector<PointReading>& readings = measurements_.series[s].readings;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      add(true, s, k, readings[k].station, readings[k].sigma.has_value() || options_.noise.tracker.has_value());
    }
  }
  for (std::size_t k = 0; k < measurements_.distances.size(); ++k) {
    const DistanceReading& reading = measurements_.distances[k];
    add(false, 0, k, reading.to, reading.distance_sigma.has_value() && !reading.rotation);
  }
}

void Observation::keep_nominal_derivative() {
  nominal_.clear();
  last_stations_.reset();
  for (const Joints& joints : joints_) {
    nominal_.push_back(state_of(robot_.nominal(), forward(robot_.nominal(), joints).plate, joints));
  }
}

SourceErrors Observation::errors(const Eigen::VectorXd& unknowns) const {
  SourceErrors errors = held_;
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    errors(sought_[k].limb, sought_[k].source) = unknowns(nuisance_count_ + static_cast<Eigen::Index>(k));
  }
  return errors;
}

std::optional<Eigen::VectorXd> Observation::start(const SourceErrors& errors) {
  held_ = errors;
  last_stations_.reset();
  Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(unknown_count());
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    unknowns(nuisance_count_ + static_cast<Eigen::Index>(k)) = errors(sought_[k].limb, sought_[k].source);
  }
  const auto states = stations(unknowns);
  if (!states) return std::nullopt;
  for (std::size_t s = 0; s < measurements_.series.size(); ++s) align(s, *states, unknowns);
  return unknowns;
}

void Observation::align(std::size_t series, const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) {
  Nuisance& nuisance = nuisance_[series];
  std::vector<Eigen::Vector3d> predicted, measured, seconds;
  for (const PointReading& reading : measurements_.series[series].readings) {
    predicted.push_back(stations[reading.station].plate.position);
    measured.push_back(reading.point);
  }
  if (nuisance.frame >= 0) {
    const RigidMotion motion = robust_rigid_fit(predicted, measured);
    nuisance.turned = motion.rotation;
    unknowns.segment<3>(nuisance.frame).setZero();
    unknowns.segment<3>(nuisance.frame + 3) = motion.translation;
  }
  std::vector<Eigen::Vector3d> zeros;
  for (const PointReading& reading : measurements_.series[series].readings) {
    const StationState& station = stations[reading.station];
    if (reading.rotation) zeros.emplace_back(station.rotation - *reading.rotation, 0.0, 0.0);
    if (reading.second) {
      seconds.emplace_back(carrier(station, options_.reflectors).transpose() * nuisance.turned.transpose() *
                           (*reading.second - reading.point));
    }
  }
  if (nuisance.zero >= 0) unknowns(nuisance.zero) = median(zeros).x();
  if (nuisance.second >= 0) unknowns.segment<3>(nuisance.second) = median(seconds);
}

std::shared_ptr<const std::vector<StationState>> Observation::stations(const Eigen::VectorXd& unknowns) const {
  const bool again = last_stations_ && last_unknowns_.size() == unknowns.size() && last_unknowns_ == unknowns;
  if (!again) {
    last_stations_ = evaluate(unknowns);
    last_unknowns_ = unknowns;
  }
  return last_stations_;
}

std::shared_ptr<const std::vector<StationState>> Observation::evaluate(const Eigen::VectorXd& unknowns) const {
  const Machine machine = build(robot_, errors(unknowns));
  std::vector<StationState> states;
  states.reserve(joints_.size());
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const ForwardResult pose = forward(machine, joints_[k]);
    if (!pose.ok()) return nullptr;
    if (nominal_.empty()) {
      states.push_back(state_of(machine, pose.plate, joints_[k]));
    } else {
      states.push_back({pose.plate, machine.rotation_of(pose.plate.slide), nominal_[k].jacobian});
    }
    if (states.back().jacobian.cols() != source_count()) return nullptr;
  }
  return std::make_shared<const std::vector<StationState>>(std::move(states));
}

StationState Observation::state_of(const Machine& machine, const PlateState& plate, const Joints& joints) const {
  StationState state{plate, machine.rotation_of(plate.slide), {}};
  const ExactJacobian exact = exact_jacobian(machine, plate, joints);
  if (!exact.ok) return state;
  state.jacobian.resize(7, source_count());
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto sensitivity = exact.plate.col(ExactJacobian::column(sought_[k].limb, sought_[k].source));
    state.jacobian.col(column).head<3>() = sensitivity.head<3>();
    state.jacobian(3, column) = machine.has_slide() ? machine.rotation_of(sensitivity(3)) : 0.0;
    state.jacobian.col(column).tail<3>() = sensitivity.tail<3>();
  }
  return state;
}

RigidMotion Observation::frame(std::size_t series, const Eigen::VectorXd& unknowns) const {
  const Nuisance& nuisance = nuisance_[series];
  if (nuisance.frame < 0) return {};
  return {turn_by(unknowns.segment<3>(nuisance.frame)) * nuisance.turned, unknowns.segment<3>(nuisance.frame + 3)};
}

void Observation::rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                       Eigen::MatrixXd& block) const {
  group.is_point ? point_rows(group, stations[group.station], unknowns, block) : distance_rows(group, stations, block);
  if (!group.stated) block /= noise_scale_;
  if (group.weight != 1.0) block *= std::sqrt(group.weight);
}

void Observation::distance_rows(const Group& group, const std::vector<StationState>& stations,
                                Eigen::MatrixXd& block) const {
  const DistanceReading& reading = distance(group);
  const StationState &from = stations[reading.from], &to = stations[reading.to];
  const Eigen::Vector3d between = to.plate.position - from.plate.position;
  const double length = between.norm();
  const double sigma = sigma_of(reading);
  // A derivative kept at the nominal machine needs the direction there, too: otherwise turns of the whole robot, which
  // no distance sees, become weakly visible, and an undamped step along them is wild.
  const Eigen::Vector3d direction =
      nominal_.empty() ? between : nominal_[reading.to].plate.position - nominal_[reading.from].plate.position;
  const Eigen::Index residual = unknown_count();
  block.setZero(reading.rotation ? 2 : 1, residual + 1);
  block.block(0, nuisance_count_, 1, source_count()).noalias() =
      (direction.normalized().transpose() / sigma) * (to.jacobian.topRows<3>() - from.jacobian.topRows<3>());
  block(0, residual) = (length - reading.distance) / sigma;
  if (!reading.rotation) return;
  block.row(1).segment(nuisance_count_, source_count()) =
      (to.jacobian.row(3) - from.jacobian.row(3)) / options_.noise.rotation;
  block(1, residual) = (to.rotation - from.rotation - *reading.rotation) / options_.noise.rotation;
}

Eigen::Matrix3d Observation::whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const {
  if (reading.sigma) return Eigen::Matrix3d::Identity() / *reading.sigma;
  if (options_.noise.tracker) return whitening(*options_.noise.tracker, point);
  return Eigen::Matrix3d::Identity() / options_.noise.point;
}

void Observation::point_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                             Eigen::MatrixXd& block) const {
  const PointReading& reading = point(group);
  const Nuisance& nuisance = nuisance_[group.series];
  const RigidMotion motion = frame(group.series, unknowns);
  const Eigen::Index residual = unknown_count();
  block.setZero(3 + (reading.second ? 3 : 0) + (reading.rotation ? 1 : 0), residual + 1);
  // One reflector: t + Q x, where x stands in the robot's frame and moves with dx.
  const auto reflector = [&](Eigen::Index row, const Eigen::Vector3d& x, const auto& dx, const Eigen::Vector3d& read) {
    const Eigen::Matrix3d whiten = whitening_of(reading, read);
    block.block(row, nuisance_count_, 3, source_count()).noalias() = (whiten * motion.rotation) * dx;
    block.block<3, 1>(row, residual) = whiten * (motion(x) - read);
    if (nuisance.frame < 0) return;
    // exp([w + dw]) v = exp([w]) v - [exp([w]) v] J_l(w) dw,  J_l = I + [w] / 2 to first order
    const Eigen::Matrix3d left =
        Eigen::Matrix3d::Identity() + 0.5 * cross(Eigen::Vector3d(unknowns.segment<3>(nuisance.frame)));
    block.block<3, 3>(row, nuisance.frame) = -whiten * cross(motion.rotation * x) * left;
    block.block<3, 3>(row, nuisance.frame + 3) = whiten;
  };
  const Eigen::Vector3d& r = station.plate.position;
  reflector(0, r, station.jacobian.topRows<3>(), reading.point);
  if (reading.second) {
    const Eigen::Matrix3d carried = carrier(station, options_.reflectors);
    const Eigen::Vector3d lever = carried * unknowns.segment<3>(nuisance.second);
    Eigen::Matrix<double, 3, Eigen::Dynamic> dx = station.jacobian.topRows<3>();
    const PlateRotation<double> plate = plate_rotation(station.plate.tilt);
    dx.noalias() -= (cross(lever) * plate.axes) * station.jacobian.bottomRows<3>();
    if (options_.reflectors == ReflectorMount::end_effector) {
      dx.noalias() += plate.matrix.col(2).cross(lever) * station.jacobian.row(3);
    }
    reflector(3, r + lever, dx, *reading.second);
    block.block<3, 3>(3, nuisance.second) = whitening_of(reading, *reading.second) * motion.rotation * carried;
  }
  if (!reading.rotation) return;
  const Eigen::Index row = block.rows() - 1;
  const double sigma = options_.noise.rotation;
  block.row(row).segment(nuisance_count_, source_count()) = station.jacobian.row(3) / sigma;
  if (nuisance.zero >= 0) block(row, nuisance.zero) = -1.0 / sigma;
  block(row, residual) =
      (station.rotation - rotation_zero(group.series, unknowns).value_or(0.0) - *reading.rotation) / sigma;
}

std::optional<double> Observation::rotation_zero(std::size_t series, const Eigen::VectorXd& unknowns) const {
  const Eigen::Index zero = nuisance_[series].zero;
  return zero < 0 ? std::nullopt : std::optional(unknowns(zero));
}

std::optional<Eigen::Vector3d> Observation::second_reflector(std::size_t series,
                                                             const Eigen::VectorXd& unknowns) const {
  const Eigen::Index second = nuisance_[series].second;
  if (second < 0) return std::nullopt;
  return Eigen::Vector3d(unknowns.segment<3>(second));
}

Eigen::Vector3d Observation::point_residual(const Group& group, const StationState& station,
                                            const Eigen::VectorXd& unknowns) const {
  const RigidMotion motion = frame(group.series, unknowns);
  return station.plate.position - motion.inverse()(point(group).point);
}

std::optional<double> Observation::rotation_residual(const Group& group, const std::vector<StationState>& stations,
                                                     const Eigen::VectorXd& unknowns) const {
  if (!group.is_point) {
    const DistanceReading& reading = distance(group);
    if (!reading.rotation) return std::nullopt;
    return stations[reading.to].rotation - stations[reading.from].rotation - *reading.rotation;
  }
  const PointReading& reading = point(group);
  if (!reading.rotation) return std::nullopt;
  return stations[group.station].rotation - rotation_zero(group.series, unknowns).value_or(0.0) - *reading.rotation;
}

RowModel with_priors(const Observation& observation) {
  return [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    // First the priors: on an empty root they cost nothing.
    for (Eigen::Index k = 0; k < observation.source_count(); ++k) {
      const SoughtSource& one = observation.sought()[static_cast<std::size_t>(k)];
      const Eigen::Index column = observation.nuisance_count() + k;
      if (one.prior_std) root.add_prior(column, unknowns(column), 0.0, *one.prior_std);
    }
    return observation(unknowns, root);
  };
}

}  // namespace paracal::detail

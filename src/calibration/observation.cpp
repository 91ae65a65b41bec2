#include "observation.hpp"

#include <Eigen/Cholesky>
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

constexpr Eigen::Index kFrame = 6, kPlane = 3;

}  // namespace

Observation::Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                         std::vector<SoughtSource> sought)
    : robot_(robot), measurements_(measurements), options_(options), sought_(std::move(sought)) {
  joints_.reserve(measurements.stations.size());
  for (const Station& station : measurements.stations) joints_.push_back(believed_joints(robot, station));
  lay_out_nuisance();
  lay_out_priors();
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
  for (std::size_t k = 0; k < measurements_.planes.size(); ++k) {
    planes_.push_back(std::exchange(nuisance_count_, nuisance_count_ + kPlane));
  }
  const bool has_bias = options_.noise.distance_bias > 0.0 && !measurements_.distances.empty();
  if (has_bias) bias_ = nuisance_count_++;
}

/// C = diag(prior^2) with what common errors correlate; prior_std has their share already.
void Observation::lay_out_priors() {
  if (options_.common.empty() || !has_priors(*this)) return;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(source_count(), source_count());
  for (Eigen::Index i = 0; i < source_count(); ++i) {
    const SoughtSource& one = sought_[static_cast<std::size_t>(i)];
    constexpr double kNone = 1e6;  // mm or rad: sought without a prior among others that have one
    covariance(i, i) = std::pow(one.prior_std.value_or(kNone), 2);
    for (Eigen::Index k = 0; k < i; ++k) {
      const SoughtSource& other = sought_[static_cast<std::size_t>(k)];
      if (!one.prior_std || !other.prior_std) continue;
      for (const CommonError& error : options_.common) {
        covariance(i, k) +=
            error.std * error.std * error.direction(one.limb, one.source) * error.direction(other.limb, other.source);
      }
      covariance(k, i) = covariance(i, k);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  common_prior_ = root.matrixL().solve(Eigen::MatrixXd::Identity(source_count(), source_count()));
}

void Observation::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (bias_ >= 0) root.add_prior(bias_, unknowns(bias_), 0.0, options_.noise.distance_bias);
  for (const Eigen::Index plane : planes_) {
    if (!options_.plane_slope) break;
    root.add_prior(plane + 1, unknowns(plane + 1), 0.0, *options_.plane_slope);
    root.add_prior(plane + 2, unknowns(plane + 2), 0.0, *options_.plane_slope);
  }
  if (common_prior_.size() > 0) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(source_count(), unknown_count() + 1);
    rows.middleCols(nuisance_count_, source_count()) = common_prior_;
    rows.rightCols<1>() = common_prior_ * unknowns.tail(source_count());
    return root.add(rows);
  }
  for (Eigen::Index k = 0; k < source_count(); ++k) {
    const SoughtSource& one = sought_[static_cast<std::size_t>(k)];
    const Eigen::Index column = nuisance_count_ + k;
    if (one.prior_std) root.add_prior(column, unknowns(column), 0.0, *one.prior_std);
  }
}

void Observation::add_groups() {
  std::size_t count = measurements_.distances.size();
  for (const PointSeries& series : measurements_.series) count += series.readings.size();
  for (const HeightSeries& plane : measurements_.planes) count += plane.readings.size();
  groups_.reserve(count);
  const auto add = [&](ReadingKind kind, std::size_t series, std::size_t index, std::size_t station, bool stated) {
    groups_.push_back({.series = static_cast<std::uint32_t>(series),
                       .index = static_cast<std::uint32_t>(index),
                       .station = static_cast<std::uint32_t>(station),
                       .kind = kind,
                       .stated = stated || options_.noise_is_known});
  };
  for (std::size_t s = 0; s < measurements_.series.size(); ++s) {
    const std::vector<PointReading>& readings = measurements_.series[s].readings;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      const bool stated = readings[k].sigma.has_value() || options_.noise.tracker.has_value();
      add(ReadingKind::point, s, k, readings[k].station, stated);
    }
  }
  for (std::size_t k = 0; k < measurements_.distances.size(); ++k) {
    const DistanceReading& reading = measurements_.distances[k];
    add(ReadingKind::distance, 0, k, reading.to, reading.distance_sigma.has_value() && !reading.rotation);
  }
  for (std::size_t s = 0; s < measurements_.planes.size(); ++s) {
    const std::vector<HeightReading>& readings = measurements_.planes[s].readings;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      add(ReadingKind::height, s, k, readings[k].station, readings[k].sigma.has_value());
    }
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
  for (std::size_t s = 0; s < planes_.size(); ++s) {
    std::vector<Eigen::Vector3d> levels;
    for (const HeightReading& reading : measurements_.planes[s].readings) {
      levels.emplace_back(0.0, 0.0, (*states)[reading.station].plate.position.z() - reading.height);
    }
    if (!levels.empty()) unknowns(planes_[s]) = median(levels).z();
  }
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
  switch (group.kind) {
    case ReadingKind::point:
      point_rows(group, stations[group.station], unknowns, block);
      break;
    case ReadingKind::distance:
      distance_rows(group, stations, unknowns, block);
      break;
    case ReadingKind::height:
      height_rows(group, stations[group.station], unknowns, block);
      break;
  }
  if (!group.stated) block /= noise_scale_;
  if (group.weight != 1.0) block *= std::sqrt(group.weight);
}

void Observation::distance_rows(const Group& group, const std::vector<StationState>& stations,
                                const Eigen::VectorXd& unknowns, Eigen::MatrixXd& block) const {
  const DistanceReading& reading = distance(group);
  const StationState &from = stations[reading.from], &to = stations[reading.to];
  const Eigen::Vector3d between = to.plate.position - from.plate.position;
  const double sigma = sigma_of(reading);
  // A derivative kept at the nominal machine needs the direction there, too: otherwise turns of the whole robot, which
  // no distance sees, become weakly visible, and an undamped step along them is wild.
  const Eigen::Vector3d direction =
      nominal_.empty() ? between : nominal_[reading.to].plate.position - nominal_[reading.from].plate.position;
  const Eigen::Index residual = unknown_count();
  block.setZero(reading.rotation ? 2 : 1, residual + 1);
  block.block(0, nuisance_count_, 1, source_count()).noalias() =
      (direction.normalized().transpose() / sigma) * (to.jacobian.topRows<3>() - from.jacobian.topRows<3>());
  if (bias_ >= 0) block(0, bias_) = 1.0 / sigma;
  block(0, residual) = distance_residual(group, stations, unknowns) / sigma;
  if (!reading.rotation) return;
  block.row(1).segment(nuisance_count_, source_count()) =
      (to.jacobian.row(3) - from.jacobian.row(3)) / options_.noise.rotation;
  block(1, residual) = (to.rotation - from.rotation - *reading.rotation) / options_.noise.rotation;
}

void Observation::height_rows(const Group& group, const StationState& station, const Eigen::VectorXd& unknowns,
                              Eigen::MatrixXd& block) const {
  const Eigen::Vector3d& r = station.plate.position;
  const Eigen::Vector3d of_plane = plane(group.series, unknowns);
  const Eigen::Index at = planes_[group.series];
  const double sigma = sigma_of(group);
  block.setZero(1, unknown_count() + 1);
  block.block<1, 3>(0, at) << -1.0, -r.x(), -r.y();
  block.block(0, nuisance_count_, 1, source_count()).noalias() =
      Eigen::RowVector3d(-of_plane(1), -of_plane(2), 1.0) * station.jacobian.topRows<3>();
  block(0, unknown_count()) = height_residual(group, station, unknowns);
  block /= sigma;
}

Eigen::Vector3d Observation::plane(std::size_t series, const Eigen::VectorXd& unknowns) const {
  return unknowns.segment<3>(planes_[series]);
}

double Observation::height_residual(const Group& group, const StationState& station,
                                    const Eigen::VectorXd& unknowns) const {
  const Eigen::Vector3d& r = station.plate.position;
  return r.z() - plane(group.series, unknowns).dot(Eigen::Vector3d(1.0, r.x(), r.y())) - height(group).height;
}

std::optional<double> Observation::distance_bias(const Eigen::VectorXd& unknowns) const {
  return bias_ < 0 ? std::nullopt : std::optional(unknowns(bias_));
}

double Observation::distance_residual(const Group& group, const std::vector<StationState>& stations,
                                      const Eigen::VectorXd& unknowns) const {
  const DistanceReading& reading = distance(group);
  const double length = (stations[reading.to].plate.position - stations[reading.from].plate.position).norm();
  return length + distance_bias(unknowns).value_or(0.0) - reading.distance;
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
  if (group.is_height()) return std::nullopt;
  if (group.is_distance()) {
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
    observation.add_priors(unknowns, root);  // first: on an empty root they cost nothing
    return observation(unknowns, root);
  };
}

}  // namespace paracal::detail

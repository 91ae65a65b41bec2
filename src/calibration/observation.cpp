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

constexpr Eigen::Index kFrame = 6, kPlane = 3;

}  // namespace

Eigen::Matrix3d carrier(const StationState& station, ReflectorMount mount) {
  return mount_rotation(station.plate, station.rotation, mount);
}

Eigen::Matrix3d mount_rotation(const PlateState& plate, double phi, ReflectorMount mount) {
  return plate_rotation(plate.tilt).matrix * Eigen::AngleAxisd(turns_per_phi(mount) * phi, Eigen::Vector3d::UnitZ());
}

Observation::Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                         std::vector<SoughtSource> sought, bool seeks_scale)
    : robot_(robot),
      measurements_(measurements),
      options_(options),
      seeks_scale_(seeks_scale && options.scale_std > 0.0),
      sought_(std::move(sought)),
      prior_factor_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(sought_.size()))) {
  joints_.reserve(measurements.stations.size());
  for (const Station& station : measurements.stations) joints_.push_back(believed_joints(robot, station));
  lay_out_nuisance();
  lay_out_priors();
  add_groups();
  list_stations();
}

void Observation::lay_out_nuisance() {
  const auto take = [&](Eigen::Index count) { return std::exchange(nuisance_count_, nuisance_count_ + count); };
  for (const PointSeries& series : measurements_.series) {
    Nuisance nuisance;
    if (options_.frame == Frame::unknown) nuisance.frame = take(kFrame);
    const bool turns = std::ranges::any_of(series.readings, [](const auto& r) { return r.rotation.has_value(); });
    if (turns && options_.rotation_zero == RotationZero::unknown) nuisance.zero = take(1);
    if (std::ranges::any_of(series.readings, [](const auto& r) { return r.second.has_value(); })) {
      nuisance.second = take(3);
    }
    if (seeks_scale_) nuisance.scale = take(1);
    nuisance_.push_back(nuisance);
  }
  for (std::size_t k = 0; k < measurements_.planes.size(); ++k) {
    planes_.push_back(take(kPlane));
  }
  if (measurements_.distances.empty()) return;
  if (options_.noise.distance_bias > 0.0) bias_ = take(1);
  if (seeks_scale_) distance_scale_ = take(1);
}

std::vector<Eigen::Index> Observation::scale_columns() const {
  std::vector<Eigen::Index> columns;
  for (const Nuisance& nuisance : nuisance_) {
    if (nuisance.scale >= 0) columns.push_back(nuisance.scale);
  }
  if (distance_scale_ >= 0) columns.push_back(distance_scale_);
  return columns;
}

void Observation::widen_priors(const std::vector<std::size_t>& places, double factor) {
  for (const std::size_t place : places) {
    if (!sought_[place].prior_std) continue;
    *sought_[place].prior_std *= factor;
    prior_factor_(static_cast<Eigen::Index>(place)) *= factor;
  }
  lay_out_priors();
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
        covariance(i, k) += prior_factor_(i) * prior_factor_(k) * error.std * error.std *
                            error.direction(one.limb, one.source) * error.direction(other.limb, other.source);
      }
      covariance(k, i) = covariance(i, k);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  common_prior_ = root.matrixL().solve(Eigen::MatrixXd::Identity(source_count(), source_count()));
}

void Observation::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (bias_ >= 0) root.add_prior(bias_, unknowns(bias_), 0.0, options_.noise.distance_bias);
  for (const Eigen::Index scale : scale_columns()) root.add_prior(scale, unknowns(scale), 0.0, options_.scale_std);
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

void Observation::list_stations() {
  at_station_.resize(measurements_.stations.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].is_distance()) at_station_[groups_[g].station].push_back(static_cast<std::uint32_t>(g));
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
      states.push_back({pose.plate, machine.rotation_of(pose.plate.slide), nominal_[k].jacobian, nominal_[k].by_joint});
    }
    if (states.back().jacobian.cols() != source_count()) return nullptr;
  }
  return std::make_shared<const std::vector<StationState>>(std::move(states));
}

StationState Observation::state_of(const Machine& machine, const PlateState& plate, const Joints& joints) const {
  StationState state{plate, machine.rotation_of(plate.slide), {}, {}};
  const ExactJacobian exact = exact_jacobian(machine, plate, joints);
  if (!exact.ok) return state;
  const auto motion = [&](std::size_t limb, Source source, auto&& column) {
    const auto sensitivity = exact.plate.col(ExactJacobian::column(limb, source));
    column.template head<3>() = sensitivity.template head<3>();
    column(3) = machine.has_slide() ? machine.rotation_of(sensitivity(3)) : 0.0;
    column.template tail<3>() = sensitivity.template tail<3>();
  };
  state.jacobian.resize(7, source_count());
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    motion(sought_[k].limb, sought_[k].source, state.jacobian.col(static_cast<Eigen::Index>(k)));
  }
  state.by_joint.resize(7, static_cast<Eigen::Index>(robot_.limb_count()));
  for (std::size_t limb = 0; limb < robot_.limb_count(); ++limb) {
    motion(limb, Source::theta_offset, state.by_joint.col(static_cast<Eigen::Index>(limb)));
  }
  return state;
}

RigidMotion Observation::frame(std::size_t series, const Eigen::VectorXd& unknowns) const {
  const Nuisance& nuisance = nuisance_[series];
  if (nuisance.frame < 0) return {};
  return {turn_by(unknowns.segment<3>(nuisance.frame)) * nuisance.turned, unknowns.segment<3>(nuisance.frame + 3)};
}

double reading_noise(const Observation& observation) {
  const auto& groups = observation.groups();
  const auto read = [&](ReadingKind kind) {
    return std::ranges::any_of(groups, [&](const Group& g) { return g.kind == kind; });
  };
  const ReadingKind kind = read(ReadingKind::point)      ? ReadingKind::point
                           : read(ReadingKind::distance) ? ReadingKind::distance
                                                         : ReadingKind::height;
  double sum = 0.0;
  int count = 0;
  for (const Group& group : groups) {
    if (!group.active || group.kind != kind) continue;
    const VarianceComponents& factors = observation.components();
    sum += std::pow(observation.sigma_of(group) * (group.stated ? factors.stated_noise : factors.unstated_noise), 2);
    ++count;
  }
  return std::sqrt(sum / std::max(count, 1));
}

RowModel with_priors(const Observation& observation) {
  return [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    observation.add_priors(unknowns, root);  // first: on an empty root they cost nothing
    return observation(unknowns, root);
  };
}

}  // namespace paracal::detail

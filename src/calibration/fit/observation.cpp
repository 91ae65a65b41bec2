#include "observation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/readings/joints.hpp"
#include "kinematics/joint_gaps.hpp"
#include "numerics/dense.hpp"
#include "paracal/interruption.hpp"
#include "paracal/kinematics/forward.hpp"
#include "sought.hpp"
#include "started.hpp"

namespace paracal::detail {
Observation::Observation(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                         std::vector<SoughtSource> sought, bool seeks_scale)
    : robot_(robot),
      options_(options),
      sought_(std::move(sought)),
      prior_std_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sought_.size()))),
      prior_factor_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(sought_.size()))),
      moving_(sought_),
      at_station_(measurements.stations.size()) {
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb)
    moving_.push_back({limb, joint_zero(robot.nominal().limbs[limb].actuator)});
  joints_.reserve(measurements.stations.size());
  for (const Station& station : measurements.stations) {
    joints_.push_back(believed_joints(robot, station));
    if (!robot.is_level()) starts_.push_back(started(robot, station));
  }
  for (auto& series : all_series(measurements, options)) {
    series->take_columns(nuisance_count_, seeks_scale && options.scale_std > 0.0);
    series_.push_back(std::move(series));
  }
  if (options.noise.joint > 0.0 && robot.nominal().gap_count() > 0) add_joint_readings();
  noise_.resize(series_.size());
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    prior_std_(static_cast<Eigen::Index>(k)) = sought_[k].prior_std.value_or(0.0);
  }
  lay_out_priors();
  add_groups();
  list_stations();
  constexpr std::size_t kMostKept = 5000;  // stations
  keeps_motions_ = joints_.size() <= kMostKept || std::ranges::any_of(groups_, &Group::is_relative);
}

void Observation::add_joint_readings() {
  const DifferentiableMachine& nominal = robot_.nominal();
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    gap_bases_.push_back(gap_basis(nominal, forward(nominal, joints_[k], start_of(k)).plate, joints_[k]));
  }
  series_.push_back(
      std::make_unique<JointReadings>(joints_.size(), options_.noise.joint, joint_ratio(nominal.limbs[0])));
}

std::vector<Eigen::Index> Observation::scale_columns() const {
  std::vector<Eigen::Index> columns;
  for (const auto& series : series_) {
    if (series->scale_column() >= 0) columns.push_back(series->scale_column());
  }
  return columns;
}

void Observation::widen_priors(const Eigen::VectorXd& factors) {
  prior_factor_ = factors;
  for (Eigen::Index k = 0; k < factors.size(); ++k) {
    std::optional<double>& prior = sought_[static_cast<std::size_t>(k)].prior_std;
    if (prior) prior = factors(k) * prior_std_(k);
  }
  lay_out_priors();
}

Eigen::MatrixXd Observation::prior_covariance() const {
  return detail::prior_covariance(sought_, options_.common, prior_factor_);
}

void Observation::lay_out_priors() {
  if (options_.common.empty() || !has_priors(*this)) return;
  common_prior_ = Cholesky(prior_covariance()).forward(Eigen::MatrixXd::Identity(source_count(), source_count()));
}

void Observation::add_set_up_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  for (const auto& series : series_) series->add_priors(unknowns, root);
}

void Observation::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  add_set_up_priors(unknowns, root);
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

Eigen::MatrixXd Observation::prior_root() const {
  if (common_prior_.size() > 0) return common_prior_;
  Eigen::VectorXd root = Eigen::VectorXd::Zero(source_count());
  for (Eigen::Index k = 0; k < root.size(); ++k) {
    if (const auto& std = sought_[static_cast<std::size_t>(k)].prior_std) root(k) = 1.0 / *std;
  }
  return root.asDiagonal();
}

void Observation::add_groups() {
  std::size_t count = 0;
  for (const auto& series : series_) {
    first_group_.push_back(count);
    count += series->size();
  }
  groups_.reserve(count);
  for (std::size_t s = 0; s < series_.size(); ++s) {
    for (std::size_t k = 0; k < series_[s]->size(); ++k) {
      Group group = series_[s]->group(k);
      group.series = static_cast<std::uint32_t>(s);
      group.index = static_cast<std::uint32_t>(k);
      group.stated = group.stated || options_.noise_is_known;
      groups_.push_back(group);
    }
  }
}

void Observation::list_stations() {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].is_relative()) at_station_[groups_[g].station].push_back(static_cast<std::uint32_t>(g));
  }
}

void Observation::keep_nominal_derivative() {
  nominal_.clear();
  last_stations_.reset();
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    let_interrupt();
    nominal_.push_back(state_of(robot_.nominal(), forward(robot_.nominal(), joints_[k], start_of(k)).plate, k));
    nominal_.back().motions = motions_at(nominal_.back(), k);
  }
}

SourceErrors Observation::errors(const Eigen::VectorXd& unknowns) const {
  SourceErrors errors = held_;
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    if (sought_[k].knot) continue;  // moves the joints of some poses, not a part
    errors(sought_[k].limb, sought_[k].source) = unknowns(nuisance_count_ + static_cast<Eigen::Index>(k));
  }
  return errors;
}

std::optional<Eigen::VectorXd> Observation::start(const SourceErrors& errors) {
  held_ = errors;
  last_stations_.reset();
  Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(unknown_count());
  for (std::size_t k = 0; k < sought_.size(); ++k) {
    if (sought_[k].knot) continue;
    unknowns(nuisance_count_ + static_cast<Eigen::Index>(k)) = errors(sought_[k].limb, sought_[k].source);
  }
  const auto states = stations(unknowns);
  if (!states) return std::nullopt;
  for (auto& series : series_) {
    std::unique_ptr<ReadingSeries> own = series->copy();
    own->start(*states, unknowns);
    series = std::move(own);
  }
  return unknowns;
}

std::shared_ptr<const std::vector<StationState>> Observation::stations(const Eigen::VectorXd& unknowns) const {
  const auto sources = unknowns.tail(source_count());  // the set-up of instruments moves no machine
  const bool again = last_stations_ && last_sources_.size() == sources.size() && last_sources_ == sources;
  if (!again) {
    last_stations_.reset();  // before its successor needs as much memory
    last_stations_ = evaluate(unknowns);
    last_sources_ = sources;
  }
  return last_stations_;
}

std::shared_ptr<const std::vector<StationState>> Observation::evaluate(const Eigen::VectorXd& unknowns) const {
  struct Answer {
    DifferentiableMachine machine;
    std::vector<StationState> states = {};
  };
  const auto answer = std::make_shared<Answer>(Answer{differentiable(robot_, errors(unknowns))});
  const DifferentiableMachine& machine = answer->machine;
  answer->states.reserve(joints_.size());
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    let_interrupt();
    const ForwardResult pose = forward(machine, joints_[k], start_of(k));
    if (!pose.ok()) return nullptr;
    StationState& state = answer->states.emplace_back(state_of(machine, pose.plate, k));
    if (!nominal_.empty()) {
      state.derived_at = nominal_[k].derived_at;
      state.motions = nominal_[k].motions;
    } else if (keeps_motions_) {
      state.motions = motions_at(state, k);
    }
    if (state.motions && state.motions->jacobian.cols() != source_count()) return nullptr;
  }
  return {answer, &answer->states};
}

StationState Observation::state_of(const DifferentiableMachine& machine, const PlateState& plate,
                                   std::size_t station) const {
  StationState state{plate, machine.rotation_of(plate.slide), &machine, plate.position};
  if (!gap_bases_.empty()) state.gaps = joint_gaps(machine, plate, joints_[station], gap_bases_[station]);
  return state;
}

StationMotions Observation::motions_at(const StationState& state, std::size_t station) const {
  const PlateMotions motions = plate_jacobian(*state.machine, state.plate, joints_[station], moving_);
  if (motions.cols() == 0) return {};
  const auto limbs = static_cast<Eigen::Index>(robot_.limb_count());
  StationMotions all{motions.leftCols(source_count()), motions.rightCols(limbs)};
  if (gap_bases_.empty()) return all;
  std::vector<Eigen::Index> columns;
  for (const SoughtSource& one : moving_) {
    columns.push_back(static_cast<Eigen::Index>(state.machine->parameter(one.limb, one.source)));
  }
  const Eigen::MatrixXd gaps = state.gaps.by_parameter(Eigen::all, columns);
  all.gaps = gaps.leftCols(source_count());
  all.gaps_by_joint = gaps.rightCols(limbs);
  return all;
}

const StationMotions& Observation::motions_of(std::size_t station, const StationState& state,
                                              StationMotions& fresh) const {
  if (state.motions) return *state.motions;
  fresh = motions_at(state, station);
  if (fresh.jacobian.cols() != source_count()) {  // it closes there, but singular: such a reading says nothing
    fresh = {PlateMotions::Zero(7, source_count()),
             PlateMotions::Zero(7, static_cast<Eigen::Index>(robot_.limb_count())),
             Eigen::MatrixXd::Zero(state.gaps.gap.size(), source_count()),
             Eigen::MatrixXd::Zero(state.gaps.gap.size(), static_cast<Eigen::Index>(robot_.limb_count()))};
  }
  return fresh;
}

double reading_noise(const Observation& observation) { return reading_noise(observation, observation.noise()); }

double reading_noise(const Observation& observation, const NoiseOfSeries& noise) {
  const auto& groups = observation.groups();
  const auto quantity_of = [&](const Group& group) { return observation.series_of(group).quantity(); };
  Quantity quantity = Quantity::length;
  for (const Group& group : groups) quantity = std::min(quantity, quantity_of(group));
  double sum = 0.0;
  int count = 0;
  for (const Group& group : groups) {
    if (!group.active || quantity_of(group) != quantity) continue;
    sum += std::pow(observation.sigma_of(group) * Observation::noise_factor(group, noise), 2);
    ++count;
  }
  return std::sqrt(sum / std::max(count, 1));
}

std::optional<double> orientation_noise(const Observation& observation) {
  double sum = 0.0;
  int count = 0;
  for (const Group& group : observation.groups()) {
    if (!group.active || observation.orientation_rows(group) == 0) continue;
    const double sigma = observation.series_of(group).orientation_sigma(group.index);
    sum += std::pow(sigma * observation.noise_factor(group) * observation.orientation_factor(group), 2);
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(std::sqrt(sum / count));
}

RowModel with_priors(const Observation& observation) {
  return [&](const Eigen::VectorXd& unknowns, InformationRoot& root) {
    observation.add_priors(unknowns, root);  // first: on an empty root they cost nothing
    return observation(unknowns, root);
  };
}

}  // namespace paracal::detail

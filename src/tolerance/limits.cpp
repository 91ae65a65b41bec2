#include "limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "numerics/dense.hpp"

namespace paracal::detail {

Limits::Limits(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
               const std::vector<Pose>& poses)
    : robot_(robot),
      tolerances_(tolerances),
      requirements_(requirements),
      response_(robot, characteristics_of(requirements), poses),
      drawing_(robot, response_.linear(), tolerances) {
  for (const Eigen::Index column : drawing_.columns()) {
    const Parameter& one = robot.parameters()[static_cast<std::size_t>(column)];
    errors_.parameters.push_back(one);
    errors_.laws.emplace_back(tolerances, one.source);
  }
}

std::vector<FailureMode> Limits::modes() const {
  std::vector<FailureMode> all;
  const auto poses = static_cast<Eigen::Index>(response_.poses().size());
  for (std::size_t k = 0; k < requirements_.size(); ++k) {
    const int components = component_count(requirements_[k].characteristic.quantity);
    for (Eigen::Index p = 0; p < poses; ++p) {
      const auto rows = Eigen::seqN(response_.first_row(k) + p, components, poses);
      add_modes(drawing_.matrix()(rows, Eigen::all) / requirements_[k].limit, all);
    }
  }
  return all;
}

void Limits::add_modes(const Eigen::MatrixXd& rows, std::vector<FailureMode>& all) const {
  Eigen::VectorXd variances(errors_.size());
  std::ranges::transform(errors_.laws, variances.begin(), [](const auto& law) { return law.std() * law.std(); });
  const Eigen::MatrixXd covariance = product(rows * variances.asDiagonal(), rows.transpose());
  const SymmetricEigen axes = symmetric_eigen(covariance);
  const auto count = static_cast<int>(std::lround(std::pow(3.0, static_cast<double>(rows.rows()))));
  for (int k = 0; k < count; ++k) {  // backwards, not at all or forwards along each axis
    Eigen::VectorXd along(rows.rows());
    for (int j = 0, rest = k; j < rows.rows(); ++j, rest /= 3) along(j) = rest % 3 - 1;
    if (along.isZero(0.0)) continue;
    const Eigen::VectorXd a = product(rows.transpose(), product(axes.vectors, along.normalized()));
    if (std::optional<FailureMode> mode = failure_mode(errors_, a)) all.push_back(std::move(*mode));
  }
}

Eigen::ArrayXd Limits::used_up(const Eigen::MatrixXd& errors) const {
  const Eigen::MatrixXd components = product(drawing_.matrix(), errors);
  Eigen::ArrayXd largest = Eigen::ArrayXd::Zero(errors.cols());
  for (std::size_t k = 0; k < requirements_.size(); ++k) {
    const Eigen::ArrayXd of_this = response_.squared_lengths(k, components).colwise().maxCoeff().sqrt();
    largest = largest.max(of_this / requirements_[k].limit);
  }
  return largest;
}

/// The most used up first, so that what fails is soon found out.
std::vector<Limits::Place> Limits::places_near_limits(const Eigen::VectorXd& errors, double near) const {
  const Eigen::VectorXd components = product(drawing_.matrix(), errors);
  std::vector<Place> places;
  for (std::size_t k = 0; k < requirements_.size(); ++k) {
    const Eigen::ArrayXd used = response_.squared_lengths(k, components).col(0).sqrt() / requirements_[k].limit;
    for (Eigen::Index p = 0; p < used.size(); ++p) {
      if (used(p) > near) places.push_back({used(p), k, static_cast<std::size_t>(p)});
    }
  }
  std::ranges::stable_sort(places, std::greater(), &Place::linear);
  return places;
}

SourceErrors Limits::all_errors(const Eigen::VectorXd& varying, std::uint64_t seed, std::uint64_t stream) const {
  RandomStream random(seed, stream);
  SourceErrors all = draw_errors(robot_, tolerances_, random);
  for (Eigen::Index k = 0; k < varying.size(); ++k) {
    const Parameter& one = errors_.parameters[static_cast<std::size_t>(k)];
    all(one.limb, one.source) = varying(k);
  }
  return all;
}

Limits::Trial Limits::try_exactly(const Eigen::VectorXd& errors, double near, std::uint64_t seed,
                                  std::uint64_t stream) const {
  const SourceErrors all = all_errors(errors, seed, stream);
  std::array<std::optional<SentMachine>, 2> sent;  // as it is, and compensated
  for (const auto& [linear, requirement, pose] : places_near_limits(errors, near)) {
    const Requirement& wanted = requirements_[requirement];
    std::optional<SentMachine>& machine = sent[wanted.characteristic.compensated ? 1 : 0];
    if (!machine) machine.emplace(robot_, all, wanted.characteristic.compensated);
    const std::optional<Reached> reached = machine->at(response_.poses()[pose]);
    if (!reached) return {.fails = true, .closes = false, .linear = linear};
    const double value = exact_components(robot_, *reached, wanted.characteristic.quantity).norm();
    if (value > wanted.limit) return {.fails = true, .linear = linear};
  }
  return {};
}

}  // namespace paracal::detail

#include "heights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "median.hpp"

namespace paracal::detail {

Heights::Heights(const HeightSeries& plane, const CalibrationOptions& options)
    : ReadingSeries(plane.name), readings_(plane.readings), options_(options) {}

Group Heights::group(std::size_t index) const {
  const HeightReading& reading = readings_[index];
  return {.station = static_cast<std::uint32_t>(reading.station), .stated = reading.sigma.has_value()};
}

double Heights::sigma(std::size_t index) const { return readings_[index].sigma.value_or(options_.noise.height); }

void Heights::take_columns(Eigen::Index& next, bool /*seeks_scale: heights are too short to show any*/) {
  plane_ = take(next, 3);
}

void Heights::start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) {
  std::vector<Eigen::Vector3d> levels;
  for (const HeightReading& reading : readings_) {
    levels.emplace_back(0.0, 0.0, stations[reading.station].plate.position.z() - reading.height);
  }
  if (!levels.empty()) unknowns(plane_) = median(levels).z();
}

void Heights::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (!options_.plane_slope) return;
  root.add_prior(plane_ + 1, unknowns(plane_ + 1), 0.0, *options_.plane_slope);
  root.add_prior(plane_ + 2, unknowns(plane_ + 2), 0.0, *options_.plane_slope);
}

ByPlate Heights::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const Eigen::Vector3d& r = at.stations[readings_[index].station].plate.position;
  const double sigma = this->sigma(index);
  block.setZero(1, at.unknowns.size() + 1);
  block.block<1, 3>(0, plane_) << -1.0, -r.x(), -r.y();
  block(0, at.unknowns.size()) = residual(index, at).length(0);
  block /= sigma;
  ByPlate by_plate = ByPlate::Zero(1, 7);
  by_plate.leftCols<3>() = Eigen::RowVector3d(-at.unknowns(plane_ + 1), -at.unknowns(plane_ + 2), 1.0) / sigma;
  return by_plate;
}

Residual Heights::residual(std::size_t index, const Placed& at) const {
  const HeightReading& reading = readings_[index];
  const Eigen::Vector3d& r = at.stations[reading.station].plate.position;
  const double level = at.unknowns.segment<3>(plane_).dot(Eigen::Vector3d(1.0, r.x(), r.y()));
  return {Eigen::Matrix<double, 1, 1>(r.z() - level - reading.height)};
}

std::string Heights::label(std::size_t index, const std::vector<Station>& stations) const {
  return fmt::format("height {} of {}", stations[readings_[index].station].name, name());
}

void Heights::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  for (const Group& group : of_series) {
    if (!group.active) continue;
    tally.heights += std::pow(residual(group.index, at).length(0), 2);
    ++tally.height_count;
  }
}

void Heights::list(const Group& group, const std::vector<Station>& stations, const Residual& before,
                   const Residual& after, Calibration& calibration) const {
  calibration.heights.push_back({name(), stations[group.station].name, readings_[group.index].height, before.length(0),
                                 after.length(0), !group.active});
}

void Heights::state_setup(const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& covariance,
                          Calibration& calibration) const {
  FoundPlane plane{name(), unknowns(plane_), unknowns(plane_ + 1), unknowns(plane_ + 2)};
  if (covariance.size() > 0) {
    const auto rows = covariance.middleRows<3>(plane_);
    const auto errors = std::ranges::count(calibration.parameters, false, &ParameterEstimate::held);
    plane.covariance.resize(3, 3 + errors);
    plane.covariance << rows.middleCols<3>(plane_), rows.rightCols(errors);
  }
  calibration.planes.push_back(std::move(plane));
}

}  // namespace paracal::detail

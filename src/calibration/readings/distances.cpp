#include "distances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace paracal::detail {

Distances::Distances(const std::vector<DistanceReading>& readings, const CalibrationOptions& options)
    : ReadingSeries("distances"), readings_(readings), options_(options) {}

Group Distances::group(std::size_t index) const {
  const DistanceReading& reading = readings_[index];
  return {.station = static_cast<std::uint32_t>(reading.to),
          .from = static_cast<std::uint32_t>(reading.from),
          .stated = reading.distance_sigma.has_value() && !reading.rotation};
}

double Distances::sigma(std::size_t index) const {
  return readings_[index].distance_sigma.value_or(options_.noise.distance);
}

void Distances::take_columns(Eigen::Index& next, bool seeks_scale) {
  if (options_.noise.distance_bias > 0.0) bias_ = take(next, 1);
  if (seeks_scale) scale_ = take(next, 1);
}

void Distances::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  if (bias_ >= 0) root.add_prior(bias_, unknowns(bias_), 0.0, options_.noise.distance_bias);
  if (scale_ >= 0) root.add_prior(scale_, unknowns(scale_), 0.0, options_.scale_std);
}

ByPlate Distances::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const DistanceReading& reading = readings_[index];
  const StationState &from = at.stations[reading.from], &to = at.stations[reading.to];
  const double sigma = this->sigma(index);
  const Residual residual = this->residual(index, at);
  const Eigen::Index last = at.unknowns.size();
  block.setZero(reading.rotation ? 2 : 1, last + 1);
  ByPlate by_plate = ByPlate::Zero(block.rows(), 7);
  // A derivative kept at the nominal machine needs the direction there, too: otherwise turns of the whole robot, which
  // no distance sees, become weakly visible, and an undamped step along them is wild.
  const Eigen::Vector3d direction = to.derived_at - from.derived_at;
  by_plate.block<1, 3>(0, 0) = scale(at.unknowns) * direction.normalized().transpose() / sigma;
  if (bias_ >= 0) block(0, bias_) = 1.0 / sigma;
  if (scale_ >= 0) block(0, scale_) = (to.plate.position - from.plate.position).norm() / sigma;
  block(0, last) = residual.length(0) / sigma;
  if (!reading.rotation) return by_plate;
  by_plate(1, 3) = 1.0 / options_.noise.rotation;
  block(1, last) = *residual.rotation / options_.noise.rotation;
  return by_plate;
}

Residual Distances::residual(std::size_t index, const Placed& at) const {
  const DistanceReading& reading = readings_[index];
  const StationState &from = at.stations[reading.from], &to = at.stations[reading.to];
  const double length = (to.plate.position - from.plate.position).norm();
  const double read = scale(at.unknowns) * length + bias(at.unknowns).value_or(0.0);
  Residual residual{Eigen::Matrix<double, 1, 1>(read - reading.distance)};
  if (reading.rotation) residual.rotation = to.rotation - from.rotation - *reading.rotation;
  return residual;
}

std::optional<double> Distances::bias(const Eigen::VectorXd& unknowns) const {
  return bias_ < 0 ? std::nullopt : std::optional(unknowns(bias_));
}

std::string Distances::label(std::size_t index, const std::vector<Station>& stations) const {
  const DistanceReading& reading = readings_[index];
  return fmt::format("distance {} - {}", stations[reading.from].name, stations[reading.to].name);
}

void Distances::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  for (const Group& group : of_series) {
    if (!group.active) continue;
    const Residual residual = this->residual(group.index, at);
    const double off = residual.length(0);
    tally.summary.max_abs_distance = std::max(tally.summary.max_abs_distance, std::abs(off));
    tally.widen_rotation(residual.rotation);
    tally.distances.add(off);
  }
}

void Distances::list(const Group& group, const std::vector<Station>& stations, const Residual& before,
                     const Residual& after, FitResiduals& all) const {
  const DistanceReading& reading = readings_[group.index];
  all.distances.push_back({stations[reading.from].name, stations[reading.to].name, reading.distance, before.length(0),
                           after.length(0), reading.rotation, before.rotation, after.rotation, !group.active});
}

void Distances::add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& /*remarks*/) const {
  all.distance_bias = bias(found.values);
  if (bias_ >= 0 && found.covariance.size() > 0) all.distance_bias_std = std::sqrt(found.covariance(bias_, bias_));
}

}  // namespace paracal::detail

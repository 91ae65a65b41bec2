#include "lengths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace paracal::detail {

Lengths::Lengths(const LengthSeries& series, const CalibrationOptions& options)
    : ReadingSeries(series.name), series_(series), model_(length_model(series.kind)), options_(options) {}

Group Lengths::group(std::size_t index) const {
  const LengthReading& reading = series_.readings[index];
  return {.station = static_cast<std::uint32_t>(reading.station), .stated = reading.sigma.has_value()};
}

double Lengths::sigma(std::size_t index) const {
  return series_.readings[index].sigma.value_or(options_.noise.*words(series_.kind).sigma);
}

void Lengths::take_columns(Eigen::Index& next, bool seeks_scale) {
  count_ = model_.units(options_).size();
  first_ = take(next, count_);
  if (seeks_scale && model_.shows_scale()) scale_ = take(next, 1);
}

void Lengths::start(const std::vector<StationState>& stations, Eigen::VectorXd& unknowns) {
  LengthsRead read;
  for (const LengthReading& reading : series_.readings) {
    read.places.push_back(stations[reading.station].plate.position);
    read.lengths.push_back(reading.length);
  }
  StartedSetUp started = model_.start(read, series_, options_);
  unknowns.segment(first_, count_) = started.unknowns;
  assumed_ = std::move(started.assumed);
}

void Lengths::add_priors(const Eigen::VectorXd& unknowns, InformationRoot& root) const {
  model_.add_priors(unknowns, first_, options_, root);
  if (scale_ >= 0) root.add_prior(scale_, unknowns(scale_), 0.0, options_.scale_std);
}

void Lengths::set_units(Eigen::VectorXd& unit) const { unit.segment(first_, count_) = model_.units(options_); }

LengthShown Lengths::shown(std::size_t index, const Placed& at) const {
  const Eigen::Vector3d& place = at.stations[series_.readings[index].station].plate.position;
  return model_.shown(place, set_up(at.unknowns), series_);
}

ByPlate Lengths::rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const {
  const LengthShown shown = this->shown(index, at);
  const double sigma = this->sigma(index), longer = scale(at.unknowns);
  block.setZero(1, at.unknowns.size() + 1);
  block.middleCols(first_, count_) = longer * shown.by_set_up;
  if (scale_ >= 0) block(0, scale_) = shown.length;
  block(0, at.unknowns.size()) = longer * shown.length - series_.readings[index].length;
  block /= sigma;
  ByPlate by_plate = ByPlate::Zero(1, 7);
  by_plate.leftCols<3>() = longer * shown.by_place / sigma;
  return by_plate;
}

Residual Lengths::residual(std::size_t index, const Placed& at) const {
  const double read = scale(at.unknowns) * shown(index, at).length;
  return {Eigen::Matrix<double, 1, 1>(read - series_.readings[index].length)};
}

std::string Lengths::label(std::size_t index, const std::vector<Station>& stations) const {
  return fmt::format("{} {} of {}", words(series_.kind).noun, stations[series_.readings[index].station].name, name());
}

void Lengths::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  ErrorTally::Sum& sum = tally.lengths[series_.kind];
  for (const Group& group : of_series) {
    if (group.active) sum.add(residual(group.index, at).length(0));
  }
}

void Lengths::list(const Group& group, const std::vector<Station>& stations, const Residual& before,
                   const Residual& after, FitResiduals& all) const {
  all.lengths.push_back({name(), stations[group.station].name, series_.kind, series_.readings[group.index].length,
                         before.length(0), after.length(0), !group.active});
}

void Lengths::add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& remarks) const {
  FoundSetUp own{name(), series_.kind, set_up(found.values), {}, model_.told(set_up(found.values), series_)};
  if (found.covariance.size() > 0) {
    const auto rows = found.covariance.middleRows(first_, count_);
    own.covariance.resize(count_, count_ + found.errors);
    own.covariance << rows.middleCols(first_, count_), rows.rightCols(found.errors);
  }
  all.set_ups.push_back(std::move(own));
  if (!assumed_.empty()) remarks.assumed.push_back(assumed_);
}

}  // namespace paracal::detail

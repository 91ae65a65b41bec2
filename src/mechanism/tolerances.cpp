#include "paracal/mechanism/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "paracal/mechanism/robot.hpp"
#include "paracal/units.hpp"

namespace paracal {

void Tolerances::state(Source source, double value) {
  half_width[source] = value;
  measured[source].clear();
  origin[source] = Origin::stated;
}

double Tolerances::mean(Source source) const {
  const std::vector<double>& values = measured[source];
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Tolerances::largest(Source source) const {
  double largest = half_width[source];
  if (largest > 0.0) return largest;
  for (const double value : measured[source]) largest = std::max(largest, std::abs(value));
  return largest;
}

double Tolerances::std(Source source) const {
  if (const std::vector<double>& values = measured[source]; !values.empty()) {
    const double centre = mean(source);
    double squares = 0.0;
    for (const double value : values) squares += (value - centre) * (value - centre);
    return std::sqrt(squares / static_cast<double>(values.size()));
  }
  constexpr double kTruncated = 0.98658;  // of a standard normal variable within +-3
  const double half = half_width[source];
  switch (distribution) {
    case Distribution::normal:
      return half / 3.0;
    case Distribution::uniform:
      return half / std::numbers::sqrt3;
    case Distribution::truncated_normal:
      return kTruncated * half / 3.0;
  }
  return 0.0;
}

namespace {

/// The coordinates of a point share one tolerance; two of them, and what the actuator does not feel, say nothing new.
bool speaks_for_itself(Source source, Actuator actuator) { return is_leading(source) && is_felt(source, actuator); }

/// "theta_offset 1.5 deg, e 3 mm": sources of one origin, with their half-widths where these are not zero by
/// definition.
std::string listed(const Tolerances& tolerances, Origin origin, Actuator actuator) {
  std::string text;
  for (const Source source : sources_of(actuator)) {
    if (tolerances.origin[source] != origin || !speaks_for_itself(source, actuator)) continue;
    text.append(text.empty() ? "" : ", ").append(shared_name(source));
    if (origin == Origin::exact) continue;
    const Unit inside = unit(source, actuator);
    text += fmt::format(" {:.3g} {}", to_file_unit(inside, tolerances[source]), file_unit(inside));
  }
  return text;
}

}  // namespace

void list_assumed(Tolerances& tolerances, Actuator actuator) {
  tolerances.assumed.clear();
  const std::string generous = listed(tolerances, Origin::generous, actuator);
  const std::string exact = listed(tolerances, Origin::exact, actuator);
  if (!generous.empty()) {
    tolerances.assumed.push_back("default tolerances (half-widths; set yours with --tolerances): " + generous);
  }
  if (!exact.empty())
    tolerances.assumed.push_back("tolerances set to zero because the table does not list them: " + exact);
}

namespace {

/// Spherical joints bolted on, arms on splines, and a drive whose pitch the catalogue says.
double generous_of_single_rod(Source source, Actuator actuator) {
  switch (unit(source, actuator)) {
    case Unit::rad:
      return to_radians(source == joint_zero(actuator) ? 1.5 : 1.0);
    case Unit::mm_per_m:
      return 15.0;
    default:
      return 3.0;
  }
}

Tolerances generous_single_rods(Actuator actuator) {
  Tolerances tolerances;
  tolerances.origin.values.fill(Origin::exact);
  for (const Source source : sources_of(actuator)) {
    tolerances[source] = generous_of_single_rod(source, actuator);
    tolerances.origin[source] = Origin::generous;
  }
  list_assumed(tolerances, actuator);
  return tolerances;
}

}  // namespace

/// Of a rail's drive, mm/m: the pitch of a toothed belt is to 0.5 mm/m, a rolled screw of class T10 to 0.7 mm/m.
constexpr double kGenerousGain = 1.0;

Tolerances generous_tolerances(const Geometry& geometry) {
  if (on_single_rods(geometry.actuator)) return generous_single_rods(geometry.actuator);
  const double parallelogram_width = geometry.parallelogram_width;
  Tolerances tolerances;
  tolerances["theta_offset"] = geometry.actuator == Actuator::linear ? 3.0 : to_radians(1.5);
  tolerances["e_x"] = tolerances["e_y"] = tolerances["e_z"] = 3.0;
  tolerances["arm_length"] = 0.8;
  if (geometry.actuator == Actuator::linear) tolerances["gain"] = kGenerousGain;
  tolerances["alpha0"] = tolerances["beta0"] = to_radians(0.3);
  tolerances["rod_mean"] = 2.4;
  tolerances["rod_difference"] = 0.22e-3 * parallelogram_width;
  tolerances["width_difference"] = 0.90e-3 * parallelogram_width;
  tolerances["alpha03"] = 0.26e-3;
  tolerances["beta03"] = 0.52e-3;
  tolerances["alpha2"] = 0.25e-3;
  tolerances["beta2"] = 0.84e-3;
  tolerances.origin.values.fill(Origin::generous);
  list_assumed(tolerances, geometry.actuator);
  return tolerances;
}

}  // namespace paracal

#include "paracal/mechanism/tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string_view>

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

/// "theta_offset 1.5 deg, e 3 mm": sources of one origin, with their half-widths where these are not zero by
/// definition. The coordinates of a point share one tolerance.
std::string listed(const Tolerances& tolerances, Origin origin, const Limbs& limbs) {
  std::string text;
  for (const Source source : sources_of(limbs)) {
    if (tolerances.origin[source] != origin || !is_leading(source)) continue;
    text.append(text.empty() ? "" : ", ").append(shared_name(source));
    if (origin == Origin::exact) continue;
    const Unit inside = unit(source, actuator_of(limbs));
    text += fmt::format(" {:.3g} {}", to_file_unit(inside, tolerances[source]), file_unit(inside));
  }
  return text;
}

}  // namespace

void list_assumed(Tolerances& tolerances, const Limbs& limbs) {
  tolerances.assumed.clear();
  const std::string generous = listed(tolerances, Origin::generous, limbs);
  const std::string exact = listed(tolerances, Origin::exact, limbs);
  if (!generous.empty()) {
    tolerances.assumed.push_back("default tolerances (half-widths; set yours with --tolerances): " + generous);
  }
  if (!exact.empty())
    tolerances.assumed.push_back("tolerances set to zero because the table does not list them: " + exact);
}

namespace {

/// Spherical joints bolted on, arms on splines, and a drive whose pitch the catalogue says.
double generous_of_one_rod(Source source, Actuator kind) {
  switch (unit(source, kind)) {
    case Unit::rad:
      return to_radians(is_joint_zero(source) ? 1.5 : 1.0);
    case Unit::mm_per_m:
      return 15.0;
    default:
      return 3.0;
  }
}

/// An eccentric coupling or disk: a tenth of a mm or of a degree, but no more than a screw of a fine thread may wobble.
double generous_of_turn(const LimbDescription& limb) {
  constexpr double kOfPitch = 0.02;  // both together stay below kSteepestDrive
  return std::min(joint_unit(limb.kind) == Unit::rad ? to_radians(0.1) : 0.1, kOfPitch * limb.pitch);
}

/// @param width  of the parallelogram, mm. The pitch of a toothed belt is to 0.5 mm/m, a rolled screw of class T10 to
///               0.7 mm/m.
double generous_of_parallelogram(Source source, Actuator kind, double width) {
  if (is_joint_zero(source)) return generous_of_one_rod(source, kind);
  static const std::map<std::string_view, double> kGenerous{{"e_x", 3.0},
                                                            {"e_y", 3.0},
                                                            {"e_z", 3.0},
                                                            {"arm_length", 0.8},
                                                            {"gain", 1.0},
                                                            {"alpha0", to_radians(0.3)},
                                                            {"beta0", to_radians(0.3)},
                                                            {"rod_mean", 2.4},
                                                            {"rod_difference", 0.22e-3},
                                                            {"width_difference", 0.90e-3},
                                                            {"alpha03", 0.26e-3},
                                                            {"beta03", 0.52e-3},
                                                            {"alpha2", 0.25e-3},
                                                            {"beta2", 0.84e-3}};
  const bool over_width = tilts_plate(source) && source.unit() == Unit::mm;
  return kGenerous.at(source.name()) * (over_width ? width : 1.0);
}

}  // namespace

Tolerances generous_tolerances(const Limbs& limbs) {
  Tolerances tolerances;
  tolerances.origin.values.fill(Origin::exact);
  const double width = sizes_of(limbs).parallelogram_width;
  for (const LimbDescription& limb : limbs) {
    const Actuator kind = limb.kind;
    for (const Source source : sources_of(kind)) {
      const double half_width = is_harmonic(source)    ? generous_of_turn(limb)
                                : on_single_rods(kind) ? generous_of_one_rod(source, kind)
                                                       : generous_of_parallelogram(source, kind, width);
      tolerances[source] = std::max(tolerances[source], half_width);
      tolerances.origin[source] = Origin::generous;
    }
  }
  list_assumed(tolerances, limbs);
  return tolerances;
}

}  // namespace paracal

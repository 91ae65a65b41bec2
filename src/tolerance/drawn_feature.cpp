#include "paracal/tolerance/drawn_feature.hpp"

#include <algorithm>
#include <array>

namespace paracal {
namespace {

using Kind = DrawnFeature::Kind;
using enum Orientation;

constexpr double kUnknownLength = 100.0;  // as drawings state orientations: 0.02/100

DrawnFeature size_of(std::string_view name, bool is_of_pairs = false) {
  return {.kind = Kind::size, .name = name, .is_of_pairs = is_of_pairs};
}

DrawnFeature place_of(std::string_view name) { return {.kind = Kind::place, .name = name}; }

DrawnFeature turn_of(std::string_view name, std::vector<DrawnFeature::Datum> data) {
  return {.kind = Kind::turn, .name = name, .data = std::move(data)};
}

DrawnFeature nothing(std::string_view why) { return {.name = why}; }

/// Its axis may lie at any angle, so that any orientation may be meant.
std::vector<DrawnFeature::Datum> of_any_angle() {
  constexpr std::string_view kBase = "the base's datum";
  return {{angularity, kBase}, {parallelism, kBase}, {perpendicularity, kBase}};
}

struct FeatureOfLimbs {
  std::vector<Actuator> limbs;
  Source source;
  DrawnFeature feature;
};

/// What a drawing has of each source error; a point is listed by its first coordinate.
const std::vector<FeatureOfLimbs>& features() {
  constexpr Actuator revolute = Actuator::revolute, linear = Actuator::linear, strut = Actuator::strut,
                     crank = Actuator::crank, carriage = Actuator::carriage;
  constexpr std::string_view kPlane = "the base plane", kPlate = "bar at the plate", kCarriage = "bar on the carriage",
                             kElbow = "bar at the elbow", kMotor = "motor axis",
                             kRadial = "the limb's radial direction", kDatum = "the base's datum";
  static const std::vector<FeatureOfLimbs> kFeatures{
      {{revolute}, "theta_offset", nothing("an encoder's zero is set on the machine")},
      {{linear}, "theta_offset", nothing("an endstop is set on the machine")},
      {{strut}, "zero", size_of("joint distance of the strut at joint coordinate 0")},
      {{crank, carriage}, "zero", nothing("a drive's zero is set on the machine")},
      {{revolute}, "e_x", place_of("base joint")},
      {{linear}, "e_x", place_of("foot of the rail")},
      {{strut}, "base_x", place_of("joint at the base")},
      {{crank}, "base_x", place_of("centre of the arm's circle")},
      {{carriage}, "normal", place_of("rail")},
      {{carriage}, "across", place_of("rail")},
      {{revolute, crank}, "arm_length", size_of("bore distance of the arm")},
      {{linear, strut, carriage}, "gain", nothing("the lead error follows from the drive's accuracy class, in mm/m")},
      {{revolute}, "alpha0", turn_of(kMotor, {{parallelism, kPlane}})},
      {{revolute}, "beta0", turn_of(kMotor, {{perpendicularity, kRadial}, {angularity, kDatum}})},
      {{linear},
       "alpha0",
       turn_of("rail", {{perpendicularity, "the base plane, seen radially"},
                        {parallelism, "the robot's axis, seen radially"},
                        {angularity, "the base plane, seen radially"}})},
      {{linear},
       "beta0",
       turn_of("rail", {{perpendicularity, "the base plane, seen from the side"},
                        {parallelism, "the robot's axis, seen from the side"},
                        {angularity, "the base plane, seen from the side"}})},
      {{crank}, "alpha0", turn_of(kMotor, of_any_angle())},
      {{crank}, "beta0", turn_of(kMotor, of_any_angle())},
      {{carriage}, "alpha0", turn_of("rail", of_any_angle())},
      {{carriage}, "beta0", turn_of("rail", of_any_angle())},
      {{revolute, linear}, "rod_mean", size_of("joint distance of each rod")},
      {{revolute, linear}, "rod_difference", size_of("joint distance of both rods", true)},
      {{revolute, linear}, "width_difference", size_of("joint distance on both bars", true)},
      {{revolute, linear}, "alpha03", turn_of(kPlate, {{parallelism, "the bar at the elbow, seen radially"}})},
      {{revolute, linear},
       "beta03",
       turn_of(kPlate, {{perpendicularity, kRadial},
                        {parallelism, "the bar at the elbow, seen from above"},
                        {angularity, "the plate's datum"}})},
      {{revolute}, "alpha2", turn_of(kElbow, {{parallelism, "the motor axis, seen along the arm"}})},
      {{revolute},
       "beta2",
       turn_of(kElbow, {{perpendicularity, "the arm"}, {parallelism, "the motor axis, seen square to the arm"}})},
      {{linear}, "alpha2", turn_of(kCarriage, {{perpendicularity, "the rail"}, {parallelism, kPlane}})},
      {{linear}, "beta2", turn_of(kCarriage, {{perpendicularity, kRadial}, {angularity, kDatum}})},
      {{strut, crank, carriage}, "rod_length", size_of("joint distance of the rod")},
      {{strut, crank, carriage}, "plate_x", place_of("joint at the plate")},
  };
  return kFeatures;
}

DrawnFeature feature_of(Source source, const std::vector<Actuator>& kinds) {
  const auto is_alike = [](Actuator one, Actuator other) { return one.drive == other.drive && one.rods == other.rods; };
  const auto found = std::ranges::find_if(features(), [&](const FeatureOfLimbs& one) {
    return one.source == source && std::ranges::find_first_of(one.limbs, kinds, is_alike) != one.limbs.end();
  });
  return found == features().end() ? nothing("no drawing shows it") : found->feature;
}

double size_of(Source source, const LimbDescription& limb) {
  if (source == "width_difference") return limb.width;
  return source == "arm_length" ? limb.arm : limb.length;
}

std::vector<double> sizes_of(Source source, const Limbs& limbs) {
  std::vector<double> sizes;
  for (const LimbDescription& limb : limbs) {
    if (has(limb.kind, source)) sizes.push_back(size_of(source, limb));
  }
  std::ranges::sort(sizes);
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  return sizes;
}

}  // namespace

std::string_view name(Orientation orientation) {
  static constexpr std::array<std::string_view, 3> kNames{"parallelism", "perpendicularity", "angularity"};
  return kNames[static_cast<std::size_t>(orientation)];
}

DrawnFeature drawn_feature(Source source, const Limbs& limbs) {
  DrawnFeature feature = feature_of(sharing(source, limbs).front(), kinds_of(limbs));
  if (feature.kind == Kind::size) feature.sizes = sizes_of(source, limbs);
  // The bars' joints are the parallelogram's width apart.
  feature.length = tilts_plate(source) ? paracal::sizes_of(limbs).parallelogram_width : kUnknownLength;
  return feature;
}

}  // namespace paracal

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

/// What limbs on arms and on rails share.
DrawnFeature of_parallelogram(Source source) {
  switch (source) {
    case Source::rod_mean:
      return size_of("joint distance of each rod");
    case Source::rod_difference:
      return size_of("joint distance of both rods", true);
    case Source::width_difference:
      return size_of("joint distance on both bars", true);
    case Source::alpha03:
      return turn_of("bar at the plate", {{parallelism, "the bar at the elbow, seen radially"}});
    default:
      return turn_of("bar at the plate", {{perpendicularity, "the limb's radial direction"},
                                          {parallelism, "the bar at the elbow, seen from above"},
                                          {angularity, "the plate's datum"}});
  }
}

DrawnFeature lead_of_a_drive() { return nothing("the lead error follows from the drive's accuracy class, in mm/m"); }

/// An arm that a motor swings, with a parallelogram.
DrawnFeature of_arm(Source source) {
  switch (source) {
    case Source::theta_offset:
      return nothing("an encoder's zero is set on the machine");
    case Source::e_x:
      return place_of("base joint");
    case Source::arm_length:
      return size_of("bore distance of the arm");
    case Source::alpha0:
      return turn_of("motor axis", {{parallelism, "the base plane"}});
    case Source::beta0:
      return turn_of("motor axis",
                     {{perpendicularity, "the limb's radial direction"}, {angularity, "the base's datum"}});
    case Source::alpha2:
      return turn_of("bar at the elbow", {{parallelism, "the motor axis, seen along the arm"}});
    case Source::beta2:
      return turn_of("bar at the elbow",
                     {{perpendicularity, "the arm"}, {parallelism, "the motor axis, seen square to the arm"}});
    default:
      return of_parallelogram(source);
  }
}

/// How a rail leans sideways, or in and out.
DrawnFeature upright_rail(Source source) {
  if (source == Source::alpha0) {
    return turn_of("rail", {{perpendicularity, "the base plane, seen radially"},
                            {parallelism, "the robot's axis, seen radially"},
                            {angularity, "the base plane, seen radially"}});
  }
  return turn_of("rail", {{perpendicularity, "the base plane, seen from the side"},
                          {parallelism, "the robot's axis, seen from the side"},
                          {angularity, "the base plane, seen from the side"}});
}

/// A rail with a parallelogram.
DrawnFeature of_rail(Source source) {
  switch (source) {
    case Source::theta_offset:
      return nothing("an endstop is set on the machine");
    case Source::e_x:
      return place_of("foot of the rail");
    case Source::gain:
      return lead_of_a_drive();
    case Source::alpha0:
    case Source::beta0:
      return upright_rail(source);
    case Source::alpha2:
      return turn_of("bar on the carriage", {{perpendicularity, "the rail"}, {parallelism, "the base plane"}});
    case Source::beta2:
      return turn_of("bar on the carriage",
                     {{perpendicularity, "the limb's radial direction"}, {angularity, "the base's datum"}});
    default:
      return of_parallelogram(source);
  }
}

/// What all limbs with one rod share.
DrawnFeature of_single_rod(Source source) {
  switch (source) {
    case Source::gain:
      return lead_of_a_drive();
    case Source::rod_length:
      return size_of("joint distance of the rod");
    case Source::plate_x:
      return place_of("joint at the plate");
    default:
      return nothing("a drive's zero is set on the machine");
  }
}

DrawnFeature of_strut(Source source) {
  if (source == Source::theta_offset) return size_of("joint distance of the strut at joint coordinate 0");
  return source == Source::e_x ? place_of("joint at the base") : of_single_rod(source);
}

/// Its axis may lie at any angle, so that any orientation may be meant.
std::vector<DrawnFeature::Datum> of_any_angle() {
  constexpr std::string_view kBase = "the base's datum";
  return {{angularity, kBase}, {parallelism, kBase}, {perpendicularity, kBase}};
}

DrawnFeature of_crank(Source source) {
  switch (source) {
    case Source::e_x:
      return place_of("centre of the arm's circle");
    case Source::arm_length:
      return size_of("bore distance of the arm");
    case Source::alpha0:
    case Source::beta0:
      return turn_of("motor axis", of_any_angle());
    default:
      return of_single_rod(source);
  }
}

DrawnFeature of_carriage(Source source) {
  switch (source) {
    case Source::normal:
    case Source::across:
      return place_of("rail");
    case Source::alpha0:
    case Source::beta0:
      return turn_of("rail", of_any_angle());
    default:
      return of_single_rod(source);
  }
}

DrawnFeature feature_of(Source source, Actuator actuator) {
  switch (actuator) {
    case Actuator::linear:
      return of_rail(source);
    case Actuator::strut:
      return of_strut(source);
    case Actuator::crank:
      return of_crank(source);
    case Actuator::carriage:
      return of_carriage(source);
    default:
      return of_arm(source);
  }
}

/// The first of a point's coordinates; else the source itself.
Source leading(Source source, Actuator actuator) {
  return static_cast<Source>(index(source) - coordinate(source, actuator).value_or(0));
}

double single_rod_size(Source source, const SingleRod& limb) {
  return source == Source::arm_length ? limb.arm : limb.length;
}

double level_size(Source source, const Geometry& geometry, const SourceErrors& intended, std::size_t limb) {
  if (source == Source::width_difference) return geometry.parallelogram_width;
  if (source == Source::arm_length) return geometry.arm + intended(limb, source);
  return geometry.rod + intended(limb, Source::rod_mean);
}

std::vector<double> sizes_of(Source source, const Geometry& geometry, const SourceErrors& intended) {
  std::vector<double> sizes;
  for (const SingleRod& limb : geometry.single_rods) sizes.push_back(single_rod_size(source, limb));
  // A geometry may not have been checked yet.
  const std::size_t alike = std::clamp<std::size_t>(geometry.limb_azimuth.size(), 1, kMaxLimbs);
  for (std::size_t limb = 0; geometry.single_rods.empty() && limb < alike; ++limb) {
    sizes.push_back(level_size(source, geometry, intended, limb));
  }
  std::ranges::sort(sizes);
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  return sizes;
}

bool is_of_parallelogram(Source source, Actuator actuator) {
  return tilts_plate(source, actuator);  // the bars, whose joints are its width apart
}

}  // namespace

std::string_view name(Orientation orientation) {
  static constexpr std::array<std::string_view, 3> kNames{"parallelism", "perpendicularity", "angularity"};
  return kNames[static_cast<std::size_t>(orientation)];
}

DrawnFeature drawn_feature(Source source, const Geometry& geometry, const SourceErrors& intended) {
  DrawnFeature feature = feature_of(leading(source, geometry.actuator), geometry.actuator);
  if (feature.kind == Kind::size) feature.sizes = sizes_of(source, geometry, intended);
  feature.length = is_of_parallelogram(source, geometry.actuator) ? geometry.parallelogram_width : kUnknownLength;
  return feature;
}

}  // namespace paracal

#include "paracal/io/machine_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "code_words.hpp"
#include "controller_text.hpp"
#include "marlin_configuration.hpp"
#include "paracal/error.hpp"
#include "paracal/printer/plausibility.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::array<double, 3> kDesignAngles{210.0, 330.0, 90.0};  // deg
constexpr std::array<char, 3> kTowers{'X', 'Y', 'Z'}, kTrims{'A', 'B', 'C'};
constexpr std::string_view kLinear = "M665", kEndstops = "M666", kRotary = "M669";

/// Letters of a code in a dialect.
std::string_view letters_of(std::string_view code, CodeDialect dialect) {
  const bool marlin = dialect == CodeDialect::marlin;
  if (code == kLinear) return marlin ? "LRHSXYZABC" : "LRHBXYZSTD";
  if (code == kEndstops) return marlin ? "XYZ" : "XYZAB";
  return "KULRBHAXYZST";
}

using Three = std::array<double, 3>;

/// Of the towers X, Y and Z; 0 where there is none.
Three towers_of(const CodeWords& code) {
  return {code.number_or(kTowers[0], 0.0), code.number_or(kTowers[1], 0.0), code.number_or(kTowers[2], 0.0)};
}

/// RepRapFirmware's bed that slopes in its coordinates, in percent.
void refuse_tilt(const CodeWords& endstops, CodeDialect dialect) {
  if (dialect == CodeDialect::marlin) return;
  for (const char letter : {'A', 'B'}) {
    const double tilt = endstops.number_or(letter, 0.0);
    if (tilt == 0.0) continue;
    endstops.fail(
        letter,
        fmt::format("expected M666 without bed tilt, got {}{}: level the bed, or remove the tilt and measure again",
                    letter, tilt));
  }
}

DeltaGeometry checked(const CodeWords& code, const DeltaGeometry& geometry) {
  const std::vector<std::string> complaints = implausible(geometry);
  if (complaints.empty()) return geometry;
  code.fail(fmt::format("expected a possible delta, got one where {}", complaints.front()));
}

void turn_towers(const CodeWords& code, DeltaGeometry& geometry) {
  constexpr double kWholeTurn = 360.0;
  const Three turned = towers_of(code);
  for (const double angle : turned) {
    if (std::abs(angle) > kWholeTurn) code.fail(fmt::format("expected tower angles up to 360 deg, got {}", angle));
  }
  for (std::size_t i = 0; i < 3; ++i) geometry.tower_angle[i] = to_radians(kDesignAngles[i] + turned[i]);
}

/// Height of the nozzle with all carriages at 0.
double nozzle_below(DeltaGeometry geometry) {
  for (std::size_t i = 0; i < 3; ++i) geometry.endstop[i] = endstop_of(geometry, i, 0.0);
  const auto place = nozzle(geometry, {0.0, 0.0, 0.0});
  return place ? place->z() : std::nan("");
}

DeltaGeometry linear_delta(const TextFile& file, CodeDialect dialect) {
  const CodeWords code(file, kLinear, letters_of(kLinear, dialect));
  const CodeWords endstops(file, kEndstops, letters_of(kEndstops, dialect));
  refuse_tilt(endstops, dialect);
  DeltaGeometry geometry{.actuator = Actuator::linear};
  geometry.rod = code.one_or_three('L', "length of the rods");
  if (dialect == CodeDialect::marlin) {
    for (std::size_t i = 0; i < 3; ++i) geometry.rod[i] += code.number_or(kTrims[i], 0.0);
  }
  geometry.radius = code.number('R', "delta radius");
  const double homed = code.number('H', dialect == CodeDialect::marlin
                                            ? "homed height; old versions print none: add the height that G28 shows"
                                            : "homed height"),
               shortest = *std::ranges::min_element(geometry.rod);
  if (!(geometry.radius > 0.0) || !(shortest > geometry.radius)) {
    code.fail(fmt::format("expected a delta radius above 0 and rods longer than it, got R {} and L {}", geometry.radius,
                          shortest));
  }
  turn_towers(code, geometry);
  const double below = nozzle_below(geometry);
  if (!std::isfinite(below)) {
    code.fail("expected separate towers and rods that meet between them, got a delta whose rods do not meet");
  }
  const Three adjustments = towers_of(endstops);
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.endstop[i] = dialect == CodeDialect::marlin ? homed - adjustments[i]
                                                         : endstop_of(geometry, i, homed - below + adjustments[i]);
  }
  return checked(code, geometry);
}

DeltaGeometry rotary_delta(const TextFile& file, const CodeWords& code) {
  const CodeWords endstops(file, kEndstops, letters_of(kEndstops, CodeDialect::reprapfirmware));
  refuse_tilt(endstops, CodeDialect::reprapfirmware);
  DeltaGeometry geometry{.actuator = Actuator::revolute};
  geometry.radius = code.number('R', "shoulder radius");
  geometry.arm = code.one_or_three('U', "length of the arms");
  geometry.rod = code.one_or_three('L', "length of the rods");
  geometry.shoulder = code.one_or_three('H', "height of the shoulders");
  const std::vector<double> angles = code.numbers('A', "lowest and highest angle of the arms");
  if (angles.size() != 2) code.fail(fmt::format("expected two angles after A, got {}", angles.size()));
  turn_towers(code, geometry);
  const Three adjustments = towers_of(endstops);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(geometry.radius > 0.0 && geometry.arm[i] > 0.0 && geometry.rod[i] > 0.0)) {
      code.fail(fmt::format("expected R, U and L above 0, got {}, {} and {}", geometry.radius, geometry.arm[i],
                            geometry.rod[i]));
    }
    geometry.endstop[i] = endstop_of(geometry, i, to_radians(angles[1] + adjustments[i]));
    if (!std::isfinite(geometry.endstop[i])) {
      code.fail(fmt::format("expected rods that reach the centre when homed, got L {} with R {} and U {}",
                            geometry.rod[i], geometry.radius, geometry.arm[i]));
    }
  }
  return checked(code, geometry);
}

std::string colons(const Three& values) { return fmt::format("{:.4f}:{:.4f}:{:.4f}", values[0], values[1], values[2]); }

std::string of_towers(const Three& values) {
  return fmt::format("X{:.4f} Y{:.4f} Z{:.4f}", values[0], values[1], values[2]);
}

/// How far the towers stand from where the firmware looks for them, deg.
Three turned(const DeltaGeometry& geometry) {
  Three angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    angles[i] = std::remainder(to_degrees(geometry.tower_angle[i]) - kDesignAngles[i], 360.0);
  }
  return angles;
}

/// Homed joints as their mean and what each differs from it by.
Three split(const Three& homed, double& mean) {
  mean = mean_of(homed);
  return {homed[0] - mean, homed[1] - mean, homed[2] - mean};
}

std::string rotary_codes(const DeltaGeometry& geometry) {
  double homed = 0.0;
  Three adjustments = split(homed_joints(geometry), homed);
  for (double& adjustment : adjustments) adjustment = to_degrees(adjustment);
  return fmt::format(
      "; add A to this line: your lowest angle, then {:.4f} (angle at the endstops)\nM669 K10 U{} L{} R{:.4f} H{} {}\n"
      "M666 {}\n",
      to_degrees(homed), colons(geometry.arm), colons(geometry.rod), geometry.radius, colons(geometry.shoulder),
      of_towers(turned(geometry)), of_towers(adjustments));
}

std::string linear_codes(const DeltaGeometry& geometry, const std::string& rods, double homed,
                         const Three& adjustments) {
  return fmt::format("M665 {} R{:.4f} H{:.4f} {}\nM666 {}\n", rods, geometry.radius, homed, of_towers(turned(geometry)),
                     of_towers(adjustments));
}

}  // namespace

DeltaGeometry read_machine_codes(const TextFile& text, CodeDialect dialect) {
  constexpr double kLinearKinematics = 3.0, kRotaryKinematics = 10.0;
  if (dialect == CodeDialect::marlin) {
    if (const auto compiled = marlin_configuration(text)) return linear_delta(compiled->codes, dialect);
    return linear_delta(as_machine_codes(text), dialect);
  }
  const TextFile file = as_machine_codes(text);
  const CodeWords kinematics(file, kRotary, letters_of(kRotary, dialect));
  const double kind = kinematics.number_or('K', kLinearKinematics);
  const bool rotary = kind == kRotaryKinematics;
  if (!rotary && kind != kLinearKinematics) {
    kinematics.fail('K', fmt::format("expected M669 K3 (linear delta) or K10 (rotary delta), got K{:g}", kind));
  }
  return rotary ? rotary_delta(file, kinematics) : linear_delta(file, dialect);
}

double print_radius_of_codes(const TextFile& text, CodeDialect dialect) {
  if (dialect == CodeDialect::marlin) {
    const auto compiled = marlin_configuration(text);
    return compiled ? compiled->print_radius : 0.0;
  }
  const TextFile file = as_machine_codes(text);
  const CodeWords linear(file, kLinear, letters_of(kLinear, dialect)),
      rotary(file, kRotary, letters_of(kRotary, dialect));
  return rotary.number_or('B', linear.number_or('B', 0.0));
}

std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect) {
  const bool marlin = dialect == CodeDialect::marlin;
  if (geometry.actuator == Actuator::revolute) {
    if (marlin)
      throw InvalidArgument("expected a linear delta for Marlin, got a rotary one, which Marlin does not support");
    return rotary_codes(geometry);
  }
  double homed = 0.0;
  if (marlin) {
    const double rod = mean_of(geometry.rod);
    homed = *std::ranges::min_element(geometry.endstop);
    Three adjustments{};
    for (std::size_t i = 0; i < 3; ++i) adjustments[i] = homed - geometry.endstop[i];
    const std::string rods = fmt::format("L{:.4f} A{:.4f} B{:.4f} C{:.4f}", rod, geometry.rod[0] - rod,
                                         geometry.rod[1] - rod, geometry.rod[2] - rod);
    return linear_codes(geometry, rods, homed, adjustments);
  }
  const Three adjustments = split(homed_joints(geometry), homed);
  return linear_codes(geometry, fmt::format("L{}", colons(geometry.rod)), homed + nozzle_below(geometry), adjustments);
}

}  // namespace paracal::io

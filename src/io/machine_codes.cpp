#include "paracal/io/machine_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::array<double, 3> kDesignAngles{210.0, 330.0, 90.0};  // deg
constexpr std::array<char, 3> kTowers{'X', 'Y', 'Z'}, kTrims{'A', 'B', 'C'};
constexpr std::string_view kLinear = "M665", kEndstops = "M666", kRotary = "M669";

using Three = std::array<double, 3>;

std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, line.find(';'));
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// The words of one code by their letters, each the last of its letter in the file.
class Code {
 public:
  Code(const TextFile& file, std::string_view name) : file_(file.name), name_(name) {
    int number = 0;
    for (const std::string_view line : lines_of(file.text)) {
      ++number;
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty() || words[0] != name) continue;
      line_ = number;
      for (std::size_t k = 1; k < words.size(); ++k) {
        text_[static_cast<char>(std::toupper(static_cast<unsigned char>(words[k].front())))] = words[k].substr(1);
      }
    }
  }

  [[noreturn]] void fail(const std::string& complaint) const { throw InputFileError(file_, line_, complaint); }

  /// The numbers after a letter, between colons.
  std::vector<double> numbers(char letter, std::string_view what) const {
    const auto found = text_.find(letter);
    if (found == text_.end()) fail(fmt::format("expected {} with {} ({}), got none", name_, letter, what));
    std::vector<double> values;
    std::string_view rest = found->second;
    while (true) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      const std::optional<double> value = finite_number(rest.substr(0, end));
      if (!value) fail(fmt::format("expected a number after {}, got \"{}\"", letter, rest.substr(0, end)));
      values.push_back(*value);
      if (end == rest.size()) return values;
      rest.remove_prefix(end + 1);
    }
  }

  double number(char letter, std::string_view what) const {
    const std::vector<double> values = numbers(letter, what);
    if (values.size() != 1) fail(fmt::format("expected one number after {}, got {}", letter, values.size()));
    return values[0];
  }

  double number_or(char letter, double otherwise) const {
    return text_.contains(letter) ? number(letter, {}) : otherwise;
  }

  /// One number for all towers, or three.
  Three one_or_three(char letter, std::string_view what) const {
    const std::vector<double> values = numbers(letter, what);
    if (values.size() == 1) return {values[0], values[0], values[0]};
    if (values.size() != 3) fail(fmt::format("expected one number or three after {}, got {}", letter, values.size()));
    return {values[0], values[1], values[2]};
  }

  /// Of the towers X, Y and Z; 0 where there is none.
  Three of_towers() const {
    return {number_or(kTowers[0], 0.0), number_or(kTowers[1], 0.0), number_or(kTowers[2], 0.0)};
  }

 private:
  std::string file_;
  std::string_view name_;
  std::map<char, std::string> text_;
  int line_ = 0;
};

void turn_towers(const Code& code, DeltaGeometry& geometry) {
  constexpr double kWholeTurn = 360.0;
  const Three turned = code.of_towers();
  for (const double angle : turned) {
    if (std::abs(angle) > kWholeTurn) code.fail(fmt::format("expected towers turned by up to 360 deg, got {}", angle));
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
  const Code code(file, kLinear), endstops(file, kEndstops);
  DeltaGeometry geometry{.actuator = Actuator::linear};
  geometry.rod = code.one_or_three('L', "length of the rods");
  if (dialect == CodeDialect::marlin) {
    for (std::size_t i = 0; i < 3; ++i) geometry.rod[i] += code.number_or(kTrims[i], 0.0);
  }
  geometry.radius = code.number('R', "delta radius");
  const double homed = code.number('H', "homed height"), shortest = *std::ranges::min_element(geometry.rod);
  if (!(geometry.radius > 0.0) || !(shortest > geometry.radius)) {
    code.fail(fmt::format("expected a delta radius above 0 and rods longer than it, got R {} and L {}", geometry.radius,
                          shortest));
  }
  turn_towers(code, geometry);
  const double below = nozzle_below(geometry);
  if (!std::isfinite(below)) {
    code.fail("expected towers that stand apart and rods that meet between them, got a delta that does not close");
  }
  const Three adjustments = endstops.of_towers();
  for (std::size_t i = 0; i < 3; ++i) {
    geometry.endstop[i] = dialect == CodeDialect::marlin ? homed - adjustments[i]
                                                         : endstop_of(geometry, i, homed - below + adjustments[i]);
  }
  return geometry;
}

DeltaGeometry rotary_delta(const TextFile& file, const Code& code) {
  const Code endstops(file, kEndstops);
  DeltaGeometry geometry{.actuator = Actuator::revolute};
  geometry.radius = code.number('R', "shoulder radius");
  geometry.arm = code.one_or_three('U', "length of the arms");
  geometry.rod = code.one_or_three('L', "length of the rods");
  geometry.shoulder = code.one_or_three('H', "height of the shoulders");
  const std::vector<double> angles = code.numbers('A', "lowest and highest angle of the arms");
  if (angles.size() != 2) code.fail(fmt::format("expected two angles after A, got {}", angles.size()));
  turn_towers(code, geometry);
  const Three adjustments = endstops.of_towers();
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
  return geometry;
}

std::string colons(const Three& values) { return fmt::format("{:.4f}:{:.4f}:{:.4f}", values[0], values[1], values[2]); }

std::string letters(const Three& values) {
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
      "; A of this line: your lowest angle, then {:.4f}, where the endstops are\nM669 K10 U{} L{} R{:.4f} H{} {}\n"
      "M666 {}\n",
      to_degrees(homed), colons(geometry.arm), colons(geometry.rod), geometry.radius, colons(geometry.shoulder),
      letters(turned(geometry)), letters(adjustments));
}

std::string linear_codes(const DeltaGeometry& geometry, const std::string& rods, double homed,
                         const Three& adjustments) {
  return fmt::format("M665 {} R{:.4f} H{:.4f} {}\nM666 {}\n", rods, geometry.radius, homed, letters(turned(geometry)),
                     letters(adjustments));
}

}  // namespace

DeltaGeometry read_machine_codes(const TextFile& file, CodeDialect dialect) {
  constexpr double kRotaryKinematics = 10.0;
  const Code kinematics(file, kRotary);
  const bool rotary = dialect == CodeDialect::reprapfirmware && kinematics.number_or('K', 0.0) == kRotaryKinematics;
  return rotary ? rotary_delta(file, kinematics) : linear_delta(file, dialect);
}

std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect) {
  const bool marlin = dialect == CodeDialect::marlin;
  if (geometry.actuator == Actuator::revolute) {
    if (marlin) throw InvalidArgument("expected a linear delta for Marlin, which knows no rotary ones");
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

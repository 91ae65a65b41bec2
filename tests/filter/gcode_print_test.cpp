// A print as a slicer makes it: homing, layers, perimeters, infill, travels, retractions.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "filtered_program.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::gcode_print_test {
namespace {

constexpr double kSide = 80.0;              // mm
constexpr double kWidth = 0.45;             // of a bead, mm
constexpr double kLayer = 0.2;              // mm
constexpr double kFilament = 0.0332;        // mm of filament a mm of path
const Eigen::Vector3d kOrigin(0, 0, -900);  // of the bed in {O}

/// A cube, sliced.
class Cube {
 public:
  explicit Cube(bool is_relative) : is_relative_(is_relative) {
    text_ =
        "; generated\nM201 X9000 Y9000 Z500 E10000\nM205 X8.00 Y8.00 Z0.40 E5.00\nM104 S215\nG28 ; home\nG21\nG90\n";
    text_ += is_relative ? "M83\nG92 E0\nG1 F300 Z5\n" : "M82\nG92 E0\nG1 F300 Z5\n";
  }

  std::string of_lines(int count) {
    for (int layer = 0; lines_ < count; ++layer) add_layer(layer);
    return text_ + "M107\nM104 S0\nG28 X0 ; home X\nM84\n";
  }
  int targets() const { return targets_; }

 private:
  void add(const std::string& line) {
    text_ += line + "\n";
    ++lines_;
  }
  void retract(double length) {
    extruded_ = is_relative_ ? length : extruded_ + length;
    add(fmt::format("G1 E{:.5f} F2400.00000", extruded_));
  }
  void travel(double x, double y) {
    retract(-2.0);
    add(fmt::format("G0 X{:.3f} Y{:.3f} F7800.000", x, y));
    retract(2.0);
    x_ = x, y_ = y, ++targets_;
  }
  void extrude(double x, double y) {
    const double length = kFilament * std::hypot(x - x_, y - y_);
    extruded_ = is_relative_ ? length : extruded_ + length;
    add(fmt::format("G1 X{:.3f} Y{:.3f} E{:.5f}", x, y, extruded_));
    x_ = x, y_ = y, ++targets_;
  }
  void add_layer(int layer) {
    add(";LAYER:" + std::to_string(layer));
    add(fmt::format("M73 P{} R{}", layer, 99 - layer % 99));
    add(fmt::format("G1 Z{:.3f} F7800.000", kLayer * (layer + 1)));
    ++targets_;
    for (int k = 0; k < 3; ++k) {
      const double half = 0.5 * kSide - k * kWidth;
      travel(-half, -half);
      add("G1 F1800");
      extrude(half, -half), extrude(half, half), extrude(-half, half), extrude(-half, -half);
    }
    for (double y = -0.5 * kSide + 2; y < 0.5 * kSide - 2; y += 4 * kWidth) {
      const double reach = 0.5 * kSide - 2, far = layer % 2 == 0 ? reach : -reach;
      layer % 2 == 0 ? extrude(-far, y) : extrude(y, -far);
      layer % 2 == 0 ? extrude(far, y) : extrude(y, far);
    }
    if (!is_relative_) {
      add("G92 E0");
      extruded_ = 0.0;
    }
  }

  bool is_relative_;
  std::string text_;
  int lines_ = 0, targets_ = 0;
  double extruded_ = 0.0, x_ = 0.0, y_ = 0.0;
};

/// Where a printer goes when its firmware, which computes with the nominal robot, is told a place.
class Printer {
 public:
  Printer(const Robot& robot, const SourceErrors& errors) : nominal_(robot.nominal()), machine_(build(robot, errors)) {}

  Eigen::Vector3d reached(const Eigen::Vector3d& told) const {
    const InverseResult joints = inverse(nominal_, Pose{told + kOrigin, 0.0});
    const ForwardResult pose = forward(machine_, joints.joints);
    EXPECT_TRUE(joints.ok() && pose.ok());
    return pose.plate.position - kOrigin;
  }

 private:
  Machine nominal_, machine_;
};

/// Ways of a print and the filament on each.
struct Extruded {
  std::vector<double> lengths, filament;  ///< mm, of each motion that extrudes
};

/// @param machine  null: the ways as they are programmed.
Extruded extruded(const std::vector<std::string>& lines, bool is_relative, const Printer* machine) {
  Extruded result;
  Eigen::Vector3d told = Eigen::Vector3d::Zero(), from = told;
  double e = 0.0;
  for (const std::string& line : lines) {
    if (line.starts_with("G92")) e = 0.0;
    if (!line.starts_with("G0") && !line.starts_with("G1")) continue;
    told = {test::word(line, 'X').value_or(told.x()), test::word(line, 'Y').value_or(told.y()),
            test::word(line, 'Z').value_or(told.z())};
    const Eigen::Vector3d to = machine != nullptr ? machine->reached(told) : told;
    const auto stated = test::word(line, 'E');
    const double step = !stated ? 0.0 : is_relative ? *stated : *stated - e;
    if (stated && !is_relative) e = *stated;
    if (stated && line.find('X') != std::string::npos) {
      result.lengths.push_back((to - from).norm());
      result.filament.push_back(step);
    }
    from = to;
  }
  return result;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

class GcodePrint : public testing::TestWithParam<bool> {};

/// Filament a mm of the path that the printer takes: as sliced, to 1e-4, in all and on each way of 5 mm or more, where
/// decimals of a coordinate (0.1 um) and of the filament (1e-5 mm) are 1e-4 of it at most.
TEST_P(GcodePrint, TwentyThousandLinesAreCorrectedAndExtrudeAsSliced) {
  const Robot robot = catalogue::find("linear_delta");
  const SourceErrors errors = test::table4_machine(robot, 5);
  Cube cube(GetParam());
  const std::string program = cube.of_lines(20000);
  const test::Filtered result = test::filtered_gcode(program, {robot, errors}, {.origin = kOrigin});
  EXPECT_TRUE(result.summary.whole());
  EXPECT_EQ(result.summary.corrected, cube.targets() - 1);  // behind homing, Z alone is no target
  EXPECT_GE(result.summary.lines, 20000);

  const Printer printer(robot, errors);
  const Extruded sliced = extruded(test::lines_in(program), GetParam(), nullptr);
  const Extruded printed = extruded(result.lines(), GetParam(), &printer);
  ASSERT_GE(printed.lengths.size(), sliced.lengths.size());
  EXPECT_NEAR(sum(printed.filament) / sum(sliced.filament), 1.0, 1e-6);
  EXPECT_NEAR(sum(printed.lengths) / sum(sliced.lengths), 1.0, 1e-5);
  for (std::size_t k = 0; k < printed.lengths.size(); ++k) {
    if (printed.lengths[k] < 5.0) continue;
    EXPECT_NEAR(printed.filament[k] / printed.lengths[k] / kFilament, 1.0, 1e-4);
  }
  EXPECT_GT(printed.lengths.size(), sliced.lengths.size());  // some were divided
}

INSTANTIATE_TEST_SUITE_P(Extrusion, GcodePrint, testing::Bool());

}  // namespace
}  // namespace paracal::io::gcode_print_test

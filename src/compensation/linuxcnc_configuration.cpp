#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "export_text.hpp"
#include "paracal/compensation/export.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

using namespace compensation_detail;

/// The limbs stand in the robot file one by one, with the directions of their drives.
bool is_described(const Robot& robot) { return !shared_dimensions(robot.limbs()); }

/// Sample speed of a joint, and what its limits leave beside its travel; mm or deg.
struct JointSample {
  Unit unit;
  std::string_view name, positive;
  double margin, speed;

  /// As LinuxCNC shows it.
  double shown(double joint) const { return to_file_unit(unit, joint); }
};

JointSample joint_sample(const Robot& robot, Actuator limb) {
  if (limb.drive == Drive::strut) return {Unit::mm, "strut", "a longer strut", 5.0, 500.0};
  const bool described = is_described(robot);
  if (swings_arm(limb)) {
    return {Unit::rad, "arm",
            described ? "right-handed about the arm's `axis` in the robot file" : "upwards: the arm's end rises", 1.0,
            180.0};
  }
  return {Unit::mm, "carriage",
          described ? "along the rail's `direction` in the robot file" : "upwards: the carriage rises", 5.0, 500.0};
}

std::vector<JointSample> joint_samples(const Robot& robot) {
  std::vector<JointSample> samples;
  for (const Actuator limb : kinds_of(robot.limbs())) samples.push_back(joint_sample(robot, limb));
  return samples;
}

/// "carriage or strut": what is said of the samples, each once.
std::string alternatives(const std::vector<JointSample>& samples, const auto& said) {
  std::vector<std::string> words;
  for (const JointSample& one : samples) {
    const std::string word(said(one));
    if (std::ranges::find(words, word) == words.end()) words.push_back(word);
  }
  return fmt::format("{}", fmt::join(words, " or "));
}

// ---- Axes: coordinates of the plate, 0 to 2 its place and 3 to 5 its angles

char letter(int axis) { return "XYZABC"[axis]; }

/// Guides hold z of other plates.
bool moves_z(const Robot& robot) { return !robot.freedoms().holds_z(); }

/// Those that the robot moves.
std::vector<int> axes_of(const Robot& robot) {
  const std::vector<std::size_t> commanded = commanded_coordinates(robot.nominal());
  return {commanded.begin(), commanded.end()};
}

/// The ends of an axis, mm or deg.
std::array<double, 2> ends(const Robot& robot, int axis) {
  const Workspace& whole = robot.workspace();
  if (axis < 3) return {whole.bounds().min()[axis], whole.bounds().max()[axis]};
  if (robot.slide()) return {to_degrees(whole.min_rotation), to_degrees(whole.max_rotation)};
  const double tilt = to_degrees(whole.tilt_about(axis - 3));
  return {-tilt, tilt};
}

constexpr double kLinearSpeed = 500.0;  // mm/s

/// deg/s; tilts go a few degrees only.
double turning_speed(const Robot& robot) { return robot.freedoms().tilt() ? 45.0 : 360.0; }

// ---- What the workspace asks of joints

/// The plate at the centre, turned and tilted as far as it goes.
std::vector<Pose> attitudes(const Workspace& whole) {
  const double middle = 0.5 * (whole.min_rotation + whole.max_rotation);
  std::vector<Pose> all;
  for (const double rotation : std::set{whole.min_rotation, middle, whole.max_rotation}) {
    for (const Eigen::Vector3d& tilt : whole.tilts()) all.push_back({whole.centre(), rotation, tilt});
  }
  return all;
}

/// Edges of the wall, where most joints have their extremes, and layers between: a level rod has one there.
std::vector<double> depths(const Workspace& whole) {
  constexpr int kLayers = 4;
  std::vector<double> all = whole.edge_depths();
  for (int k = 1; k < whole.layers(kLayers); ++k) all.push_back(static_cast<double>(k) / kLayers);
  return all;
}

/// Calls take(pose, joints) on circles in all layers of the workspace, as far as the machine reaches.
void everywhere(const Robot& robot, const Machine& machine, const auto& take) {
  constexpr int kCircles = 16, kPoints = 72;
  const Workspace& whole = robot.workspace();
  const std::vector<Pose> poses = attitudes(whole);
  for (const double depth : depths(whole)) {
    for (int k = 0; k < (kCircles + 1) * kPoints; ++k) {
      const int circle = k / kPoints;
      const double share = static_cast<double>(circle) / kCircles;
      const Eigen::Vector3d place = whole.at(share, 2.0 * std::numbers::pi * (k % kPoints) / kPoints, depth);
      for (Pose pose : poses) {
        pose.position = place;
        if (const InverseResult found = inverse(machine, pose); found.ok()) take(pose, found.joints);
      }
    }
  }
}

/// Speeds of the joints while the plate moves as fast as it may, in whatever direction, and turns about all axes:
/// |dq/dr| v + sum |dq/dangle| w.
Joints fastest_at(const Robot& robot, const Machine& machine, const Pose& pose, const Joints& joints) {
  constexpr double kStep = 0.01;  // mm and, for a lever of 100 mm, 1e-4 rad
  constexpr double kTurn = 1e-4;  // rad
  Joints square = Joints::Zero(joints.size()), by_turns = square;
  for (const int axis : axes_of(robot)) {
    const double step = axis < 3 ? kStep : kTurn;
    Pose moved = pose;
    coordinate(moved, machine, static_cast<std::size_t>(axis)) += step;
    const InverseResult there = inverse(machine, moved);
    if (!there.ok()) continue;
    const Joints change = (there.joints - joints) / step;
    axis < 3 ? square += change.cwiseAbs2() : by_turns += change.cwiseAbs();
  }
  return kLinearSpeed * square.cwiseSqrt() + to_radians(turning_speed(robot)) * by_turns;
}

/// rad or mm, per s.
struct JointDemand {
  Joints home, lowest, highest, fastest;
};

JointDemand joint_demand(const Robot& robot, const Machine& machine, const DriveCurves& drives) {
  const Joints home = inverse(machine, {robot.workspace().centre()}).joints;
  JointDemand demand{home, home, home, Joints::Zero(home.size())};
  everywhere(robot, machine, [&](const Pose& pose, const Joints& joints) {
    demand.lowest = demand.lowest.cwiseMin(joints);
    demand.highest = demand.highest.cwiseMax(joints);
    Joints fastest = fastest_at(robot, machine, pose, joints);
    for (Eigen::Index i = 0; i < joints.size(); ++i) {
      const auto limb = static_cast<std::size_t>(i);
      fastest(i) /= (1.0 + drives.of(limb).slope(joints(i))) * machine.limbs[limb].turn.rate(joints(i));
    }
    demand.fastest = demand.fastest.cwiseMax(fastest);
  });
  for (Joints* const one : {&demand.home, &demand.lowest, &demand.highest}) *one = drives.commanded(*one);
  return demand;
}

/// By how much the sample speeds of the axes are reduced so that no joint is asked for more than its own; two digits.
double share_of_speeds(const Robot& robot, const JointDemand& demand) {
  const std::vector<JointSample> samples = joint_samples(robot);
  double share = 1.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double asked = samples[i].shown(demand.fastest(static_cast<Eigen::Index>(i)));
    share = std::min(share, samples[i].speed / asked);
  }
  const double digits = std::pow(10.0, std::max(2.0, 1.0 - std::floor(std::log10(share))));
  return std::floor(digits * share) / digits;
}

// ---- Texts

/// As people type it.
std::string number(double value) { return fmt::format("{:.12g}", value); }

Values speed(double value) { return {{"SPEED", number(value)}, {"ACCELERATION", number(10.0 * value)}}; }

std::string axes(const Robot& robot, double share) {
  std::string text;
  for (const int axis : axes_of(robot)) {
    const auto [lowest, highest] = ends(robot, axis);
    Values values = speed(share * (axis < 3 ? kLinearSpeed : turning_speed(robot)));
    values.emplace_back("LETTER", std::string(1, letter(axis)));
    values.emplace_back("LOWEST", number(lowest));
    values.emplace_back("HIGHEST", number(highest));
    text += filled_template("linuxcnc_axis.ini", values);
  }
  return text;
}

std::string joints(const Robot& robot, const JointDemand& demand) {
  const std::vector<JointSample> samples = joint_samples(robot);
  std::string text;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto shown = [&](const Joints& all) { return samples[i].shown(all(static_cast<Eigen::Index>(i))); };
    Values values = speed(samples[i].speed);
    values.emplace_back("JOINT", std::to_string(i));
    values.emplace_back("TYPE", samples[i].unit == Unit::mm ? "LINEAR" : "ANGULAR");
    values.emplace_back("LOWEST", fmt::format("{:.3f}", shown(demand.lowest) - samples[i].margin));
    values.emplace_back("HIGHEST", fmt::format("{:.3f}", shown(demand.highest) + samples[i].margin));
    values.emplace_back("HOME", decimal(shown(demand.home)));
    text += filled_template("linuxcnc_joint.ini", values);
  }
  return text;
}

/// What the texts say of the joints.
void add_joints(const Robot& robot, Values& values) {
  const std::vector<JointSample> all = joint_samples(robot);
  const auto add = [&](std::string_view key, const auto& said) { values.emplace_back(key, alternatives(all, said)); };
  add("MARGIN", [](const JointSample& one) { return fmt::format("{} {}", one.margin, file_unit(one.unit)); });
  add("COUNTED", [](const JointSample& one) { return fmt::format("{} of the {}", file_unit(one.unit), one.name); });
  add("POSITIVE", [](const JointSample& one) { return one.positive; });
}

std::string motor_loops(const Robot& robot) {
  std::string text;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    text += fmt::format("net joint-{0} joint.{0}.motor-pos-cmd => joint.{0}.motor-pos-fb\n", i);
  }
  return text;
}

void add_speeds(const Robot& robot, double share, Values& values) {
  const double linear = share * kLinearSpeed, turning = share * turning_speed(robot);
  values.emplace_back("LINEAR_SPEED", number(linear));
  values.emplace_back("LINEAR_ACCELERATION", number(10.0 * linear));
  values.emplace_back("TURNING_SPEED", number(turning));
  values.emplace_back("TURNING_ACCELERATION", number(10.0 * turning));
  values.emplace_back("DEFAULT_SPEED", number(std::min(100.0, linear)));
  values.emplace_back("DEFAULT_TURNING_SPEED", number(std::min(45.0, turning)));
}

/// Half of the way about each angle, to both sides.
std::string turns(const Robot& robot) {
  std::string text;
  for (const int axis : axes_of(robot)) {
    if (axis < 3) continue;
    const auto [lowest, highest] = ends(robot, axis);
    text += fmt::format("G1 {0}{1}\nG1 {0}{2}\nG0 {0}0\n", letter(axis), number(0.5 * highest), number(0.5 * lowest));
  }
  return text;
}

/// Places in the workspace, mm, and turns to both sides where the plate has some.
void add_motions(const Robot& robot, Values& values) {
  const Workspace& workspace = robot.workspace();
  const Eigen::Vector3d centre = workspace.centre();
  const double quarter = 0.25 * std::min(workspace.half_width(0), workspace.half_width(1));
  const auto if_z = [&](const char* before, double z) { return moves_z(robot) ? before + number(z) : ""; };
  values.emplace_back("CENTRE_X", number(centre.x()));
  values.emplace_back("CENTRE_Y", number(centre.y()));
  values.emplace_back("IN_CENTRE_Z", if_z(", Z ", centre.z()));
  values.emplace_back("AT_CENTRE_Z", if_z(" Z", centre.z()));
  values.emplace_back("AT_ABOVE", if_z(" Z", centre.z() + 0.25 * workspace.height));
  values.emplace_back("QUARTER", number(quarter));
  values.emplace_back("AT_QUARTER", number(centre.x() + quarter));
  values.emplace_back("TURN", turns(robot));
}

/// What README.md calls G54.
std::string frame_in_words(const Robot& robot) {
  const Eigen::AlignedBox3d bounds = robot.workspace().bounds();
  std::string text = is_described(robot) ? "that of the robot file, z up" : "origin at the centre of the base, z up";
  if (!moves_z(robot)) return text;
  if (bounds.max().z() <= 0.0) text += ", so Z is negative";
  if (bounds.min().z() >= 0.0) text += ", so Z is positive";
  return text;
}

/// "- A is tilt_x, B is tilt_y: the plate is turned by R = Rot(x, A) Rot(y, B).\n"
std::string tilts_in_words(const Robot& robot) {
  if (!robot.freedoms().tilt()) return "";
  std::vector<std::string> tilts, rotations;
  for (const int axis : axes_of(robot)) {
    if (axis < 3) continue;
    tilts.push_back(fmt::format("{} is {}", letter(axis), kPlateCoordinates.at(axis)));
    rotations.push_back(fmt::format("Rot({}, {})", "xyz"[axis - 3], letter(axis)));
  }
  return fmt::format("- {}: the plate is turned by R = {}.\n", fmt::join(tilts, ", "), fmt::join(rotations, " "));
}

/// Levels and tools, where the robot moves Z; tools hang from a plate below the base, and stand on one above.
void add_tools(const Robot& robot, Values& values) {
  const PlateFreedoms& freedoms = robot.freedoms();
  const bool above = robot.nominal().hang.z() > 0.0, has_z = moves_z(robot);
  const bool tilts = freedoms.free[3] || freedoms.free[4];
  const std::string beside = above ? "above" : "below";
  const std::string tool = fmt::format("T2 P2 Z{} ;a tool with its tip 50 mm {} the plate\n", above ? -50 : 50, beside);
  values.emplace_back("PLATE_POINT", is_described(robot) ? "plate's origin" : "plate centre");
  values.emplace_back("FLOOR", has_z ? number(robot.workspace().bounds().min().z()) : "0");
  values.emplace_back("LEVEL", above ? "counts from" : "is a table at");
  values.emplace_back("BESIDE", beside);
  values.emplace_back("LENGTHS", above ? "upwards negative" : "downwards positive");
  values.emplace_back("TILTED", tilts ? " LinuxCNC adds them along Z, however the plate is tilted." : "");
  values.emplace_back("TOOLS", has_z ? tool : "");
  values.emplace_back("OF_TOOLS", filled_template(has_z ? "linuxcnc_tools.md" : "linuxcnc_no_tools.md", values));
}

std::string coordinates(const Robot& robot) {
  std::string letters;
  for (const int axis : axes_of(robot)) letters += letter(axis);
  return letters;
}

/// Files of the configuration, and their templates.
constexpr std::array<std::pair<const char*, const char*>, 6> kFiles{{{"README.md", "linuxcnc.md"},
                                                                     {"first_motions.ngc", "linuxcnc.ngc"},
                                                                     {"paracal.hal", "linuxcnc.hal"},
                                                                     {"paracal.ini", "linuxcnc.ini"},
                                                                     {"paracal.var", "linuxcnc.var"},
                                                                     {"tool.tbl", "linuxcnc.tbl"}}};

}  // namespace

std::map<std::string, std::string> linuxcnc_configuration(const Robot& robot, const SourceErrors& errors,
                                                          const ExportOrigin& origin, const DriveCurves& drives) {
  std::map<std::string, std::string> files{{"paracal_kins.comp", linuxcnc_component(robot, errors, origin, drives)}};
  const JointDemand demand = joint_demand(robot, build(robot, errors), drives);
  const double share = share_of_speeds(robot, demand);
  Values values = head(robot, origin);
  values.emplace_back("COORDINATES", coordinates(robot));
  values.emplace_back("AXES", axes(robot, share));
  values.emplace_back("JOINTS", joints(robot, demand));
  values.emplace_back("LOOPS", motor_loops(robot));
  add_joints(robot, values);
  values.emplace_back("FRAME", frame_in_words(robot));
  values.emplace_back("TILTS", tilts_in_words(robot));
  add_speeds(robot, share, values);
  add_motions(robot, values);
  add_tools(robot, values);
  for (const auto& [name, from] : kFiles) files.emplace(name, filled_template(from, values));
  return files;
}

}  // namespace paracal

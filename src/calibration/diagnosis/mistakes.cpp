#include "mistakes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>

#include "command_mistakes.hpp"
#include "limb_orders.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "reading_mistakes.hpp"

namespace paracal::detail {
namespace {

class MistakeList {
 public:
  explicit MistakeList(const Input& given) : given_(given) {}

  void add(std::string family, std::string text, std::function<void(Measurements&)> undo) {
    mistakes_.push_back(mistake_of_measurements(std::move(family), std::move(text), std::move(undo)));
  }
  void add_to_input(std::string family, std::string text, std::function<void(Input&)> undo) {
    mistakes_.push_back({MistakeKind::usual, std::move(family), std::move(text), std::move(undo)});
  }

  void append(std::vector<Mistake> more) { std::ranges::move(more, std::back_inserter(mistakes_)); }

  void add_angles();
  void add_signs_of_rotation();
  void add_rows();
  void add_mounts();
  void add_orientations();
  void add_frames();
  void add_frames_of_bodies();
  void add_command_frames();
  void add_limb_orders();
  void add_robots();

  std::vector<Mistake> take() { return std::move(mistakes_); }

 private:
  const Measurements& measurements() const { return given_.measurements; }

  const Input& given_;
  std::vector<Mistake> mistakes_;
};

void MistakeList::add_angles() {
  const bool commanded = commands_count(measurements()) && commands_turn(measurements());
  const bool joints = states_joints(measurements()) && joint_unit(given_.robot.actuator()) == Unit::rad;
  const bool read = reads_rotation(measurements());
  const auto command = [](Measurements& m) { turn_commands(m, kRadInDegrees); };
  const auto joint = [](Measurements& m) { scale_joints(m, kRadInDegrees); };
  const auto reading = [](Measurements& m) { scale_rotations(m, kRadInDegrees); };
  if (joints) add("angle", "the joint angles are in rad, not deg", joint);
  if (commanded) add("angle", "the commanded phi is in rad, not deg", command);
  if (read) add("angle", "the readings of phi are in rad, not deg", reading);
  if (read && commanded) {
    add("angle", "all values of phi are in rad, not deg", [=](Measurements& m) { command(m), reading(m); });
  }
  if (read && joints) {
    add("angle", "the joint angles and the readings of phi are in rad, not deg",
        [=](Measurements& m) { joint(m), reading(m); });
  }
}

void MistakeList::add_signs_of_rotation() {
  const bool commanded = commands_count(measurements()) && commands_turn(measurements());
  const bool read = reads_rotation(measurements());
  if (read)
    add("sign", "the readings of phi have the opposite sign", [](Measurements& m) { scale_rotations(m, -1.0); });
  if (commanded)
    add("sign", "the commanded phi has the opposite sign", [](Measurements& m) { turn_commands(m, -1.0); });
  if (commanded && read) {
    add("sign", "commanded and measured phi have the opposite sign", [](Measurements& m) {
      turn_commands(m, -1.0);
      scale_rotations(m, -1.0);
    });
  }
}

void MistakeList::add_rows() {
  add("row", "each reading belongs to the pose one row below", [](Measurements& m) { shift_rows(m, 1); });
  add("row", "each reading belongs to the pose one row above", [](Measurements& m) { shift_rows(m, -1); });
  if (!has_repeats(measurements())) return;
  add("row", "the readings of each pose belong to the next pose of the list",
      [](Measurements& m) { shift_stations(m, 1); });
  add("row", "the readings of each pose belong to the pose before it in the list",
      [](Measurements& m) { shift_stations(m, -1); });
}

void MistakeList::add_mounts() {
  const bool body = reads_orientation(measurements());
  if (!body && !reads_second(measurements())) return;
  struct Mount {
    ReflectorMount mount;
    const char* text;
  };
  constexpr std::array<Mount, 3> kMounts{{{ReflectorMount::plate, "is on the plate"},
                                          {ReflectorMount::end_effector, "turns with phi"},
                                          {ReflectorMount::end_effector_reversed, "turns by -phi"}}};
  for (const auto& [mount, text] : kMounts) {
    if (mount == given_.options.reflectors) continue;
    add_to_input("mount",
                 fmt::format("{} {} (--reflectors {})", body ? "the body" : "the second reflector", text, name(mount)),
                 [is = mount](Input& input) { input.options.reflectors = is; });
  }
}

/// What programs of motion capture disagree on.
void MistakeList::add_orientations() {
  if (!reads_orientation(measurements())) return;
  const auto change = [&](std::string text, std::function<Quaternion(const Quaternion&)> undo) {
    add("orientation", std::move(text), [undo = std::move(undo)](Measurements& m) { change_orientations(m, undo); });
  };
  change("the quaternions are inverted: they rotate from the instrument's frame to the body's",
         [](const Quaternion& q) { return Quaternion(q.conjugate()); });
  change("the quaternions have w last: the columns are qx, qy, qz, qw",
         [](const Quaternion& q) { return Quaternion(q.z(), q.w(), q.x(), q.y()); });
}

/// "-y" for the row (0, -1, 0).
std::string axis_of(const Eigen::RowVector3d& row) {
  Eigen::Index axis = 0;
  row.cwiseAbs().maxCoeff(&axis);
  return fmt::format("{}{}", row(axis) < 0.0 ? "-" : "", "xyz"[axis]);
}

/// "x, y, z of the readings are x, -y, z of the robot"
std::string exchange_text(std::string_view what, const Eigen::Matrix3d& axes, std::string_view of) {
  return fmt::format("x, y, z of the {} are {}, {}, {} of the {}", what, axis_of(axes.col(0).transpose()),
                     axis_of(axes.col(1).transpose()), axis_of(axes.col(2).transpose()), of);
}

/// An orientation shows which axis is which: one sign, two axes, or the vertical of another program.
void MistakeList::add_frames_of_bodies() {
  // A rotation R seen in a mirror S is S R S.
  add("frame", "the frame of the readings, orientations included, is left-handed", [](Measurements& m) {
    turn_readings(m, Eigen::Vector3d(1, 1, -1).asDiagonal());
    change_orientations(m, [](const Quaternion& q) { return Quaternion(q.w(), -q.x(), -q.y(), q.z()); });
  });
  for (const Eigen::Matrix3d& axes : exchanges_of_axes()) {
    const bool sign = axes.diagonal().cwiseAbs().sum() == 3.0 && axes.trace() == 1.0;
    const bool two = axes.diagonal().cwiseAbs().sum() == 1.0 && axes.diagonal().sum() == 1.0;
    if (!sign && !two) continue;
    add("frame", exchange_text("positions", axes, "orientations"), [axes](Measurements& m) { turn_readings(m, axes); });
  }
}

/// Of an unknown frame all mirrors are alike; of the robot's own all 47 exchanges and signs of axes count.
void MistakeList::add_frames() {
  for (const LengthWords& kind : length_kinds()) {
    if (kind.reversed.empty() || !reads_lengths(measurements(), kind.kind)) continue;
    add("frame", std::string(kind.reversed), [is = kind.kind](Measurements& m) { negate_lengths(m, is); });
  }
  if (measurements().series.empty()) return;
  if (given_.options.frame == Frame::unknown) {
    if (reads_orientation(measurements())) return add_frames_of_bodies();
    add("frame", "the frame of the readings is mirrored: an axis has the wrong sign, or two axes are swapped",
        [](Measurements& m) { turn_readings(m, Eigen::Vector3d(1, 1, -1).asDiagonal()); });
    return;
  }
  for (const Eigen::Matrix3d& axes : exchanges_of_axes()) {
    add("frame", exchange_text("readings", axes, "robot"), [axes](Measurements& m) { turn_readings(m, axes); });
  }
  add_to_input("frame", "the readings are not in the robot's frame (--frame unknown)",
               [](Input& input) { input.options.frame = Frame::unknown; });
}

void MistakeList::add_command_frames() {
  if (!commands_count(measurements())) return;
  const auto turned = [&](const std::string& text, const Eigen::Matrix3d& turn) {
    add("commands", text, [turn](Measurements& m) { turn_frame_of_commands(m, turn); });
  };
  turned("the commanded z has the opposite sign", Eigen::Vector3d(1, 1, -1).asDiagonal());
  turned("the commanded x has the opposite sign", Eigen::Vector3d(-1, 1, 1).asDiagonal());
  turned("the commanded y has the opposite sign", Eigen::Vector3d(1, -1, 1).asDiagonal());
  Eigen::Matrix3d swapped = Eigen::Matrix3d::Identity();
  swapped.col(0).swap(swapped.col(1));
  turned("the commanded x and y are swapped", swapped);
  for (const int degrees : {30, 45, 60, 90, 120, 135, 150, 180, 210, 225, 240, 270, 300, 315, 330}) {
    turned(fmt::format("the frame of the commands is rotated by {} deg about z relative to the robot's", degrees),
           Eigen::AngleAxisd(to_radians(degrees), Eigen::Vector3d::UnitZ()).toRotationMatrix());
  }
}

void MistakeList::add_limb_orders() {
  for (const std::vector<Eigen::Index>& order : limb_orders(given_.robot.limb_count())) {
    std::vector<Eigen::Index> named = order;
    for (Eigen::Index& limb : named) ++limb;
    const std::string text = fmt::format("the limbs are in another order: joints 1 to {} are those of limbs {}",
                                         order.size(), fmt::join(named, ", "));
    add_to_input("limbs", text, [order](Input& input) {
      state_joints(input.robot, input.measurements);
      for (Station& station : input.measurements.stations) {
        const Joints joints = *station.believed;
        for (std::size_t k = 0; k < order.size(); ++k) {
          (*station.believed)(order[k]) = joints(static_cast<Eigen::Index>(k));
        }
      }
    });
  }
}

/// Who has a file of his own knows how many limbs his machine has.
void MistakeList::add_robots() {
  const std::vector<std::string_view> names = catalogue::names();
  const bool own = std::ranges::find(names, given_.robot.name()) == names.end();
  for (const std::string_view name : names) {
    const Robot other = catalogue::find(name);
    const bool alike = other.limb_count() == given_.robot.limb_count() && other.actuator() == given_.robot.actuator();
    if (name == given_.robot.name() || ((own || states_joints(measurements())) && !alike)) continue;
    mistakes_.push_back({MistakeKind::robot, "robot", fmt::format("the robot is {}, not {}", name, given_.robot.name()),
                         [other](Input& input) { input.robot = other; }});
  }
}

}  // namespace

std::vector<Mistake> usual_mistakes(const Input& given) {
  MistakeList list(given);
  list.append(unit_mistakes(given));
  list.add_angles();
  list.add_signs_of_rotation();
  list.append(tilt_mistakes(given));
  list.add_frames();
  list.add_rows();
  list.add_mounts();
  list.append(reflector_mistakes(given));
  list.add_orientations();
  list.add_robots();
  list.add_limb_orders();
  list.add_command_frames();
  return list.take();
}

}  // namespace paracal::detail

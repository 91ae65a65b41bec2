#include "single_rods.hpp"

#include <algorithm>
#include <numbers>

#include "named_constants.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal::compensation_detail {
namespace {

using Expressions = std::vector<Expression>;

/// The constants of one limb as numbers of a formula.
class Constants {
 public:
  Constants(const Limb& limb, std::size_t number) : all_(constants_of(limb)), named_(number) {}

  Expression number(std::string_view name) const { return named_.named(find(name).name, find(name).values[0]); }

  Vector<Expression> vector(std::string_view name) const {
    const LimbConstant& one = find(name);
    return named_.named(one.name, std::array{one.values[0], one.values[1], one.values[2]});
  }

 private:
  const LimbConstant& find(std::string_view name) const { return *std::ranges::find(all_, name, &LimbConstant::name); }

  std::vector<LimbConstant> all_;
  NamedConstants named_;
};

/// A limb that has closed: its joint, the rod, of any length, and what moves its joint by one as the joint at the plate
/// moves along the rod by one: d joint = rod.d(joint at the plate) / by_joint.
struct Closed {
  Expression joint;
  Vector<Expression> rod;
  Expression by_joint;
};

/// @param d  from the base to the joint at the plate.
Closed closed_strut(const Constants& limb, const Vector<Expression>& d) {
  const Expression length = sqrt(dot(d, d)), growth = limb.number("growth");
  return {(length - limb.number("length")) / growth, d, length * growth};
}

/// |d - L u_1| = l gives rod.(d(d) - L v_1 dq) = 0.
Closed closed_crank(const Constants& limb, const Vector<Expression>& d) {
  const Vector<Expression> u = limb.vector("u"), v = limb.vector("v");
  const Expression arm = limb.number("arm");
  const ArmDirection<Expression> along = close_triangle(ArmReach<Expression>{
      .radial = dot(d, u), .normal = dot(d, v), .square = dot(d, d), .arm = arm, .rod = limb.number("rod")});
  const Expression size = sqrt(along.cosine * along.cosine + along.sine * along.sine);
  const Expression cosine = along.cosine * arm / size, sine = along.sine * arm / size;
  const Vector<Expression> elbow = sum(scaled(u, cosine), v, sine), motion = sum(scaled(v, cosine), u, -sine);
  const Vector<Expression> rod = sum(d, elbow, Expression(-1.0));
  return {atan2(along.sine, along.cosine) - limb.number("zero"), rod, dot(rod, motion)};
}

/// |d - s v| = l gives rod.(d(d) - v ds) = 0.
Closed closed_carriage(const Constants& limb, const Vector<Expression>& d, double ahead) {
  const Vector<Expression> v = limb.vector("v");
  const Expression side(ahead), growth = limb.number("growth");
  const Expression place = side * close_on_rail(RailReach<Expression>{.radial = dot(d, limb.vector("u")),
                                                                      .normal = side * dot(d, v),
                                                                      .axial = dot(d, limb.vector("w")),
                                                                      .arm = Expression(0.0),
                                                                      .rod = limb.number("rod")});
  const Vector<Expression> rod = sum(d, v, -place);
  return {(place - limb.number("zero")) / growth, rod, dot(rod, v) * growth};
}

Closed closed(const Limb& limb, const Constants& constants, const Vector<Expression>& d) {
  switch (limb.actuator) {
    case Actuator::crank:
      return closed_crank(constants, d);
    case Actuator::carriage:
      return closed_carriage(constants, d, limb.ahead);
    default:
      return closed_strut(constants, d);
  }
}

struct JointMotion {
  Expression joint;
  Expressions by_pose;  ///< its derivative by what is free of x, y, z, tilt_x, tilt_y, tilt_z
};

/// dR p = axis x R p d(tilt), about the axes that the angles turn; as plate_rotation() has it.
std::array<Vector<Expression>, 3> tilt_axes(const ArmDirection<Expression>& a, const PlateColumns<Expression>& plate) {
  const Expression zero(0.0);
  return {Vector<Expression>{Expression(1.0), zero, zero}, {zero, a.cosine, a.sine}, plate.z};
}

/// A coordinate of the pose; a number where guides hold it.
Expression coordinate(const Machine& machine, std::size_t k) {
  if (machine.freedoms.free.at(k)) return input("pose", k);
  return Expression(k == 2 ? machine.guided_z : 0.0);
}

/// Cosine and sine of one of the plate's angles.
ArmDirection<Expression> turn_about(const Machine& machine, std::size_t axis) {
  if (!machine.freedoms.free.at(3 + axis)) return {Expression(1.0), Expression(0.0)};
  const Expression angle = input("pose", 3 + axis);
  return {cos(angle), sin(angle)};
}

std::vector<JointMotion> motions(const Machine& machine) {
  const auto turn = [&](std::size_t axis) { return turn_about(machine, axis); };
  const ArmDirection<Expression> about_x = turn(0);
  const PlateFrame<Expression> plate{plate_columns(about_x, turn(1), turn(2))};
  const Vector<Expression> position{coordinate(machine, 0), coordinate(machine, 1), coordinate(machine, 2)};
  const std::array<Vector<Expression>, 3> axes = tilt_axes(about_x, plate);
  std::vector<JointMotion> all;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Constants constants(machine.limbs[i], i);
    const Vector<Expression> lever = plate.turned(constants.vector("plate"));
    const Vector<Expression> d = sum(sum(position, lever), constants.vector("base"), Expression(-1.0));
    const Closed limb = closed(machine.limbs[i], constants, d);
    JointMotion motion{limb.joint, {}};
    const Vector<Expression> along = scaled(limb.rod, Expression(1.0) / limb.by_joint);
    const Vector<Expression> moment = cross(lever, along);
    for (std::size_t k = 0; k < 3; ++k) {
      if (machine.freedoms.free.at(k)) motion.by_pose.push_back(along[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (machine.freedoms.free.at(3 + k)) motion.by_pose.push_back(dot(axes[k], moment));
    }
    all.push_back(std::move(motion));
  }
  return all;
}

}  // namespace

std::vector<LimbConstant> constants_of(const Limb& limb) {
  const auto vector = [](const auto& v) { return std::vector{v(0), v(1), v(2)}; };
  std::vector<LimbConstant> all{{"base", "joint at the base, in the base frame, mm", vector(limb.base)},
                                {"plate", "joint at the plate, in the plate frame, mm", vector(limb.plate)}};
  if (limb.is_strut()) {
    all.push_back({"length", "distance of the joints with the drive at zero, mm", {rods_at(limb, 0.0)[0]}});
    all.push_back({"growth", "mm per mm of the drive", {limb.gain}});
    return all;
  }
  const bool swings = limb.actuator == Actuator::crank;
  all.push_back(
      {"u", swings ? "direction of the arm at zero" : "perpendicular to the rail, as w", vector(limb.frame.col(0))});
  all.push_back({"v", swings ? "direction in which it moves from zero" : "along the rail", vector(limb.frame.col(1))});
  if (swings) {
    all.push_back({"arm", "length of the arm, mm", {limb.arm}});
  } else {
    all.push_back({"w", "perpendicular to both", vector(limb.frame.col(2))});
    all.push_back({"growth", "mm per mm of the drive", {limb.gain}});
  }
  all.push_back({"rod", "length of the rod, mm", {limb.rod[0]}});
  all.push_back({"zero", "joint coordinate with the drive at zero", {limb.joint_offset}});
  return all;
}

RecordedRods record_single_rods(const Machine& machine) {
  Expressions joints, rows;
  for (const JointMotion& motion : motions(machine)) {
    joints.push_back(motion.joint);
    rows.insert(rows.end(), motion.by_pose.begin(), motion.by_pose.end());
  }
  return {.joints = Procedure({{"joints", joints}}), .rows = Procedure({{"joints", joints}, {"rows", rows}})};
}

std::vector<SelfTestCase> single_rod_self_test(const Robot& robot, const Machine& machine) {
  const Workspace& workspace = robot.workspace();
  const std::vector<Eigen::Vector3d> tilts = workspace.tilts();
  std::vector<Pose> poses{{workspace.centre()}};
  constexpr std::size_t kFewest = 7;  // on the rims
  const std::size_t count = std::max(kFewest, tilts.size());
  for (std::size_t k = 0; k < count; ++k) {
    const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    poses.push_back({workspace.at(1.0, azimuth, k % 2 == 0 ? 0.0 : 1.0), 0.0, tilts[k % tilts.size()]});
  }
  std::vector<SelfTestCase> cases;
  for (const Pose& pose : poses) {
    const InverseResult found = inverse(machine, pose);
    if (!found.ok()) throw Unreachable("the calibrated machine does not reach all of its workspace");
    cases.push_back({pose, found.joints});
  }
  return cases;
}

}  // namespace paracal::compensation_detail

#include "simbody_assembly.hpp"

#include <SimTKsimbody.h>

#include <vector>

namespace paracal::test {
namespace {

SimTK::Vec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

SimTK::Rotation rotation(const std::array<double, 9>& rows) {
  SimTK::Mat33 matrix;
  for (int k = 0; k < 9; ++k) matrix(k / 3, k % 3) = rows[static_cast<std::size_t>(k)];
  return SimTK::Rotation(matrix);
}

struct Mechanism {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::Body::Rigid body{SimTK::MassProperties(1.0, SimTK::Vec3(0), SimTK::Inertia(1.0))};
  SimTK::MobilizedBody::Free plate{matter.Ground(), SimTK::Transform(), body, SimTK::Transform()};

  SimTK::MobilizedBody driven(const AssembledLimb& limb) {
    const SimTK::Transform at(rotation(limb.frame), vector(limb.base));
    SimTK::MobilizedBody& ground = matter.updGround();
    switch (limb.motor) {
      case AssembledLimb::Motor::turns:
        return SimTK::MobilizedBody::Pin(ground, at, body, SimTK::Transform());
      case AssembledLimb::Motor::pushes:
        return SimTK::MobilizedBody::Slider(ground, at, body, SimTK::Transform());
      default:
        return SimTK::MobilizedBody::Weld(ground, at, body, SimTK::Transform());
    }
  }

  void guide(const AssembledGuides& guides) {
    SimTK::MobilizedBody& ground = matter.updGround();
    const SimTK::UnitVec3 x(SimTK::XAxis), y(SimTK::YAxis), z(SimTK::ZAxis);
    if (!guides.free[2]) SimTK::Constraint::PointInPlane(ground, z, guides.z, plate, SimTK::Vec3(0));
    if (guides.free[3]) return;
    SimTK::Constraint::ConstantAngle(ground, x, plate, z);  // square to each other
    SimTK::Constraint::ConstantAngle(ground, y, plate, z);
    if (!guides.free[5]) SimTK::Constraint::ConstantAngle(ground, x, plate, y);
  }
};

}  // namespace

AssembledPlate assemble(const std::vector<AssembledLimb>& limbs, const AssembledGuides& guides,
                        const AssembledPlate& near) {
  Mechanism mechanism;
  mechanism.guide(guides);
  std::vector<SimTK::MobilizedBody> driven;
  for (const AssembledLimb& limb : limbs) {
    driven.push_back(mechanism.driven(limb));
    SimTK::Constraint::Rod(driven.back(), SimTK::Vec3(limb.arm, 0, 0), mechanism.plate, vector(limb.plate),
                           limb.length);
  }
  SimTK::State state = mechanism.system.realizeTopology();
  mechanism.plate.setQToFitTransform(state, SimTK::Transform(rotation(near.rotation), vector(near.position)));
  SimTK::Assembler assembler(mechanism.system);
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    if (limbs[i].motor == AssembledLimb::Motor::none) continue;
    driven[i].setOneQ(state, 0, limbs[i].coordinate);
    assembler.lockMobilizer(driven[i]);
  }
  mechanism.system.realize(state, SimTK::Stage::Position);
  assembler.setErrorTolerance(1e-14);
  assembler.assemble(state);
  mechanism.system.realize(state, SimTK::Stage::Position);
  const SimTK::Transform& found = mechanism.plate.getBodyTransform(state);
  AssembledPlate there{};
  const SimTK::Mat33& turned = found.R();
  for (int k = 0; k < 9; ++k) there.rotation[static_cast<std::size_t>(k)] = turned(k / 3, k % 3);
  for (int k = 0; k < 3; ++k) there.position[static_cast<std::size_t>(k)] = found.p()[k];
  return there;
}

}  // namespace paracal::test

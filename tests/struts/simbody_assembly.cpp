#include "simbody_assembly.hpp"

#include <SimTKsimbody.h>

namespace paracal::test {
namespace {

SimTK::Vec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

AssembledPlate assemble(const std::array<AssembledRod, 6>& rods, const AssembledPlate& near) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  const SimTK::Body::Rigid body(SimTK::MassProperties(1.0, SimTK::Vec3(0), SimTK::Inertia(1.0)));
  SimTK::MobilizedBody::Free plate(matter.Ground(), SimTK::Transform(), body, SimTK::Transform());
  for (const AssembledRod& rod : rods) {
    SimTK::Constraint::Rod(matter.Ground(), vector(rod.base), plate, vector(rod.plate), rod.length);
  }
  SimTK::State state = system.realizeTopology();
  SimTK::Mat33 rotation;
  for (int k = 0; k < 9; ++k) rotation(k / 3, k % 3) = near.rotation[static_cast<std::size_t>(k)];
  plate.setQToFitTransform(state, SimTK::Transform(SimTK::Rotation(rotation), vector(near.position)));
  system.realize(state, SimTK::Stage::Position);
  SimTK::Assembler assembler(system);
  assembler.setErrorTolerance(1e-14);
  assembler.assemble(state);
  system.realize(state, SimTK::Stage::Position);
  const SimTK::Transform& found = plate.getBodyTransform(state);
  AssembledPlate there{};
  const SimTK::Mat33& turned = found.R();
  for (int k = 0; k < 9; ++k) there.rotation[static_cast<std::size_t>(k)] = turned(k / 3, k % 3);
  for (int k = 0; k < 3; ++k) there.position[static_cast<std::size_t>(k)] = found.p()[k];
  return there;
}

}  // namespace paracal::test

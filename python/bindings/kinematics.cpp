#include <algorithm>

#include "arrays.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "rooms.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

// paracal/kinematics.py names these codes.
static_assert(static_cast<int>(InverseStatus::reached) == 0 && static_cast<int>(InverseStatus::unreachable) == 1 &&
              static_cast<int>(InverseStatus::not_converged) == 2);
static_assert(static_cast<int>(ForwardStatus::converged) == 0 && static_cast<int>(ForwardStatus::strained) == 1 &&
              static_cast<int>(ForwardStatus::singular) == 2 && static_cast<int>(ForwardStatus::not_converged) == 3);

constexpr std::size_t kRows = 7;  // x, y, z, phi, tilt_x, tilt_y, tilt_z

template <typename Status>
std::uint8_t code(Status status) {
  return static_cast<std::uint8_t>(status);
}

py::tuple inverse_of(const BuiltMachine& built, const Array& poses) {
  const Rows wanted(poses, "poses", 4);
  const std::size_t limbs = built.robot.limb_count();
  Array joints({wanted.count(), limbs});
  Codes status(static_cast<py::ssize_t>(wanted.count()));
  double* to = joints.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const py::gil_scoped_release released;
    for (std::size_t k = 0; k < wanted.count(); ++k) {
      const InverseResult found = inverse(built.machine, pose_of(wanted[k]));
      codes[k] = code(found.status);
      for (std::size_t limb = 0; limb < limbs; ++limb) {
        *to++ = found.ok() ? found.joints[static_cast<Eigen::Index>(limb)] : kNaN;
      }
    }
  }
  return py::make_tuple(joints, status);
}

/// x, y, z, phi, tilt_x, tilt_y, tilt_z of a plate.
void write_plate(const Machine& machine, const PlateState& plate, double* pose, double* tilt) {
  write_pose({plate.position, machine.rotation_of(plate.slide)}, pose);
  std::ranges::copy(plate.tilt, tilt);
}

py::tuple forward_of(const BuiltMachine& built, const Array& joints) {
  const Rows given(joints, "joints", built.robot.limb_count());
  const std::size_t n = given.count();
  Array poses({n, std::size_t{4}}), tilts({n, std::size_t{3}}), residuals(static_cast<py::ssize_t>(n));
  py::array_t<int> iterations(static_cast<py::ssize_t>(n));
  Codes status(static_cast<py::ssize_t>(n));
  double *pose = poses.mutable_data(), *tilt = tilts.mutable_data(), *residual = residuals.mutable_data();
  int* steps = iterations.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const py::gil_scoped_release released;
    for (std::size_t k = 0; k < n; ++k) {
      const ForwardResult found = forward(built.machine, joints_of(given[k], built.robot.limb_count()));
      codes[k] = code(found.status);
      residual[k] = found.residual;
      steps[k] = found.iterations;
      write_plate(built.machine, found.plate, pose + 4 * k, tilt + 3 * k);
      if (found.usable()) continue;
      std::fill_n(pose + 4 * k, 4, kNaN);
      std::fill_n(tilt + 3 * k, 3, kNaN);
    }
  }
  return py::make_tuple(poses, tilts, residuals, iterations, status);
}

/// d(x, y, z, phi, tilt_x, tilt_y, tilt_z) / d(source errors, 14 a limb) at one set of joints.
ForwardStatus write_jacobian(const Machine& machine, const Joints& joints, double* to) {
  const std::size_t columns = machine.limb_count * kSourceCount;
  std::fill_n(to, kRows * columns, kNaN);
  const ForwardResult found = forward(machine, joints);
  if (!found.usable()) return found.status;
  const ExactJacobian exact = exact_jacobian(machine, found.plate, joints);
  if (!exact.ok) return ForwardStatus::singular;
  const Eigen::Index tilt = machine.has_slide() ? 4 : 3;
  for (std::size_t column = 0; column < columns; ++column) {
    const auto at = static_cast<Eigen::Index>(column);
    for (std::size_t k = 0; k < 3; ++k) {
      to[k * columns + column] = exact.plate(static_cast<Eigen::Index>(k), at);
      to[(4 + k) * columns + column] = exact.plate(tilt + static_cast<Eigen::Index>(k), at);
    }
    to[3 * columns + column] = machine.has_slide() ? machine.rotation_of(exact.plate(3, at)) : 0.0;
  }
  return found.status;
}

py::tuple jacobian_of(const BuiltMachine& built, const Array& joints) {
  const std::size_t limbs = built.robot.limb_count();
  const Rows given(joints, "joints", limbs);
  Array jacobians({given.count(), kRows, limbs, kSourceCount});
  Codes status(static_cast<py::ssize_t>(given.count()));
  double* to = jacobians.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const py::gil_scoped_release released;
    for (std::size_t k = 0; k < given.count(); ++k) {
      codes[k] = code(write_jacobian(built.machine, joints_of(given[k], limbs), to));
      to += kRows * limbs * kSourceCount;
    }
  }
  return py::make_tuple(jacobians, status);
}

}  // namespace

void add_kinematics(py::module_& module) {
  module.def("inverse", &inverse_of, "machine"_a, "poses"_a);
  module.def("forward", &forward_of, "machine"_a, "joints"_a);
  module.def("jacobian", &jacobian_of, "machine"_a, "joints"_a);
}

}  // namespace paracal::python

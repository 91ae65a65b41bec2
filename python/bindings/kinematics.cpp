#include <algorithm>
#include <optional>

#include "arrays.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/drive.hpp"
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

template <typename Status>
std::uint8_t code(Status status) {
  return static_cast<std::uint8_t>(status);
}

py::tuple inverse_of(const BuiltMachine& built, const Array& poses) {
  const std::size_t limbs = built.robot.limb_count(), width = pose_width(built.robot);
  const Rows wanted(poses, "poses", width);
  Array joints({wanted.count(), limbs});
  Codes status(static_cast<py::ssize_t>(wanted.count()));
  double* to = joints.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const Released released;
    for (std::size_t k = 0; k < wanted.count(); ++k) {
      let_interrupt();
      const InverseResult found = inverse(built.machine, pose_of(wanted[k], width));
      codes[k] = code(found.status);
      for (std::size_t limb = 0; limb < limbs; ++limb) {
        *to++ = found.ok() ? found.joints[static_cast<Eigen::Index>(limb)] : kNaN;
      }
    }
  }
  return py::make_tuple(joints, status);
}

/// NaN where no plate stands.
void write_plate(const Machine& machine, const std::optional<PlateState>& plate, std::size_t width, double* pose,
                 double* tilt) {
  std::fill_n(pose, width, kNaN);
  std::fill_n(tilt, 3, kNaN);
  if (!plate) return;
  write_pose(paracal::pose_of(machine, *plate), pose, width);
  std::ranges::copy(plate->tilt, tilt);
}

py::tuple forward_of(const BuiltMachine& built, const Array& joints) {
  const Rows given(joints, "joints", built.robot.limb_count());
  const std::size_t n = given.count(), width = pose_width(built.robot);
  Array poses({n, width}), tilts({n, std::size_t{3}}), residuals(static_cast<py::ssize_t>(n));
  py::array_t<int> iterations(static_cast<py::ssize_t>(n));
  Codes status(static_cast<py::ssize_t>(n));
  double *pose = poses.mutable_data(), *tilt = tilts.mutable_data(), *residual = residuals.mutable_data();
  int* steps = iterations.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const Released released;
    for (std::size_t k = 0; k < n; ++k) {
      let_interrupt();
      const ForwardResult found = forward(built.machine, joints_of(given[k], built.robot.limb_count()));
      codes[k] = code(found.status);
      residual[k] = found.residual;
      steps[k] = found.iterations;
      const auto plate = found.usable() ? std::optional(found.plate) : std::nullopt;
      write_plate(built.machine, plate, width, pose + width * k, tilt + 3 * k);
    }
  }
  return py::make_tuple(poses, tilts, residuals, iterations, status);
}

py::tuple driven(const BuiltMachine& built, const Array& poses) {
  const std::size_t width = pose_width(built.robot);
  const Rows wanted(poses, "poses", width);
  Array taken({wanted.count(), width}), tilts({wanted.count(), std::size_t{3}});
  double *pose = taken.mutable_data(), *tilt = tilts.mutable_data();
  {
    const Released released;
    for (std::size_t k = 0; k < wanted.count(); ++k) {
      let_interrupt();
      const auto plate = drive(built.machine, built.robot.nominal(), pose_of(wanted[k], width));
      write_plate(built.machine, plate, width, pose + width * k, tilt + 3 * k);
    }
  }
  return py::make_tuple(taken, tilts);
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// d(pose, tilt) / d(joints) and / d(source errors) of machines of a robot: rows x, y, z, phi, tilt_x, tilt_y, tilt_z,
/// without phi where the plate has six freedoms. A joint's column is that of its zero, times the gain of its drive and
/// what its screw or encoder makes of a motion there.
class Derivatives {
 public:
  explicit Derivatives(const BuiltMachine& built) : machine_(differentiable(built.robot, built.errors)) {
    if (built.robot.commands_tilt()) std::erase(rows_, 3);
    for (std::size_t limb = 0; limb < built.robot.limb_count(); ++limb) {
      for (const Source source : sources_of(built.robot.limbs())) {
        if (place_in(machine_.limbs[limb].actuator, source) < kMostSources) {
          sources_.push_back({limb, source});
          columns_.push_back(column_count_);
        }
        ++column_count_;
      }
    }
  }

  std::size_t rows() const { return rows_.size(); }

  /// NaN where there are none.
  ForwardStatus write(const Joints& joints, double* to_joints, double* to_errors) const {
    const auto rows = static_cast<Eigen::Index>(rows_.size());
    Eigen::Map<RowMajor> by_joint(to_joints, rows, joints.size()), by_error(to_errors, rows, column_count_);
    by_joint.setConstant(kNaN);
    by_error.setConstant(kNaN);
    const ForwardResult found = forward(machine_, joints);
    if (!found.usable()) return found.status;
    const PlateMotions motions = plate_jacobian(machine_, found.plate, joints, sources_);
    if (motions.cols() == 0) return ForwardStatus::singular;
    by_error.setZero();
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      const std::size_t limb = sources_[k].limb;
      by_error.col(columns_[k]) = motions(rows_, static_cast<Eigen::Index>(k));
      if (!is_joint_zero(sources_[k].source)) continue;
      const auto at = static_cast<Eigen::Index>(limb);
      const Limb& drive = machine_.limbs[limb];
      by_joint.col(at) = drive.gain() * drive.turn.rate(joints(at)) * by_error.col(columns_[k]);
    }
    return found.status;
  }

 private:
  DifferentiableMachine machine_;
  std::vector<SoughtSource> sources_;  ///< what moves a plate: every source error of every limb
  std::vector<Eigen::Index> columns_;  ///< of each; zero are those of errors that a limb does not have
  Eigen::Index column_count_ = 0;
  std::vector<int> rows_{0, 1, 2, 3, 4, 5, 6};
};

py::tuple jacobian_of(const BuiltMachine& built, const Array& joints) {
  const std::size_t limbs = built.robot.limb_count(), sources = sources_of(built.robot.limbs()).size();
  const Rows given(joints, "joints", limbs);
  const Derivatives derivatives(built);
  const std::size_t rows = derivatives.rows();
  Array by_joint({given.count(), rows, limbs}), by_error({given.count(), rows, limbs, sources});
  Codes status(static_cast<py::ssize_t>(given.count()));
  double *to_joints = by_joint.mutable_data(), *to_errors = by_error.mutable_data();
  std::uint8_t* codes = status.mutable_data();
  {
    const Released released;
    for (std::size_t k = 0; k < given.count(); ++k) {
      let_interrupt();
      codes[k] = code(derivatives.write(joints_of(given[k], limbs), to_joints, to_errors));
      to_joints += rows * limbs;
      to_errors += rows * limbs * sources;
    }
  }
  return py::make_tuple(by_joint, by_error, status);
}

}  // namespace

void add_kinematics(py::module_& module) {
  module.def("inverse", &inverse_of, "machine"_a, "poses"_a);
  module.def("forward", &forward_of, "machine"_a, "joints"_a);
  module.def("drive", &driven, "machine"_a, "poses"_a);
  module.def("jacobian", &jacobian_of, "machine"_a, "joints"_a);
}

}  // namespace paracal::python

#include <algorithm>

#include "arrays.hpp"
#include "options.hpp"
#include "paracal/compensation/parameters.hpp"
#include "rooms.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

// paracal/compensation.py names these codes.
static_assert(static_cast<int>(CompensationStatus::ok) == 0 && static_cast<int>(CompensationStatus::unreachable) == 1 &&
              static_cast<int>(CompensationStatus::not_finite) == 2 &&
              static_cast<int>(CompensationStatus::singular) == 3);

CompensationWay way_of(const Keywords& given) {
  CompensationWay way = CompensationWay::exact;
  given.choose("way",
               {{"exact", CompensationWay::exact},
                {"tilt-aware", CompensationWay::tilt_aware},
                {"linear", CompensationWay::linear}},
               way);
  return way;
}

/// Where the answers for the poses go, a row each.
struct Answers {
  double *joints, *targets, *tilts, *uncertainties;
  std::uint8_t* status;
};

/// Commands and targets for poses, one after the other.
class Path {
 public:
  Path(const KnownMachine& machine, CompensationWay way)
      : robot_(machine.robot), compensator_(compensator_parameters(machine.robot, machine.known.errors), way) {
    if (machine.known.covariance.size() == 0) return;
    covariance_ = compensator_covariance(robot_, machine.known.parameters, machine.known.pose_covariance());
  }

  /// Writes nothing but the status where there is no answer.
  void compensate(const Pose& pose, std::size_t row, const Answers& to) const {
    CompensatorJoints<double> joints{};
    CompensatorTilt<double> tilt;
    CompensationStatus status = compensator_.compensate(compensator_pose(pose), joints, &tilt);
    std::optional<Pose> target;
    if (status == CompensationStatus::ok) {
      target = corrected_target(robot_, compensated_joints(robot_, joints), pose);
      if (!target) status = CompensationStatus::singular;
    }
    to.status[row] = static_cast<std::uint8_t>(status);
    if (!target) return;
    std::copy_n(joints.begin(), robot_.limb_count(), to.joints + robot_.limb_count() * row);
    write_pose(*target, to.targets + 4 * row);
    to.tilts[2 * row] = tilt.eps_x;
    to.tilts[2 * row + 1] = tilt.eps_y;
    write_uncertainty(pose, to.uncertainties + 4 * row);
  }

 private:
  void write_uncertainty(const Pose& pose, double* to) const {
    CompensatorUncertainty<double> U;
    if (!covariance_) return;
    const CompensationStatus status =
        stated_uncertainty(compensator_.parameters(), *covariance_, compensator_pose(pose), U);
    if (status == CompensationStatus::ok) std::ranges::copy(std::array{U.x, U.y, U.z, U.phi}, to);
  }

  const Robot& robot_;
  Compensator<double> compensator_;
  std::optional<CompensatorCovariance<double>> covariance_ = {};
};

py::tuple compensated(const KnownMachine& machine, const Array& poses, const py::dict& keywords) {
  const Rows wanted(poses, "poses", 4);
  const CompensationWay way = way_of(Keywords(keywords));
  const std::size_t n = wanted.count();
  Array joints({n, machine.robot.limb_count()}), targets({n, std::size_t{4}}), tilts({n, std::size_t{2}}),
      uncertainties({n, std::size_t{4}});
  Codes status(static_cast<py::ssize_t>(n));
  const Answers to{joints.mutable_data(), targets.mutable_data(), tilts.mutable_data(), uncertainties.mutable_data(),
                   status.mutable_data()};
  for (Array* array : {&joints, &targets, &tilts, &uncertainties}) {
    std::fill_n(array->mutable_data(), array->size(), kNaN);
  }
  {
    const py::gil_scoped_release released;
    const Path path(machine, way);
    for (std::size_t k = 0; k < n; ++k) path.compensate(pose_of(wanted[k]), k, to);
  }
  return py::make_tuple(joints, targets, tilts, uncertainties, status);
}

/// Errors without uncertainty, as of a file of source errors.
KnownMachine exactly_known(const BuiltMachine& machine) {
  KnownMachine known{machine.robot, {}, {}};
  known.known.errors = machine.errors;
  return known;
}

}  // namespace

void add_compensation(py::module_& module) {
  module.def("exactly_known", &exactly_known, "machine"_a);
  module.def("compensate", &compensated, "machine"_a, "poses"_a, "keywords"_a);
}

}  // namespace paracal::python

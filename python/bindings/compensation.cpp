#include <algorithm>

#include "arrays.hpp"
#include "options.hpp"
#include "paracal/compensation/pose_correction.hpp"
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

/// Row by row; where there is no answer nothing but the status.
class AnswerRows {
 public:
  AnswerRows(const Robot& robot, const Answers& to) : limbs_(robot.limb_count()), width_(pose_width(robot)), to_(to) {}

  void write(const CorrectedPose& found, std::size_t row) const {
    const bool has_no_target = found.status == CompensationStatus::ok && !found.target;
    to_.status[row] = static_cast<std::uint8_t>(has_no_target ? CompensationStatus::singular : found.status);
    if (!found.target) return;
    std::ranges::copy(found.joints, to_.joints + limbs_ * row);
    write_pose(*found.target, to_.targets + width_ * row, width_);
    to_.tilts[2 * row] = found.tilt.eps_x;
    to_.tilts[2 * row + 1] = found.tilt.eps_y;
    if (!found.uncertainty) return;
    const auto& [position, rotation, tilt] = *found.uncertainty;
    write_pose({position, rotation, tilt.value_or(Eigen::Vector3d::Zero())}, to_.uncertainties + width_ * row, width_);
  }

 private:
  std::size_t limbs_, width_;
  Answers to_;
};

py::tuple compensated(const KnownMachine& machine, const Array& poses, const py::dict& keywords) {
  const std::size_t width = pose_width(machine.robot);
  const Rows wanted(poses, "poses", width);
  const CompensationWay way = way_of(Keywords(keywords));
  const std::size_t n = wanted.count();
  Array joints({n, machine.robot.limb_count()}), targets({n, width}), tilts({n, std::size_t{2}}),
      uncertainties({n, width});
  Codes status(static_cast<py::ssize_t>(n));
  const Answers to{joints.mutable_data(), targets.mutable_data(), tilts.mutable_data(), uncertainties.mutable_data(),
                   status.mutable_data()};
  for (Array* array : {&joints, &targets, &tilts, &uncertainties}) {
    std::fill_n(array->mutable_data(), array->size(), kNaN);
  }
  {
    const Released released;
    const PoseCorrector corrected =
        pose_corrector(machine.robot, machine.known, way, machine.controller.computes_with(machine.robot));
    const AnswerRows rows(machine.robot, to);
    for (std::size_t k = 0; k < n; ++k) {
      let_interrupt();
      rows.write(corrected(pose_of(wanted[k], width)), k);
    }
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

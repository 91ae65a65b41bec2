#include "paracal/calibration/calibration.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "options.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/measurement_files.hpp"
#include "rooms.hpp"
#include "state.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

Calibration calibrated(const Robot& robot, const GivenMeasurements& given, const py::dict& keywords) {
  require_robot(robot, given);
  CalibrationOptions options = calibration_options(robot, Keywords(keywords));
  if (given.readings.series.empty()) options.frame = Frame::unknown;  // distances have none
  const Released released;
  return calibrate(robot, given.readings, options);
}

/// As files are written.
std::string json_text(const io::Json& json) {
  return json.dump(2, ' ', false, io::Json::error_handler_t::replace) + "\n";
}

/// One number of every parameter; NaN where there is none.
template <typename Number>
Array of_parameters(const Calibration& calibration, Number number) {
  std::vector<double> numbers;
  for (const ParameterEstimate& one : calibration.parameters) numbers.push_back(number(one));
  return vector_of(numbers);
}

template <typename Parameter>
py::list parameters_of(const Robot& robot, const std::vector<Parameter>& parameters) {
  py::list list;
  for (const Parameter& one : parameters) {
    list.append(
        py::make_tuple(std::string(name(one.source)), one.limb + 1, array_unit(unit(one.source, robot.actuator()))));
  }
  return list;
}

py::list null_space_of(const std::vector<NullDirection>& directions) {
  py::list list;
  for (const NullDirection& one : directions)
    list.append(py::make_tuple(one.text, vector_of(one.direction), one.gauge));
  return list;
}

KnownMachine known_of(const Calibration& calibration) {
  return {calibration.robot, known_errors(calibration), calibration.files, calibration.options.controller};
}

/// @param robot  that it must be of; none: the one that the file carries.
KnownMachine read_calibration(const std::string& path, const std::optional<Robot>& robot) {
  const io::JsonFile file(io::read_stored(path));
  const Robot of = robot ? *robot : io::robot_of_calibration(file).robot;
  io::CalibratedMachine machine = io::read_calibration(file, of);
  return {of, machine.known(), std::move(machine.inputs), std::move(machine.controller)};
}

/// The JSON object of `paracal validate --json`.
std::string validated(const KnownMachine& machine, const GivenMeasurements& given, const py::dict& keywords) {
  require_robot(machine.robot, given);
  ValidationOptions options = validation_options(Keywords(keywords));
  options.controller = machine.controller;
  const Released released;
  const auto& controller = machine.controller.robot;
  const Measurements readings = controller ? commanded_by(*controller, given.readings) : given.readings;
  Validation found = validate(machine.robot, machine.known, readings, options);
  for (const std::string& file : io::used_before(machine.inputs, given.readings, given.tables)) {
    found.refuse(io::confirms_nothing(file));
  }
  return io::to_json(found).dump(-1, ' ', false, io::Json::error_handler_t::replace);
}

/// Poses (n, width) that the machine takes at joints, their covariance (n, width, width), and whether it closes there.
py::tuple predicted(const KnownMachine& machine, const Array& joints) {
  const std::size_t limbs = machine.robot.limb_count(), width = pose_width(machine.robot);
  const Rows given(joints, "joints", limbs);
  Array poses({given.count(), width}), covariances({given.count(), width, width});
  py::array_t<bool> closes(static_cast<py::ssize_t>(given.count()));
  double *pose = poses.mutable_data(), *covariance = covariances.mutable_data();
  bool* ok = closes.mutable_data();
  {
    const Released released;
    std::fill_n(pose, poses.size(), kNaN);
    std::fill_n(covariance, covariances.size(), kNaN);
    for (std::size_t k = 0; k < given.count(); ++k, pose += width, covariance += width * width) {
      let_interrupt();
      ok[k] = false;
      try {
        const PredictedPose found = predict(machine.robot, machine.known, joints_of(given[k], limbs));
        write_pose(found.pose, pose, width);
        std::ranges::copy(found.covariance.reshaped(), covariance);  // symmetric
        ok[k] = true;
      } catch (const Unreachable&) {  // NaN says so
      }
    }
  }
  return py::make_tuple(poses, covariances, closes);
}

/// Its errors of parts, which stand before the splines of drives.
std::vector<SoughtSource> parts_of(const KnownErrors& known) {
  std::vector<SoughtSource> parts = known.parameters;
  std::erase_if(parts, [](const SoughtSource& one) { return one.knot.has_value(); });
  return parts;
}

}  // namespace

void add_calibration(py::module_& module) {
  class_of_states<KnownMachine>(module, "KnownMachine")
      .def_readonly("robot", &KnownMachine::robot)
      .def_property_readonly("errors", [](const KnownMachine& m) { return array_of(m.known.errors, m.robot); })
      .def_property_readonly("parameters",
                             [](const KnownMachine& m) { return parameters_of(m.robot, parts_of(m.known)); })
      .def_property_readonly("covariance",
                             [](const KnownMachine& m) {
                               const auto n = m.known.covariance.size() > 0 ? std::ssize(parts_of(m.known)) : 0;
                               return array_of(m.known.covariance.topLeftCorner(n, n));
                             })
      .def("predict", &predicted, "joints"_a);
  class_of_states<Calibration>(module, "Calibration")
      .def_property_readonly("robot", [](const Calibration& found) { return found.robot; })
      .def_property_readonly("verdict", [](const Calibration& found) { return std::string(name(found.verdict)); })
      .def_property_readonly("reasons", [](const Calibration& found) { return texts_of(found.reasons); })
      .def_property_readonly("notes", [](const Calibration& found) { return texts_of(found.notes); })
      .def_property_readonly("assumed", [](const Calibration& found) { return texts_of(found.assumed); })
      .def_property_readonly("parameters",
                             [](const Calibration& found) { return parameters_of(found.robot, found.parameters); })
      .def_property_readonly("values",
                             [](const Calibration& found) {
                               return of_parameters(found, [](const ParameterEstimate& one) { return one.value; });
                             })
      .def_property_readonly("std",
                             [](const Calibration& found) {
                               return of_parameters(
                                   found, [](const ParameterEstimate& one) { return one.std.value_or(kNaN); });
                             })
      .def_property_readonly("k",
                             [](const Calibration& found) {
                               return of_parameters(found, [](const ParameterEstimate& one) { return one.coverage(); });
                             })
      .def_property_readonly("data_share",
                             [](const Calibration& found) {
                               return of_parameters(found, [](const ParameterEstimate& one) { return one.data_share; });
                             })
      .def_property_readonly("identified",
                             [](const Calibration& found) {
                               std::vector<bool> identified;
                               for (const ParameterEstimate& one : found.parameters)
                                 identified.push_back(one.identified());
                               return identified;
                             })
      .def_property_readonly("held",
                             [](const Calibration& found) {
                               std::vector<bool> held;
                               for (const ParameterEstimate& one : found.parameters) held.push_back(one.held);
                               return held;
                             })
      .def_property_readonly("covariance", [](const Calibration& found) { return array_of(found.covariance); })
      .def_property_readonly("rank", [](const Calibration& found) { return found.rank; })
      .def_property_readonly("null_space", [](const Calibration& found) { return null_space_of(found.null_space); })
      .def_property_readonly("errors", [](const Calibration& found) { return array_of(found.errors(), found.robot); })
      .def_property_readonly("noise_mm", [](const Calibration& found) { return found.noise; })
      .def_property_readonly("degrees_of_freedom", [](const Calibration& found) { return found.degrees_of_freedom; })
      .def_property_readonly("known", &known_of)
      .def(
          "correlations",
          [](const Calibration& found, double threshold) {
            std::vector<std::tuple<std::size_t, std::size_t, double>> pairs;
            for (const auto& [one, other, value] : found.correlations(threshold)) pairs.emplace_back(one, other, value);
            return pairs;
          },
          "threshold"_a)
      .def("brief", [](const Calibration& found) { return text_of(found.brief()); })
      .def(
          "json", [](const Calibration& found, std::int64_t time) { return json_text(io::to_json(found, time)); },
          "time"_a);
  module.def("calibrate", &calibrated, "robot"_a, "measurements"_a, "keywords"_a);
  module.def("validate", &validated, "machine"_a, "measurements"_a, "keywords"_a);
  module.def("read_calibration", &read_calibration, "path"_a, "robot"_a);
}

}  // namespace paracal::python

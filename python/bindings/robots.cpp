#include <pybind11/stl.h>

#include "arrays.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"
#include "rooms.hpp"
#include "state.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

BuiltMachine built(const Robot& robot, const Array& errors) {
  const SourceErrors wanted = errors_of(errors, robot);
  if (const auto complaint = implausible(robot, wanted)) throw InvalidArgument("errors: " + *complaint);
  return {robot, wanted, build(robot, wanted)};
}

/// Empty of a robot whose limbs state their own dimensions.
py::dict geometry_of(const Robot& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs());
  if (!shared) return {};
  py::dict found("base_radius_mm"_a = shared->base_radius, "plate_radius_mm"_a = shared->plate_radius,
                 "arm_mm"_a = shared->arm, "rod_mm"_a = shared->rod,
                 "parallelogram_width_mm"_a = shared->parallelogram_width,
                 "limb_azimuth_rad"_a = vector_of(shared->limb_azimuth));
  if (robot.slide()) found["pinion_radius_mm"] = robot.slide()->pinion_radius;
  return found;
}

py::dict angles_of(const Robot& robot) {
  const Workspace& workspace = robot.workspace();
  if (robot.commands_tilt()) return py::dict("tilt_rad"_a = workspace.max_tilt);
  return py::dict("rotation_rad"_a = py::make_tuple(workspace.min_rotation, workspace.max_rotation));
}

/// What a controller commands, by its names.
py::tuple freedoms_of(const Robot& robot) {
  py::list names;
  if (!robot.is_level()) {
    for (std::size_t k = 0; k < kPlateCoordinates.size(); ++k) {
      if (robot.freedoms().free.at(k)) names.append(std::string(kPlateCoordinates.at(k)));
    }
    return names;
  }
  for (const char* name : {"x", "y", "z"}) names.append(name);
  if (robot.slide()) names.append("phi");
  return names;
}

/// (name, "position" or "tilt", unit), in column order.
py::list sources_of(const Robot& robot) {
  py::list sources;
  for (const Source source : paracal::sources_of(robot.limbs())) {
    sources.append(py::make_tuple(std::string(name(source)), tilts_plate(source) ? "tilt" : "position",
                                  array_unit(unit(source, robot.actuator()))));
  }
  return sources;
}

Array drawn_errors(const Robot& robot, const Tolerances& tolerances, std::uint64_t seed, std::uint64_t first,
                   std::size_t count) {
  const auto sources = paracal::sources_of(robot.limbs());
  Array drawn({count, robot.limb_count(), sources.size()});
  double* numbers = drawn.mutable_data();
  {
    const Released released;
    for (std::size_t machine = 0; machine < count; ++machine) {
      let_interrupt();
      RandomStream random(seed, first + machine);
      const SourceErrors errors = draw_errors(robot, tolerances, random);
      for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
        for (const Source source : sources) *numbers++ = errors(limb, source);
      }
    }
  }
  return drawn;
}

SourceErrors read_errors(const Robot& robot, const std::string& path) {
  const io::TextFile file = io::read_stored(path);
  const SourceErrors errors = io::read_source_errors(file, robot.joint_space());
  if (const auto complaint = implausible(robot, errors)) throw InputFileError(file.name, 0, *complaint);
  return errors;
}

}  // namespace

void add_robots(py::module_& module) {
  class_of_states<Robot>(module, "Robot")
      .def_property_readonly("name", [](const Robot& robot) { return text_of(robot.name()); })
      .def_property_readonly("limb_count", &Robot::limb_count)
      .def_property_readonly("joint_unit", [](const Robot& robot) { return array_unit(joint_unit(robot.actuator())); })
      .def_property_readonly("guided_z", [](const Robot& robot) { return robot.joint_space().guided_z; })
      .def_property_readonly("commands_tilt", &Robot::commands_tilt)
      .def_property_readonly("freedoms", &freedoms_of)
      .def_property_readonly("rotates", [](const Robot& robot) { return robot.slide().has_value(); })
      .def_property_readonly("geometry", &geometry_of)
      .def_property_readonly("workspace_angles", &angles_of)
      .def_property_readonly("sources", &sources_of)
      .def_property_readonly("intended",
                             [](const Robot& robot) {
                               const auto shared = shared_dimensions(robot.limbs());
                               return array_of(shared ? shared->differences : SourceErrors{}, robot);
                             })
      .def("json", [](const Robot& robot) { return text_of(io::to_json(robot).dump()); })
      .def("toml", [](const Robot& robot) { return text_of(io::robot_toml(robot)); });
  module.def("machine", &built, "robot"_a, "errors"_a);
  class_of_results<BuiltMachine>(module, "Machine")
      .def("__reduce__",
           [](const BuiltMachine& machine) {
             return made_by("machine", machine.robot, array_of(machine.errors, machine.robot));
           })
      .def_readonly("robot", &BuiltMachine::robot)
      .def_property_readonly("errors",
                             [](const BuiltMachine& machine) { return array_of(machine.errors, machine.robot); })
      .def_property_readonly("tilts_plate", [](const BuiltMachine& machine) { return machine.machine.tilts_plate; });
  module.def("catalogue", [] {
    std::vector<std::string> names;
    for (const std::string_view name : catalogue::names()) names.emplace_back(name);
    return names;
  });
  module.def(
      "named_robot", [](const std::string& name) { return io::named_robot(name).robot; }, "name"_a);
  module.def(
      "robot_of_toml",
      [](const std::string& name, const std::string& text) {
        return io::read_robot({name, text});
      },
      "name"_a, "text"_a);
  module.def(
      "robot_template", [](const std::string& kind) { return text_of(io::robot_template(kind).text); }, "kind"_a);
  module.def(
      "read_errors",
      [](const Robot& robot, const std::string& path) { return array_of(read_errors(robot, path), robot); }, "robot"_a,
      "path"_a);
  module.def(
      "errors_toml",
      [](const Robot& robot, const Array& errors) {
        return io::source_errors_toml(errors_of(errors, robot), robot.joint_space());
      },
      "robot"_a, "errors"_a);
  module.def("draw_errors", &drawn_errors, "robot"_a, "tolerances"_a, "seed"_a, "first"_a, "count"_a);
}

}  // namespace paracal::python

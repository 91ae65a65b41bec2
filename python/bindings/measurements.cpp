#include "paracal/calibration/measurement.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>

#include "arrays.hpp"
#include "paracal/error.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/tables.hpp"
#include "rooms.hpp"
#include "state.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

/// The name of a table, and its text where it is no file.
using GivenTable = std::pair<std::string, std::optional<std::string>>;

io::TextFile file_of(const GivenTable& table) {
  return table.second ? io::TextFile{table.first, *table.second} : io::read_file(table.first);
}

std::vector<io::TextFile> files_of(const std::vector<GivenTable>& tables, const io::TableStyle& style) {
  std::vector<io::TextFile> files;
  files.reserve(tables.size());
  for (const GivenTable& table : tables) {
    files.push_back(file_of(table));
    files.back().style = style;
    if (table.second) files.back().style.decimal_comma = false;  // written by this program
  }
  return files;
}

void take_statement(std::optional<io::RobotStatement>& stated, const io::TextFile& file) {
  std::optional<io::RobotStatement> said = io::robot_of_table(file);
  if (!said) return;
  if (stated) return io::require_same(*stated, *said);
  stated = std::move(said);
}

GivenMeasurements read_tables(const std::vector<GivenTable>& tables, const std::vector<GivenTable>& poses,
                              const io::ExportStatement& exported, const io::TableStyle& style, const Robot* robot) {
  const std::vector<io::TextFile> files = files_of(tables, style), pose_files = files_of(poses, style);
  GivenMeasurements all;
  for (const io::TextFile& file : files) {
    all.tables.push_back(file.name);
    if (exported.is_silent()) take_statement(all.stated, file);
  }
  for (const io::TextFile& file : pose_files) take_statement(all.stated, file);
  all.readings =
      io::read_measurements(files, pose_files, exported, robot != nullptr ? robot->joint_space() : JointSpace());
  if (robot != nullptr) {
    require_robot(*robot, all);
    all.readings = with_commands(*robot, std::move(all.readings));
  }
  return all;
}

GivenMeasurements merged(const std::vector<const GivenMeasurements*>& parts) {
  GivenMeasurements all;
  std::vector<Measurements> readings;
  for (const GivenMeasurements* part : parts) {
    readings.push_back(part->readings);
    all.tables.insert(all.tables.end(), part->tables.begin(), part->tables.end());
    if (all.stated && part->stated) io::require_same(*all.stated, *part->stated);
    if (!all.stated) all.stated = part->stated;
  }
  all.readings = io::merge(std::move(readings));
  return all;
}

/// One series alone, as the tables of files hold it.
py::list tables_of(const GivenMeasurements& given, const Robot& robot) {
  py::list tables;
  const auto alone = [&](auto change) {
    Measurements part{.stations = given.readings.stations};
    change(part);
    return part;
  };
  const auto add = [&](const char* kind, const std::string& name, const std::string& table) {
    tables.append(py::make_tuple(kind, text_of(name), text_of(table)));
  };
  for (const PointSeries& series : given.readings.series) {
    if (series.readings.empty()) continue;
    add("points", series.name,
        io::point_table(alone([&](Measurements& part) { part.series = {series}; }), robot.actuator()));
  }
  if (!given.readings.distances.empty()) {
    add("distances", "distances",
        io::distance_table(alone([&](Measurements& part) { part.distances = given.readings.distances; })));
  }
  for (const LengthSeries& series : given.readings.lengths) {
    const std::string kind(words(series.kind).plural);
    add(kind.c_str(), series.name, io::length_table(alone([&](Measurements& part) { part.lengths = {series}; })));
  }
  add("poses", "poses", io::station_table(given.readings.stations));
  return tables;
}

/// The robot that is said, or that tables say they are of.
const Robot* robot_of(const Robot* said, const std::optional<io::RobotStatement>& stated) {
  return said != nullptr || !stated ? said : &stated->robot;
}

py::tuple stations_of(const GivenMeasurements& given, const Robot* robot) {
  return named_poses(given.readings.stations, robot_of(robot, given.stated));
}

py::tuple pose_table(const GivenTable& table, const io::TableStyle& style, const Robot* said) {
  const io::TextFile file = files_of({table}, style).front();
  const std::optional<io::RobotStatement> stated = io::robot_of_table(file);
  if (said != nullptr && stated) io::require_same({.robot = *said, .by = "robot"}, *stated);
  const Robot* robot = robot_of(said, stated);
  return named_poses(io::read_poses(file, robot != nullptr ? robot->joint_space() : JointSpace()), robot);
}

/// How many readings there are of each kind that was read.
py::dict counts_of(const GivenMeasurements& given) {
  py::dict counts;
  const auto add = [&](std::string_view kind, std::size_t count) {
    const py::str key{std::string(kind)};
    const std::size_t before = counts.contains(key) ? counts[key].cast<std::size_t>() : 0;
    if (count > 0) counts[key] = before + count;
  };
  for (const PointSeries& series : given.readings.series) add("points", series.readings.size());
  add("distances", given.readings.distances.size());
  for (const LengthSeries& series : given.readings.lengths) add(words(series.kind).plural, series.readings.size());
  return counts;
}

py::tuple joint_table(const GivenTable& table, const io::TableStyle& style, const Robot& robot) {
  const std::vector<io::NamedJoints> rows = io::read_joints(files_of({table}, style).front(), robot.joint_space());
  py::list names;
  Array joints({rows.size(), robot.limb_count()});
  double* to = joints.mutable_data();
  for (const io::NamedJoints& row : rows) {
    names.append(text_of(row.name));
    to = std::ranges::copy(row.joints, to).out;
  }
  return py::make_tuple(names, joints);
}

GivenMeasurements at_reference_temperature_of(GivenMeasurements given, double expansion) {
  given.readings = at_reference_temperature(std::move(given.readings), expansion);
  return given;
}

}  // namespace

void require_robot(const Robot& robot, const GivenMeasurements& given) {
  if (given.stated) io::require_same({.robot = robot, .by = "robot"}, *given.stated);
}

void add_measurements(py::module_& module) {
  class_of_states<GivenMeasurements>(module, "Measurements")
      .def("stations", &stations_of, "robot"_a)
      .def_property_readonly("counts", &counts_of)
      .def_property_readonly("notes", [](const GivenMeasurements& given) { return texts_of(given.readings.notes); })
      .def_property_readonly(
          "robot",
          [](const GivenMeasurements& g) { return g.stated ? std::optional<Robot>(g.stated->robot) : std::nullopt; })
      .def("tables", &tables_of, "robot"_a)
      .def("at_reference_temperature", &at_reference_temperature_of, "expansion"_a);
  class_of_results<io::ExportStatement>(module, "ExportStatement");
  module.def(
      "export_statement",
      [](std::string columns, std::string unit, bool by_order) {
        return io::ExportStatement{std::move(columns), std::move(unit), by_order};
      },
      "columns"_a, "unit"_a, "by_order"_a);
  class_of_results<io::TableStyle>(module, "TableStyle");
  module.def(
      "table_style",
      [](bool decimal_comma, std::vector<std::string> ignored) {
        return io::TableStyle{decimal_comma, std::move(ignored)};
      },
      "decimal_comma"_a, "ignored_columns"_a);
  module.def("read_measurements", &read_tables, "tables"_a, "poses"_a, "exported"_a, "style"_a, "robot"_a,
             py::call_guard<Released>());
  module.def("merge", &merged, "parts"_a);
  module.def("read_poses", &pose_table, "table"_a, "style"_a, "robot"_a);
  module.def("read_joints", &joint_table, "table"_a, "style"_a, "robot"_a);
}

}  // namespace paracal::python

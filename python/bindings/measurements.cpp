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

namespace paracal::python {
namespace {

using namespace py::literals;

/// The name of a table, and its text where it is no file.
using GivenTable = std::pair<std::string, std::optional<std::string>>;

io::TextFile file_of(const GivenTable& table) {
  return table.second ? io::TextFile{table.first, *table.second} : io::read_file(table.first);
}

/// Tables of poses: one for all that name poses, or one for each of them.
class PoseTables {
 public:
  explicit PoseTables(const std::vector<GivenTable>& tables) : tables_(tables) {}

  bool empty() const { return tables_.empty(); }

  io::TextFile next(const std::string& asking, std::optional<io::RobotStatement>& stated) {
    if (used_ == tables_.size() && tables_.size() != 1) {
      throw InvalidArgument(fmt::format(
          "poses: expected one table for all tables that name poses, or one for each, got {} and none for {}",
          tables_.size(), asking));
    }
    io::TextFile file = file_of(tables_[tables_.size() == 1 ? 0 : used_]);
    ++used_;
    take_statement(stated, file);
    return file;
  }

  void check_all_used() const {
    if (tables_.size() < 2 || used_ == tables_.size()) return;
    throw InvalidArgument(
        fmt::format("poses: expected a table for each of {} that name poses, got {}", used_, tables_.size()));
  }

  static void take_statement(std::optional<io::RobotStatement>& stated, const io::TextFile& file) {
    std::optional<io::RobotStatement> said = io::robot_of_table(file);
    if (!said) return;
    if (stated) return io::require_same(*stated, *said);
    stated = std::move(said);
  }

 private:
  const std::vector<GivenTable>& tables_;
  std::size_t used_ = 0;
};

GivenMeasurements read(const std::vector<GivenTable>& tables, const std::vector<GivenTable>& poses,
                       const std::optional<std::pair<std::string, std::string>>& columns, const Robot* robot) {
  const JointSpace joints = robot != nullptr ? robot->joint_space() : JointSpace();
  GivenMeasurements all;
  PoseTables pose_tables(poses);
  std::vector<Measurements> parts;
  for (const GivenTable& table : tables) {
    const io::TextFile file = file_of(table);
    if (!columns) PoseTables::take_statement(all.stated, file);
    const auto of_poses = [&] { return pose_tables.next(file.name, all.stated); };
    all.tables.push_back(file.name);
    if (columns) {
      const io::ColumnMap map = io::find_columns(file, columns->first, columns->second);
      parts.push_back(io::read_tracker_export(file, map, io::read_poses(of_poses(), joints)));
      continue;
    }
    switch (io::kind_of_table(file, !pose_tables.empty())) {
      case io::TableKind::exported:
        parts.push_back(
            io::read_tracker_export(file, io::find_columns(file, "", ""), io::read_poses(of_poses(), joints)));
        break;
      case io::TableKind::points:
        parts.push_back(io::read_points(file, joints));
        break;
      case io::TableKind::distances:
        parts.push_back(io::read_distances(file, of_poses(), joints));
        break;
      case io::TableKind::lengths:
        parts.push_back(io::read_lengths(file, of_poses(), joints));
        break;
    }
  }
  pose_tables.check_all_used();
  all.readings = parts.size() == 1 ? std::move(parts.front()) : io::merge(std::move(parts));
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

py::tuple pose_table(const GivenTable& table, const Robot* said) {
  const io::TextFile file = file_of(table);
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

py::tuple joint_table(const GivenTable& table, const Robot& robot) {
  const std::vector<io::NamedJoints> rows = io::read_joints(file_of(table), robot.joint_space());
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
  py::class_<GivenMeasurements>(module, "Measurements")
      .def("stations", &stations_of, "robot"_a)
      .def_property_readonly("counts", &counts_of)
      .def_property_readonly("notes", [](const GivenMeasurements& given) { return texts_of(given.readings.notes); })
      .def_property_readonly(
          "robot",
          [](const GivenMeasurements& g) { return g.stated ? std::optional<Robot>(g.stated->robot) : std::nullopt; })
      .def("tables", &tables_of, "robot"_a)
      .def("at_reference_temperature", &at_reference_temperature_of, "expansion"_a);
  module.def("read_measurements", &read, "tables"_a, "poses"_a, "columns"_a, "robot"_a,
             py::call_guard<py::gil_scoped_release>());
  module.def("merge", &merged, "parts"_a);
  module.def("read_poses", &pose_table, "table"_a, "robot"_a);
  module.def("read_joints", &joint_table, "table"_a, "robot"_a);
}

}  // namespace paracal::python

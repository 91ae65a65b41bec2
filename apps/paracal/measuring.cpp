#include "measuring.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/calibrations/calibration_settings.hpp"
#include "paracal/error.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

std::vector<io::TextFile> input_tables(const std::vector<std::string>& names, const io::TableStyle& style) {
  std::vector<io::TextFile> tables;
  tables.reserve(names.size());
  for (const std::string& name : names) tables.push_back(input_table(name, style));
  return tables;
}

Measurements read_tables(const MeasuringOptions& options, const JointSpace& joints) {
  const std::vector<io::TextFile> files = input_tables(options.files, options.style);
  const std::vector<io::TextFile> poses = input_tables(options.poses, options.style);
  try {
    return io::read_measurements(
        files, poses, {.columns = options.columns, .unit = options.unit, .by_order = options.match == "order"}, joints);
  } catch (const InvalidArgument& refused) {
    throw WrongUsage(std::string("--") + refused.what());  // the options have the names of the arguments
  }
}

}  // namespace

std::vector<std::string> MeasuringOptions::tables() const {
  std::vector<std::string> names = files;
  names.insert(names.end(), poses.begin(), poses.end());
  return names;
}

Measurements MeasuringOptions::read(const Robot& robot) const {
  return at_reference_temperature(with_commands(robot, read_tables(*this, robot.joint_space())), expansion());
}

double MeasuringOptions::expansion() const {
  constexpr double kReference = 20.0;  // deg C  [iso1]
  return 1e-6 * (expansion_ppm - instrument_expansion_ppm) * (temperature_c.value_or(kReference) - kReference);
}

namespace {

struct Measured {
  std::string_view name;
  Measurand measurand;
  LengthKind length = LengthKind::height;
};

/// What --at says, kind by kind.
std::string at_help() {
  std::string text;
  for (const LengthWords& kind : length_kinds()) {
    if (!kind.at.empty()) text += fmt::format("{}of {}: {}", text.empty() ? "" : "; ", kind.name, kind.at);
  }
  return text + " (in the robot's frame)";
}

std::string kinds_with_at() {
  std::string text;
  for (const LengthWords& kind : length_kinds()) {
    if (!kind.at.empty()) text.append(text.empty() ? "" : " or ").append(kind.name);
  }
  return text;
}

/// Every choice of --measure.
std::vector<Measured> measurands() {
  std::vector<Measured> all{{"coordinates", Measurand::coordinates},
                            {"pose", Measurand::poses},
                            {"distance", Measurand::distances},
                            {"home-distance", Measurand::home_distances}};
  for (const LengthWords& kind : length_kinds()) all.push_back({kind.name, Measurand::lengths, kind.kind});
  return all;
}

}  // namespace

PlannedReadings PlanningOptions::planned() const {
  const LengthWords& kind = words(readings.length);
  const bool lengths = readings.measurand == Measurand::lengths;
  if (readings.second && readings.measurand != Measurand::coordinates) {
    throw WrongUsage("--second: expected --measure coordinates");
  }
  const bool poses = readings.measurand == Measurand::poses;
  const bool reads_phi = reads_rotation || rotation != "none";
  if (reads_phi && (lengths || poses)) {
    throw WrongUsage(fmt::format("{}: expected --measure other than {}",
                                 reads_rotation ? "--read-rotation" : "--rotation", poses ? "pose" : kind.name));
  }
  if (!at.empty() && (!lengths || kind.at.empty())) {
    throw WrongUsage(fmt::format("--at: expected --measure {}", kinds_with_at()));
  }
  if (lengths && kind.needs_at && std::ranges::all_of(at, [](double one) { return one == 0.0; })) {
    throw WrongUsage(fmt::format("--measure {}: expected --at, {}", kind.name, kind.at));
  }
  PlannedReadings planned = readings;
  planned.rotation = reads_phi;
  if (!at.empty()) planned.at = Eigen::Vector3d(at[0], at[1], at[2]);
  return planned;
}

std::array<Option*, 3> add_planning_options(Command& command, PlanningOptions& options) {
  std::vector<std::string> names;
  for (const Measured& one : measurands()) names.emplace_back(one.name);
  const auto choose = [&readings = options.readings](const std::string& wanted) {
    const std::vector<Measured> all = measurands();
    const Measured& chosen = *std::ranges::find(all, wanted, &Measured::name);
    readings.measurand = chosen.measurand;
    readings.length = chosen.length;
  };
  Option* measure =
      command
          .add_choice("--measure", choose,
                      "what is measured: coordinates of a point; position and orientation of a body (pose); "
                      "distances between all poses or from home; heights above a plane; lengths from a "
                      "fixed point (ball-bar); readings of a dial gauge")
          ->check(one_of(names))
          ->shows_default(names.front());
  Option* at = command.add_option("--at", options.at, at_help())
                   ->lists("X,Y,Z", 3)
                   ->check(within(plausible::length(kLargestReach)));
  return {measure, at, add_mount_option(command, options.readings.mount)};
}

std::array<Option*, 2> add_rotation_options(Command& command, PlanningOptions& options,
                                            const std::vector<std::string>& zeros) {
  Option* rotation = command.add_option("--rotation", options.rotation, "whether phi is measured, and from which zero")
                         ->check(one_of(zeros));
  Option* before = command.add_flag("--read-rotation", options.reads_rotation, "the same")->excludes(rotation)->hide();
  return {rotation, before};
}

Option* add_mount_option(Command& command, ReflectorMount& mount) {
  std::vector<std::string> names;
  names.reserve(kReflectorMounts.size());
  for (const ReflectorMount one : kReflectorMounts) names.emplace_back(name(one));
  const auto choose = [&mount](const std::string& wanted) {
    mount = *std::ranges::find(kReflectorMounts, wanted, [](ReflectorMount one) { return name(one); });
  };
  return command.add_choice("--reflectors", choose, "where the second reflector or the measured body is mounted")
      ->check(one_of(names))
      ->shows_default(names.front());
}

Option* add_measuring_options(Command& command, MeasuringOptions& options) {
  command.heading("Measurements");
  Option* measurements = command
                             .add_option("--measurements", options.files,
                                         "tables of readings (CSV): points, poses of a body, distances, heights, ball "
                                         "bar or dial readings; each file "
                                         "has its own frame; docs/files.md lists the columns")
                             ->required();
  command.add_option("--poses", options.poses,
                     "commanded poses (CSV) of tables that only name them: one table for all files, or one for each");
  command
      .add_option("--columns", options.columns,
                  "columns of an instrument's text export: numbers (name=3,x=4,y=5,z=6), headings "
                  "(name=Target,x=X,y=Y,z=Z) or spatialanalyzer; default: its header row")
      ->takes("COLUMNS");
  command.add_option("--unit", options.unit, "unit of the export, if its header row states none")
      ->takes("mm|m|um|inch");
  command
      .add_option(
          "--match", options.match,
          "how points of an export are assigned to poses: by name, or in order (one or more passes over all poses)")
      ->check(one_of({"name", "order"}));
  add_table_options(command, options.style);
  command.heading("Temperature");
  command
      .add_option("--temperature-c", options.temperature_c,
                  "temperature of the machine during the measurement; results refer to 20")
      ->check(between(-50.0, 150.0));
  command
      .add_option("--expansion-ppm", options.expansion_ppm,
                  "thermal expansion of the machine per K: steel 11.5, aluminium 23, carbon 0")
      ->check(between(-10.0, 100.0));
  command
      .add_option("--instrument-expansion-ppm", options.instrument_expansion_ppm,
                  "thermal expansion of the instrument per K; 0: it compensates its own")
      ->check(between(-10.0, 100.0));
  return measurements;
}

VirtualInstrument InstrumentOptions::instrument(bool reads_rotation) const {
  VirtualInstrument instrument{.noise = noise_mm,
                               .repeatability = repeatability_mm,
                               .repeats = repeats,
                               .reads_rotation = reads_rotation,
                               .rotation_noise = to_radians(rotation_noise_deg)};
  try {
    if (!tracker_um.empty()) instrument.tracker = io::tracker_of_um(tracker_um);
  } catch (const InvalidArgument& refused) {
    throw WrongUsage(std::string("--tracker-um: ") + refused.what());
  }
  if (!second.empty()) instrument.second = Eigen::Vector3d(second[0], second[1], second[2]);
  return instrument;
}

void add_instrument_options(Command& command, InstrumentOptions& options) {
  command.heading("Simulated instrument (one standard deviation)");
  Option* noise = command.add_option("--noise-mm", options.noise_mm, "of a measured coordinate, distance or height")
                      ->check(non_negative());
  command
      .add_option(
          "--tracker-um", options.tracker_um,
          "laser tracker at the origin of its frame, instead of --noise-mm: transverse and radial, each constant "
          "and per m")
      ->lists("UM,UM/M,UM,UM/M", 4)
      ->check(non_negative())
      ->excludes(noise);
  command.add_option("--repeatability-mm", options.repeatability_mm, "repeatability of the machine, per coordinate")
      ->check(non_negative());
  command.add_option("--repeats", options.repeats, "number of visits to every pose")
      ->check(within(option_limits::kRepeats));
  command
      .add_option("--rotation-noise-deg", options.rotation_noise_deg,
                  "of measured phi, or of an orientation about each axis")
      ->check(non_negative());
  command
      .add_option("--second", options.second,
                  "offset of a second reflector from the first in mm, in the frame of its mount")
      ->lists("X,Y,Z", 3)
      ->check(within(plausible::length(kLargestReach)));
}

void add_indices(io::Json& json, const Observability& indices) {
  json["O1"] = indices.O1;
  json["O2"] = indices.O2;
  json["O3"] = indices.O3;
  json["O4"] = indices.O4;
  json["O5"] = indices.O5;
}

io::Json workspace_json(const WorkspaceUncertainty& spread) {
  return {{"rms_distance_mm", spread.rms_distance},
          {"max_distance_mm", spread.max_distance},
          {"rms_aligned_mm", spread.rms_aligned},
          {"max_aligned_mm", spread.max_aligned},
          {"rms_rotation_deg", to_degrees(spread.rms_rotation)},
          {"max_rotation_deg", to_degrees(spread.max_rotation)}};
}

Tolerances read_priors(const io::TextFile& file, const Robot& robot) {
  Tolerances tolerances = io::read_tolerances(file, robot);
  if (std::ranges::all_of(sources_of(robot.limbs()), [&](Source source) { return tolerances.std(source) == 0.0; })) {
    throw InputFileError(file.name, 0, "expected at least one tolerance above 0, got none");
  }
  return tolerances;
}

std::string assumed_lines(const std::vector<std::string>& assumed, std::string_view mark) {
  std::string text;
  for (const std::string& one : assumed) text += fmt::format("{} assumed: {}\n", mark, one);
  return text;
}

}  // namespace paracal::app

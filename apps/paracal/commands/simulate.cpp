#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "measuring.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/robot_statement.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string errors, poses, truth, frame = "robot";
  InstrumentOptions instrument;
  Measurand measurand = Measurand::coordinates;
  std::uint64_t machine = 0;
  ReflectorMount reflectors = ReflectorMount::plate;
  bool rotation = false;
};

/// Anywhere within some metres, turned anyhow: what "unknown frame" means.
RigidMotion random_frame(RandomStream& random) {
  constexpr double kFar = 3000.0;
  const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  const double angle = 2.0 * std::numbers::pi * random.uniform();
  const Eigen::Vector3d shift = Eigen::Vector3d(random.normal(), random.normal(), random.normal()) * kFar;
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), shift};
}

SourceErrors errors_of(const Options& options, const Robot& robot, RandomStream& random) {
  if (options.errors.empty()) return draw_errors(tolerances_of(robot), robot.limb_count(), random);
  return read_errors(robot, options.errors);
}

void check_instrument(const InstrumentOptions& instrument, const PlannedReadings& readings) {
  check_readings(readings, "--read-rotation");
  if (!instrument.tracker_um.empty() && readings.measurand != Measurand::coordinates) {
    throw WrongUsage("--tracker-um: expected --measure coordinates with it");
  }
  const bool distances = readings.measurand == Measurand::distances || readings.measurand == Measurand::home_distances;
  if (instrument.repeats > 1 && distances) throw WrongUsage("--repeats: expected another --measure than distances");
}

Measurements plan_of(const Robot& robot, const Options& options, const PlannedReadings& what) {
  Measurements plan = planned(robot, io::read_poses(input_file(options.poses), robot.joint_space()), what);
  const auto repeat = [&](auto& readings) {
    const auto once = readings;
    readings.clear();
    for (const auto& reading : once) readings.insert(readings.end(), options.instrument.repeats, reading);
  };
  for (PointSeries& series : plan.series) repeat(series.readings);
  for (HeightSeries& plane : plan.planes) repeat(plane.readings);
  return plan;
}

/// A plane about as level as beds and surface plates are, somewhere under the robot.
Eigen::Vector3d random_plane(RandomStream& random) {
  constexpr double kFar = 300.0, kSlope = 2e-3;
  return {kFar * random.normal(), kSlope * random.normal(), kSlope * random.normal()};
}

std::string table_of(const Measurements& measurements, Actuator actuator) {
  if (!measurements.planes.empty()) return io::height_table(measurements);
  return measurements.distances.empty() ? io::point_table(measurements, actuator) : io::distance_table(measurements);
}

io::Json points_json(const Measurements& measurements) {
  io::Json points = io::Json::array();
  for (const PointReading& reading : measurements.series.front().readings) {
    points.push_back({{"pose", measurements.stations[reading.station].name},
                      {"x_mm", reading.point.x()},
                      {"y_mm", reading.point.y()},
                      {"z_mm", reading.point.z()}});
    if (reading.rotation) points.back()["phi_deg"] = to_degrees(*reading.rotation);
    if (!reading.second) continue;
    points.back()["x2_mm"] = reading.second->x();
    points.back()["y2_mm"] = reading.second->y();
    points.back()["z2_mm"] = reading.second->z();
  }
  return points;
}

io::Json distances_json(const Measurements& measurements) {
  io::Json distances = io::Json::array();
  for (const DistanceReading& reading : measurements.distances) {
    distances.push_back({{"from", measurements.stations[reading.from].name},
                         {"to", measurements.stations[reading.to].name},
                         {"distance_mm", reading.distance}});
    if (reading.rotation) distances.back()["rotation_deg"] = to_degrees(*reading.rotation);
  }
  return distances;
}

io::Json heights_json(const Measurements& measurements) {
  io::Json heights = io::Json::array();
  for (const HeightReading& reading : measurements.planes.front().readings) {
    heights.push_back({{"pose", measurements.stations[reading.station].name}, {"height_mm", reading.height}});
  }
  return heights;
}

io::Json json_of(const Measurements& measurements) {
  if (!measurements.planes.empty()) return {{"heights", heights_json(measurements)}};
  if (!measurements.distances.empty()) return {{"distances", distances_json(measurements)}};
  return {{"points", points_json(measurements)}};
}

void run(const Options& options, Session& session) {
  const PlannedReadings what{
      .measurand = options.measurand, .rotation = options.rotation, .second = !options.instrument.second.empty()};
  check_instrument(options.instrument, what);
  const Robot robot = session.robot(sources_of(options.errors, options.poses));
  RandomStream random(session.seed(), options.machine);
  const SourceErrors errors = errors_of(options, robot, random);
  VirtualInstrument instrument = options.instrument.instrument(options.rotation);
  instrument.mount = options.reflectors;
  if (options.frame == "random") {
    instrument.frame = random_frame(random);
    if (options.measurand == Measurand::heights) instrument.plane = random_plane(random);
  }
  const Measurements measurements = simulate(robot, errors, plan_of(robot, options, what), instrument, random);
  const std::vector<std::string> assumed =
      options.errors.empty() ? tolerances_of(robot).assumed : std::vector<std::string>();
  if (!options.truth.empty()) {
    session.outputs.write(options.truth, io::source_errors_toml(errors, robot.joint_space()));
  }
  if (!session.json()) {
    return session.print(io::robot_line(robot) + assumed_lines(assumed, "#") +
                         table_of(measurements, robot.actuator()));
  }
  io::Json json = json_of(measurements);
  json["assumed"] = assumed;
  session.print_json(json);
}

}  // namespace

void add_simulate(Command& program, Session& session) {
  Command* command = session.add_command(program, "simulate", "Calibrate a machine",
                                         "what a virtual machine would be measured to do (CSV)");
  const auto options = std::make_shared<Options>();
  command->add_option("--errors", options->errors,
                      "source errors of the machine (TOML) or a calibration (JSON); without: drawn from the tolerances "
                      "by --seed and --machine");
  command->add_option("--machine", options->machine, "which of the drawn machines")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()))
      ->shows_default();
  session.outputs.declare(command->add_option("--truth", options->truth, "write the machine's errors here (TOML)"));
  command->add_option("--poses", options->poses, "poses to visit (CSV)")->required();
  add_measurand_option(*command, options->measurand);
  add_instrument_options(*command, options->instrument);
  add_mount_option(*command, options->reflectors);
  command->add_flag("--read-rotation", options->rotation, "a rotary encoder reads phi");
  command
      ->add_option("--frame", options->frame, "frame of the instrument; random: also where the plane of heights lies")
      ->check(one_of({"robot", "random"}))
      ->shows_default();
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app

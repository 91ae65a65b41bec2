
#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <numbers>

#include "measuring.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "session.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

struct SimulateArguments {
  std::string errors, poses, truth, frame = "robot";
  InstrumentOptions instrument;
  PlanningOptions plan;
  std::uint64_t machine = 0;
  double joint_noise = 0.0;  ///< deg or mm
  io::TableStyle style = {};
};

/// z first: the order in which compilers take the arguments of a call is their own affair.
Eigen::Vector3d normal_vector(RandomStream& random) {
  const double z = random.normal(), y = random.normal(), x = random.normal();
  return {x, y, z};
}

/// Anywhere within some metres, turned anyhow: what "unknown frame" means.
RigidMotion random_frame(RandomStream& random) {
  constexpr double kFar = 3000.0;
  const Eigen::Vector3d axis = normal_vector(random).normalized();
  const double angle = 2.0 * std::numbers::pi * random.uniform();
  const Eigen::Vector3d shift = normal_vector(random) * kFar;
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), shift};
}

SourceErrors errors_of(const SimulateArguments& options, const Robot& robot, RandomStream& random, Session& session) {
  if (options.errors.empty()) return draw_errors(robot, tolerances_of(robot), random);
  return session.read_errors(robot, options.errors);
}

void check_instrument(const InstrumentOptions& instrument, const PlannedReadings& readings) {
  const bool points = readings.measurand == Measurand::coordinates || readings.measurand == Measurand::poses;
  if (!instrument.tracker_um.empty() && !points) {
    throw WrongUsage("--tracker-um: expected --measure coordinates or pose");
  }
  const bool distances = readings.measurand == Measurand::distances || readings.measurand == Measurand::home_distances;
  if (instrument.repeats > 1 && distances) throw WrongUsage("--repeats: expected --measure other than distances");
}

Measurements plan_of(const Robot& robot, const SimulateArguments& options, const PlannedReadings& what) {
  Measurements plan =
      planned(robot, io::read_poses(input_table(options.poses, options.style), robot.joint_space()), what);
  const auto repeat = [&](auto& readings) {
    const auto once = readings;
    readings.clear();
    for (const auto& reading : once) readings.insert(readings.end(), options.instrument.repeats, reading);
  };
  for (PointSeries& series : plan.series) repeat(series.readings);
  for (LengthSeries& series : plan.lengths) repeat(series.readings);
  return plan;
}

std::string table_of(const Measurements& measurements, Actuator actuator) {
  if (!measurements.lengths.empty()) return io::length_table(measurements);
  return measurements.distances.empty() ? io::point_table(measurements, actuator) : io::distance_table(measurements);
}

io::Json points_json(const Measurements& measurements) {
  return io::json_array(measurements.series.front().readings, [&](const PointReading& reading) {
    io::Json json{{"pose", measurements.stations[reading.station].name},
                  {"x_mm", reading.point.x()},
                  {"y_mm", reading.point.y()},
                  {"z_mm", reading.point.z()}};
    if (const auto& q = reading.orientation) {
      json.update({{"qw", q->w()}, {"qx", q->x()}, {"qy", q->y()}, {"qz", q->z()}});
    }
    if (reading.rotation) json["phi_deg"] = to_degrees(*reading.rotation);
    if (const auto& r = reading.second) json.update({{"x2_mm", r->x()}, {"y2_mm", r->y()}, {"z2_mm", r->z()}});
    return json;
  });
}

io::Json distances_json(const Measurements& measurements) {
  return io::json_array(measurements.distances, [&](const DistanceReading& reading) {
    io::Json json{{"from", measurements.stations[reading.from].name},
                  {"to", measurements.stations[reading.to].name},
                  {"distance_mm", reading.distance}};
    if (reading.rotation) json["rotation_deg"] = to_degrees(*reading.rotation);
    return json;
  });
}

io::Json lengths_json(const Measurements& measurements) {
  const LengthSeries& series = measurements.lengths.front();
  return io::json_array(series.readings, [&](const LengthReading& reading) {
    return io::Json{{"pose", measurements.stations[reading.station].name},
                    {std::string(words(series.kind).column), reading.length}};
  });
}

io::Json json_of(const Measurements& measurements) {
  if (!measurements.lengths.empty()) {
    return {{std::string(words(measurements.lengths.front().kind).list), lengths_json(measurements)}};
  }
  if (!measurements.distances.empty()) return {{"distances", distances_json(measurements)}};
  return {{"points", points_json(measurements)}};
}

void run(const SimulateArguments& options, Session& session) {
  PlanningOptions wanted = options.plan;
  wanted.readings.second = !options.instrument.second.empty();
  const PlannedReadings what = wanted.planned();
  check_instrument(options.instrument, what);
  const Robot robot = session.robot(sources_of(options.errors, options.poses));
  RandomStream random(session.seed(), options.machine);
  const SourceErrors errors = errors_of(options, robot, random, session);
  const Measurements plan = plan_of(robot, options, what);
  VirtualInstrument instrument = options.instrument.instrument(what.rotation);
  instrument.mount = what.mount;
  instrument.joint_noise = from_file_unit(joint_unit(robot.actuator()), options.joint_noise);
  if (options.frame == "random") {
    instrument.frame = random_frame(random);
    if (what.measurand == Measurand::poses) instrument.body = random_body(random);
    if (!plan.lengths.empty()) instrument.set_up = random_set_up(robot, plan.lengths.front(), random);
  }
  const Measurements measurements = simulate(robot, errors, plan, instrument, random);
  const std::vector<std::string> assumed =
      options.errors.empty() ? tolerances_of(robot).assumed : std::vector<std::string>();
  if (!options.truth.empty()) {
    session.outputs.store.write(options.truth, io::source_errors_toml(errors, robot.joint_space()));
  }
  if (!session.json()) {
    return session.print(session.robot_line(robot) + assumed_lines(assumed, "#") +
                         table_of(measurements, robot.actuator()));
  }
  io::Json json = json_of(measurements);
  json["assumed"] = assumed;
  session.print_json(json);
}

}  // namespace

void add_simulate(Command& program, Session& session) {
  Command* command = session.add_command(program, "simulate", "Calibrate a machine",
                                         "write simulated measurements of a machine (CSV)");
  const auto options = std::make_shared<SimulateArguments>();
  command->add_option(
      "--errors", options->errors,
      "errors of the machine (TOML) or a calibration (JSON); default: drawn from the tolerances by --seed and "
      "--machine");
  command->add_option("--machine", options->machine, "number of the drawn machine")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()));
  session.outputs.declare(
      command->add_option("--truth", options->truth, "also write the errors of the machine (TOML)"));
  command->add_option("--poses", options->poses, "poses to visit (CSV)")->required();
  add_table_options(*command, options->style);
  command->heading("Measurement");
  add_planning_options(*command, options->plan);
  add_rotation_options(*command, options->plan, {"none", "absolute"});
  command->add_option("--frame", options->frame, "frame of the instrument: the robot's, or a random setup")
      ->check(one_of({"robot", "random"}));
  add_instrument_options(*command, options->instrument);
  command
      ->add_option("--joint-noise", options->joint_noise,
                   "of each joint, deg or mm, that a robot with more limbs than degrees of freedom states")
      ->check(non_negative());
  command->example("Measurements of a machine drawn from the tolerances",
                   "paracal simulate --robot huang2016 --poses plan.csv --noise-mm 0.017 --out simulated.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controller.hpp"
#include "interruption.hpp"
#include "long_job.hpp"
#include "measuring.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/io/points.hpp"
#include "paracal/units.hpp"
#include "progress_line.hpp"
#include "session.hpp"
#include "settings.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

struct PosesArguments {
  Settings<io::NoiseSettings> settings;
  std::string stage = "fine", criterion = "pose";
  double start_deg = to_degrees(kStartAzimuth), threshold = 0.01, acceptance_deg = 30.0;
  int optimal = 0, candidates = 10000, starts = 1;
  LongJobOptions job;
  PlanningOptions plan;
  bool fixed_to_plate = false;
  std::vector<double> tracker, facing, range;
};

const std::map<std::string, Criterion> kCriteria{{"D", Criterion::volume},
                                                 {"O1", Criterion::volume},
                                                 {"A", Criterion::mean_variance},
                                                 {"O3", Criterion::worst_direction},
                                                 {"pose", Criterion::pose_uncertainty}};

io::Json poses_json(const std::vector<Station>& stations) {
  return io::json_array(stations, [](const Station& station) {
    const auto& [r, rotation, tilt] = station.commanded;
    io::Json pose{{"pose", station.name},
                  {"x_cmd_mm", r.x()},
                  {"y_cmd_mm", r.y()},
                  {"z_cmd_mm", r.z()},
                  {"phi_cmd_deg", to_degrees(rotation)}};
    if (!tilt.isZero(0.0)) {
      pose["tilt_x_cmd_deg"] = to_degrees(tilt.x());
      pose["tilt_y_cmd_deg"] = to_degrees(tilt.y());
      pose["tilt_z_cmd_deg"] = to_degrees(tilt.z());
    }
    return pose;
  });
}

/// Why circles are smaller than the workspace, where they are.
std::string circles_note(const Robot& robot, const std::vector<Station>& stations) {
  constexpr double kRounded = 1e-3;  // mm
  const double whole = robot.workspace().radius;
  const double radius = stations.size() > 1 ? stations[1].commanded.position.head<2>().norm() : whole;
  if (radius > whole - kRounded) return "";
  return fmt::format(
      "# circles of {:g} mm instead of {:g} mm: some machines within the tolerances do not reach further\n", radius,
      whole);
}

void run_paper_plan(const PosesArguments& options, Session& session) {
  const Stage stage = options.stage == "rough" ? Stage::rough : Stage::fine;
  const Robot robot = session.robot();
  require_level(robot, "poses --stage");
  const PaperPlan plan = paper_plan(robot, stage, to_radians(options.start_deg), options.threshold);
  if (plan.n == 0) session.exit_code = kVerdictIsNo;
  if (session.json()) {
    io::Json json{{"n", plan.n}, {"curve", io::Json::array()}, {"poses", poses_json(plan.stations)}};
    for (const CurvePoint& point : plan.curve) {
      io::Json entry{{"n", point.n}};
      add_indices(entry, point.indices);
      entry["change"] = point.change;
      json["curve"].push_back(std::move(entry));
    }
    return session.print_json(json);
  }
  std::string text = session.robot_line(robot);
  fmt::format_to(std::back_inserter(text), "# {} stage: n = {} points per circle (change of O2 below {:g})\n",
                 options.stage, plan.n, options.threshold);
  for (const CurvePoint& point : plan.curve) {
    fmt::format_to(std::back_inserter(text), "# n = {:<3} O2 = {:.5f}  change {:.2f} %\n", point.n, point.indices.O2,
                   100.0 * point.change);
  }
  text += circles_note(robot, plan.stations);
  session.print(text + joints_request(robot) + io::station_table(plan.stations));
}

std::optional<Visibility> visibility_of(const PosesArguments& options) {
  if (options.tracker.empty() != options.facing.empty()) {
    throw WrongUsage("--tracker and --facing: expected both or neither");
  }
  if (options.tracker.empty()) return std::nullopt;
  const auto vector = [](const std::vector<double>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  if (!(vector(options.facing).norm() > 0.0))
    throw WrongUsage("--facing: expected a direction, got a vector of length 0");
  return Visibility{vector(options.tracker), vector(options.facing), to_radians(options.acceptance_deg),
                    options.fixed_to_plate ? ReflectorMount::plate : ReflectorMount::end_effector};
}

std::vector<Station> candidates_of(const Robot& robot, const PosesArguments& options, const PlannedReadings& readings,
                                   std::uint64_t seed) {
  std::vector<Station> all = candidate_stations(robot, options.candidates, seed, visibility_of(options));
  if (options.range.empty()) return all;
  return within_range(robot, all, readings, {options.range[0], options.range[1]});
}

void check_range(const PosesArguments& options) {
  if (options.range.empty()) return;
  if (options.plan.readings.measurand != Measurand::lengths) {
    throw WrongUsage("--range-mm: expected --measure with one length per pose (height, ball-bar or dial)");
  }
  if (!(options.range[0] < options.range[1])) {
    throw WrongUsage(fmt::format("--range-mm: expected the shortest, then the longest, got {},{}", options.range[0],
                                 options.range[1]));
  }
}

/// The search for the best poses among some candidates.
class Search {
 public:
  Search(const Robot& robot, const PosesArguments& options, const PlannedReadings& readings, const Session& session)
      : robot_(robot), options_(options), readings_(readings), session_(session) {}

  struct Found {
    std::vector<Station> candidates;
    Selection selection;
  };
  /// Each start draws candidates of its own; the first one those of the seed.
  Found operator()(std::uint64_t start) const {
    std::vector<Station> candidates = candidates_of(robot_, options_, readings_, session_.seed() + start);
    if (candidates.size() < static_cast<std::size_t>(options_.optimal)) {
      throw MathematicsSaysNo(
          fmt::format("expected {1} visible poses within reach, got {0}: allow more candidates or fewer poses",
                      candidates.size(), options_.optimal));
    }
    ProgressLine line("comparisons");
    const bool shows = options_.starts == 1;
    const auto progress = [&](std::uint64_t done, std::uint64_t /*expected*/) {
      if (shows) line.show(done);
    };
    CalibrationOptions stated;
    options_.settings.put_into(stated, robot_);
    Selection selection = select_stations(robot_, candidates,
                                          {.poses = options_.optimal,
                                           .criterion = kCriteria.at(options_.criterion),
                                           .noise = stated.noise,
                                           .readings = readings_,
                                           .rotation_zero = options_.plan.rotation_zero(),
                                           .threads = session_.threads(),
                                           .progress = progress});
    return {std::move(candidates), std::move(selection)};
  }

 private:
  const Robot& robot_;
  const PosesArguments& options_;
  const PlannedReadings& readings_;
  const Session& session_;
};

/// The start with the smallest criterion, the first of several. Empty where others compute some of them, which is said.
std::optional<std::uint64_t> best_start(const Search& search, const PosesArguments& options, Session& session,
                                        const Robot& robot) {
  if (options.starts == 1) return 0;
  ShownJob job(options.job, session, description_of(session, robot, tolerances_of(robot).half_width.values));
  const auto value = [](const std::string& text) {
    const io::Json json = io::Json::parse(text);
    return json.get_ref<const double&>();
  };
  const auto criteria = compute_each(
      job, "start", 0, static_cast<std::uint64_t>(options.starts),
      [&](std::uint64_t start) -> std::optional<std::string> {
        if (flag_of_interruption()) return std::nullopt;
        return io::Json(search(start).selection.criterion).dump();
      },
      [&](std::uint64_t /*start*/, const std::string& text) { (void)value(text); });
  if (!criteria) {
    if (flag_of_interruption()) end_by_interruption();
    session.print(job.missing_parts());
    return std::nullopt;
  }
  return std::ranges::min_element(*criteria, {}, value) - criteria->begin();
}

void run_selection(const PosesArguments& options, Session& session) {
  if (options.candidates < options.optimal) {
    throw WrongUsage(fmt::format("--candidates: expected at least the {} poses of --optimal, got {}", options.optimal,
                                 options.candidates));
  }
  if (options.plan.readings.measurand == Measurand::distances) {
    throw WrongUsage("--measure: expected one reading per pose with --optimal, got distance");
  }
  require_job(options.job, options.starts > 1, "--starts");
  const PlannedReadings readings = options.plan.planned();
  check_range(options);
  const Robot robot = session.robot();
  const Search search(robot, options, readings, session);
  const std::optional<std::uint64_t> best = best_start(search, options, session, robot);
  if (!best) return;
  const auto [candidates, selection] = search(*best);
  const std::vector<std::string> assumed = tolerances_of(robot).assumed;
  if (session.json()) {
    const Identifiability seen =
        identifiability(robot, planned(robot, selection.stations, readings),
                        {.rotation_zero = options.plan.rotation_zero(), .reflectors = readings.mount});
    const Unit unit = joint_unit(robot.actuator());
    io::Json json{{"n", selection.stations.size()},
                  {"criterion", options.criterion},
                  {"value", selection.criterion},
                  {"sweeps", selection.sweeps},
                  {"exchanges", selection.exchanges},
                  {fmt::format("travel_{}", file_unit(unit)), to_file_unit(unit, selection.travel)},
                  {"workspace_std", workspace_json(selection.uncertainty)},
                  {"curve", io::Json::array()},
                  {"poses", poses_json(selection.stations)},
                  {"assumed", assumed}};
    add_indices(json, seen.indices);
    for (std::size_t k = 0; k < selection.curve.size(); ++k) {
      json["curve"].push_back(workspace_json(selection.curve[k]));
      json["curve"].back()["n"] = k + 2;
    }
    return session.print_json(json);
  }
  const WorkspaceUncertainty& after = selection.uncertainty;
  std::string text = session.robot_line(robot);
  fmt::format_to(
      std::back_inserter(text),
      "# {} of {} candidate poses, criterion {}; predicted largest standard deviation over the workspace:\n# distance "
      "{:.3f} mm, aligned position {:.3f} mm, rotation {:.3f} deg; in the order of a short path\n",
      selection.stations.size(), candidates.size(), options.criterion, after.max_distance, after.max_aligned,
      to_degrees(after.max_rotation));
  for (std::size_t k = 4; k < selection.curve.size(); ++k) {
    fmt::format_to(
        std::back_inserter(text), "# {:>3} poses: distance {:.3f} mm, aligned {:.3f} mm, rotation {:.3f} deg\n", k + 2,
        selection.curve[k].max_distance, selection.curve[k].max_aligned, to_degrees(selection.curve[k].max_rotation));
  }
  session.print(text + assumed_lines(assumed, "#") + joints_request(robot) + io::station_table(selection.stations));
}

}  // namespace

void add_poses(Command& program, Session& session) {
  Command* command = session.add_command(program, "poses", "Calibrate a machine", "choose the poses to measure");
  const auto options = std::make_shared<PosesArguments>();
  std::vector<std::string> criteria;
  criteria.reserve(kCriteria.size());
  for (const auto& [criterion, unused] : kCriteria) criteria.push_back(criterion);
  command->heading("Plan of Huang et al. (2016)");
  command->add_option("--stage", options->stage, "stage of the calibration; adds points until O2 changes little")
      ->check(one_of({"rough", "fine"}));
  command->add_option("--start-deg", options->start_deg, "azimuth of the first point")
      ->check(within(option_limits::kStartDeg));
  command->add_option("--threshold", options->threshold, "smallest relative change of O2 that still counts")
      ->check(within(option_limits::kO2Threshold));
  command->heading("Optimal poses");
  Option* optimal =
      command->add_option("--optimal", options->optimal, "choose the best N poses, including home, by exchange")
          ->check(within(option_limits::kSelectedPoses))
          ->shows_default("");
  command->add_option("--candidates", options->candidates, "number of candidate poses")
      ->check(within(option_limits::kCandidates))
      ->needs(optimal);
  command
      ->add_option("--starts", options->starts,
                   "number of searches, each with new candidates; the best is kept; MPI ranks share them")
      ->check(whole_number(1, 100000))
      ->needs(optimal);
  command->add_option("--criterion", options->criterion, "criterion that the chosen poses minimise")
      ->check(one_of(criteria))
      ->needs(optimal);
  command->heading("Measurement");
  for (Option* option : add_planning_options(*command, options->plan)) option->needs(optimal);
  command->add_option("--range-mm", options->range, "measuring range of the instrument; the poses stay within it")
      ->lists("MM,MM", 2)
      ->check(within(plausible::length(kLargestReach)))
      ->needs(optimal);
  for (Option* option : add_rotation_options(*command, options->plan, {"none", "relative", "absolute"})) {
    option->needs(optimal);
  }
  command->add_flag("--second", options->plan.readings.second, "a second reflector is measured at every pose, too")
      ->needs(optimal);
  command->add_option("--tracker", options->tracker, "position of the tracker in the robot's frame, mm")
      ->lists("X,Y,Z", 3)
      ->check(within(plausible::length(kLargestReach)))
      ->needs(optimal);
  command->add_option("--facing", options->facing, "direction of the reflector at phi = 0")
      ->lists("X,Y,Z", 3)
      ->check(within(plausible::kDirection))
      ->needs(optimal);
  command
      ->add_option("--acceptance-deg", options->acceptance_deg,
                   "half-angle within which the tracker can see the reflector")
      ->check(between(1.0, 180.0))
      ->needs(optimal);
  command->add_flag("--on-plate", options->fixed_to_plate, "the reflector does not turn with phi")->needs(optimal);
  options->settings.declare(*command);
  add_long_job_options(*command, options->job);
  command->example("The best 20 poses for a laser tracker",
                   "paracal poses --robot huang2016 --optimal 20 --out my_plan.csv");
  command->callback([&session, options] {
    options->optimal > 0 ? run_selection(*options, session) : run_paper_plan(*options, session);
  });
}

}  // namespace paracal::app

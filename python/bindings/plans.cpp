#include "paracal/calibration/plan.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "options.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"
#include "rooms.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

std::vector<Station> planned_stations(const Robot& robot, const std::vector<std::string>& names, const Array& poses) {
  const std::size_t width = pose_width(robot);
  const Rows rows(poses, "poses", width);
  if (names.size() != rows.count()) {
    throw InvalidArgument(fmt::format("names: expected {}, one per pose, got {}", rows.count(), names.size()));
  }
  std::vector<Station> stations;
  for (std::size_t k = 0; k < names.size(); ++k) stations.push_back({names[k], pose_of(rows[k], width)});
  return stations;
}

py::dict indices_of(const Observability& indices) {
  return py::dict("O1"_a = indices.O1, "O2"_a = indices.O2, "O3"_a = indices.O3, "O4"_a = indices.O4,
                  "O5"_a = indices.O5);
}

py::dict std_of(const WorkspaceUncertainty& spread) {
  return py::dict("rms_distance_mm"_a = spread.rms_distance, "max_distance_mm"_a = spread.max_distance,
                  "rms_aligned_mm"_a = spread.rms_aligned, "max_aligned_mm"_a = spread.max_aligned,
                  "rms_rotation_rad"_a = spread.rms_rotation, "max_rotation_rad"_a = spread.max_rotation);
}

py::dict paper_plan_of(const Robot& robot, const std::string& stage, double start_azimuth, double threshold) {
  checked("start_azimuth_rad", to_degrees(start_azimuth), option_limits::kStartDeg);
  checked("threshold", threshold, option_limits::kO2Threshold);
  const auto plan = [&] {
    const Released released;
    return paper_plan(robot, stage == "rough" ? Stage::rough : Stage::fine, start_azimuth, threshold);
  }();
  py::list curve;
  for (const CurvePoint& point : plan.curve) {
    py::dict entry = indices_of(point.indices);
    entry["n"] = point.n;
    entry["change"] = point.change;
    curve.append(entry);
  }
  return py::dict("n"_a = plan.n, "curve"_a = curve, "poses"_a = named_poses(plan.stations, &robot));
}

Criterion criterion_of(const Keywords& given) {
  Criterion criterion = Criterion::pose_uncertainty;
  given.choose("criterion",
               {{"pose", Criterion::pose_uncertainty},
                {"D", Criterion::volume},
                {"O1", Criterion::volume},
                {"A", Criterion::mean_variance},
                {"O3", Criterion::worst_direction}},
               criterion);
  return criterion;
}

py::dict selected(const Robot& robot, std::int64_t poses, std::int64_t candidates, std::uint64_t seed,
                  const py::dict& keywords) {
  const Keywords given(keywords);
  const auto candidate_count = static_cast<int>(checked("candidates", candidates, option_limits::kCandidates));
  SelectionOptions options{.poses = static_cast<int>(checked("poses", poses, option_limits::kSelectedPoses)),
                           .criterion = criterion_of(given),
                           .noise = noise_of(given),
                           .readings = planned_readings(given)};
  if (given.has("tolerances")) options.tolerances = given.get<Tolerances>("tolerances", "Tolerances");
  const auto plan = [&] {
    const Released released;
    return select_stations(robot, candidate_stations(robot, candidate_count, seed), options);
  }();
  py::list curve;
  for (const WorkspaceUncertainty& spread : plan.curve) curve.append(std_of(spread));
  return py::dict("poses"_a = named_poses(plan.stations, &robot), "value"_a = plan.criterion, "sweeps"_a = plan.sweeps,
                  "exchanges"_a = plan.exchanges, "travel"_a = plan.travel,
                  "workspace_std"_a = std_of(plan.uncertainty), "curve"_a = curve);
}

/// What a plan promises, as `paracal identifiability` says it.
struct Promise {
  Identifiability seen;
  KnownErrors after;
  WorkspaceUncertainty spread;
};

Promise promise_of(const Robot& robot, const Measurements& plan, const CalibrationOptions& options) {
  Promise promise{.seen = identifiability(robot, plan, options), .after = promised(robot, plan, options), .spread = {}};
  promise.spread =
      PoseSpread(robot, {}, promise.after.parameters, workspace_stations(robot)).uncertainty(promise.after.covariance);
  return promise;
}

/// (name, limb, unit, prior std, std after measuring) of the errors that are sought.
py::list parameters_of(const Robot& robot, const Promise& promise) {
  py::list parameters;
  for (std::size_t k = 0; k < promise.after.parameters.size(); ++k) {
    const SoughtSource& one = promise.after.parameters[k];
    const bool wanted = std::ranges::any_of(promise.seen.parameters, [&](const SoughtSource& sought) {
      return sought.limb == one.limb && sought.source == one.source;
    });
    if (!wanted) continue;
    const auto at = static_cast<Eigen::Index>(k);
    parameters.append(py::make_tuple(std::string(name(one.source)), one.limb + 1,
                                     array_unit(unit(one.source, robot.actuator())), one.prior_std.value_or(0.0),
                                     std::sqrt(promise.after.covariance(at, at))));
  }
  return parameters;
}

py::dict identifiable(const Robot& robot, const std::vector<std::string>& names, const Array& poses,
                      const py::dict& keywords) {
  const Keywords given(keywords);
  const Measurements plan = planned(robot, planned_stations(robot, names, poses), planned_readings(given));
  CalibrationOptions options = calibration_options(robot, given);
  if (plan.series.empty()) options.frame = Frame::unknown;
  const auto promise = [&] {
    const Released released;
    return promise_of(robot, plan, options);
  }();
  py::list directions;
  for (const NullDirection& one : promise.seen.null_space) {
    directions.append(py::make_tuple(one.text, vector_of(one.direction), one.gauge));
  }
  return py::dict("rank"_a = promise.seen.rank, "rows"_a = promise.seen.rows,
                  "parameters"_a = parameters_of(robot, promise), "null_space"_a = directions,
                  "singular_values"_a = vector_of(promise.seen.singular_values),
                  "indices"_a = indices_of(promise.seen.indices), "workspace_std"_a = std_of(promise.spread));
}

/// A reading as often as every station is visited.
template <typename Readings>
void repeat(Readings& readings, int repeats) {
  const Readings once = readings;
  readings.clear();
  for (const auto& reading : once) {
    let_interrupt();
    readings.insert(readings.end(), repeats, reading);
  }
}

RigidMotion motion_of(const char* keyword, const Array& matrix) {
  const Rows rows(matrix, keyword, 4);
  if (rows.count() != 4) throw InvalidArgument(fmt::format("{}: expected a homogeneous matrix, (4, 4)", keyword));
  RigidMotion frame;
  for (Eigen::Index r = 0; r < 3; ++r) {
    for (Eigen::Index c = 0; c < 3; ++c) frame.rotation(r, c) = rows[static_cast<std::size_t>(r)][c];
    frame.translation(r) = rows[static_cast<std::size_t>(r)][3];
  }
  if ((frame.rotation * frame.rotation.transpose()).isIdentity(1e-9) && frame.rotation.determinant() > 0.0)
    return frame;
  throw InvalidArgument(fmt::format("{}: expected a rotation in its first three rows and columns", keyword));
}

VirtualInstrument instrument_of(const Keywords& given) {
  VirtualInstrument instrument;
  given.take_number("noise_mm", option_limits::kStd, instrument.noise);
  given.take_number("repeatability_mm", option_limits::kStd, instrument.repeatability);
  given.take_number("rotation_noise_rad", option_limits::kStd, instrument.rotation_noise);
  if (given.has("second_mm")) {
    const auto second = given.get<std::array<double, 3>>("second_mm", "x, y, z in mm");
    instrument.second = Eigen::Vector3d(second[0], second[1], second[2]);
  }
  if (given.has("frame")) instrument.frame = motion_of("frame", given.get<Array>("frame", "a matrix (4, 4)"));
  if (given.has("body")) instrument.body = motion_of("body", given.get<Array>("body", "a matrix (4, 4)"));
  return instrument;
}

GivenMeasurements simulated(const BuiltMachine& machine, const std::vector<std::string>& names, const Array& poses,
                            std::int64_t repeats, std::uint64_t seed, std::uint64_t stream, const py::dict& keywords) {
  const Keywords given(keywords);
  VirtualInstrument instrument = instrument_of(given);
  PlannedReadings readings = planned_readings(given);
  readings.second = instrument.second.has_value();
  instrument.mount = readings.mount;
  Measurements plan = planned(machine.robot, planned_stations(machine.robot, names, poses), readings);
  const auto visits = static_cast<int>(checked("repeats", repeats, option_limits::kRepeats));
  if (visits > 1 && !plan.distances.empty()) {
    throw InvalidArgument("repeats: expected 1 with distances, or another measure");
  }
  const Released released;
  for (PointSeries& series : plan.series) repeat(series.readings, visits);
  for (LengthSeries& series : plan.lengths) repeat(series.readings, visits);
  RandomStream random(seed, stream);
  return {.readings = simulate(machine.robot, machine.errors, std::move(plan), instrument, random)};
}

}  // namespace

void add_plans(py::module_& module) {
  module.def("paper_plan", &paper_plan_of, "robot"_a, "stage"_a, "start_azimuth"_a, "threshold"_a);
  module.def("select_poses", &selected, "robot"_a, "poses"_a, "candidates"_a, "seed"_a, "keywords"_a);
  module.def("identifiability", &identifiable, "robot"_a, "names"_a, "poses"_a, "keywords"_a);
  module.def("simulate", &simulated, "machine"_a, "names"_a, "poses"_a, "repeats"_a, "seed"_a, "stream"_a,
             "keywords"_a);
  module.def(
      "validation_poses", [](const Robot& robot) { return named_poses(validation_stations(robot), &robot); },
      "robot"_a);
  module.def(
      "workspace_poses", [](const Robot& robot) { return named_poses(workspace_stations(robot), &robot); }, "robot"_a);
}

}  // namespace paracal::python

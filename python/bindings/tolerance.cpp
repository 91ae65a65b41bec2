#include <pybind11/stl.h>

#include <map>

#include "arrays.hpp"
#include "options.hpp"
#include "paracal/io/allocation_problem.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/tolerance/allocation.hpp"
#include "paracal/tolerance/analysis.hpp"
#include "paracal/tolerance/failure.hpp"
#include "rooms.hpp"
#include "state.hpp"

namespace paracal::python {
namespace {

using namespace py::literals;

py::tuple pair_of(const Interval& interval, double factor = 1.0) {
  return py::make_tuple(factor * interval.low, factor * interval.high);
}

py::list shares_of(const std::vector<Contributor>& contributors) {
  py::list list;
  for (const Contributor& one : contributors) {
    list.append(py::make_tuple(std::string(name(one.source)), one.share));
  }
  return list;
}

/// Half-widths that the caller states, mm or rad; `others` says what the rest are.
Tolerances stated(const Robot& robot, const std::map<std::string, double>& half_widths, const std::string& others,
                  const std::string& distribution) {
  Tolerances tolerances;
  if (others == "generous") {
    tolerances = generous_tolerances(robot.limbs());
  } else if (others == "exact") {
    tolerances.origin.values.fill(Origin::exact);
  } else {
    throw InvalidArgument("others: expected \"exact\" or \"generous\", got \"" + others + "\"");
  }
  for (const auto& [name, value] : half_widths) {
    const auto source = source_named(name, robot.limbs());
    if (!source) throw InvalidArgument("half_widths: expected names of geometric errors, got \"" + name + "\"");
    if (!(value >= 0.0 && std::isfinite(value))) {
      throw InvalidArgument(fmt::format("half_widths: expected at least 0 for {}, got {}", name, value));
    }
    tolerances.state(*source, value);
  }
  Keywords(py::dict("distribution"_a = distribution))
      .choose("distribution",
              {{"normal", Distribution::normal},
               {"uniform", Distribution::uniform},
               {"truncated_normal", Distribution::truncated_normal}},
              tolerances.distribution);
  list_assumed(tolerances, robot.limbs());
  return tolerances;
}

Characteristic characteristic_of(const std::string& wanted) {
  if (const auto found = characteristic_named(wanted)) return *found;
  std::string known;
  for (const Quantity quantity : kQuantities) known.append(known.empty() ? "" : ", ").append(name({quantity}));
  throw InvalidArgument(
      fmt::format("quantity: expected one of {}, also with \"-compensated\" appended, got \"{}\"", known, wanted));
}

/// (quantity, limit in mm or rad).
std::vector<Requirement> requirements_of(const std::vector<std::pair<std::string, double>>& given) {
  std::vector<Requirement> requirements;
  for (const auto& [quantity, limit] : given) {
    const Characteristic what = characteristic_of(quantity);
    const bool turns = unit(what.quantity) == Unit::rad;
    checked(("limit of " + quantity).c_str(), limit, turns ? plausible::kLimitRad : plausible::kLimit);
    requirements.push_back({what, limit});
  }
  if (requirements.empty()) throw InvalidArgument("requirements: expected at least one, got none");
  return requirements;
}

AllocationProblem problem_of(const Robot& robot, const Tolerances& rest, const std::string& path) {
  return io::read_allocation_problem(io::read_stored(path), rest, robot);
}

std::vector<std::pair<std::string, double>> problem_requirements(const Robot& robot, const Tolerances& tolerances,
                                                                 const std::string& path) {
  std::vector<std::pair<std::string, double>> list;
  for (const Requirement& one : problem_of(robot, tolerances, path).requirements) {
    list.emplace_back(name(one.characteristic), one.limit);
  }
  return list;
}

/// Those asked for, and the worst ones; by default where limits may be broken.
std::vector<Pose> drawn_poses(const Robot& robot, const Tolerances& tolerances,
                              const std::vector<RequirementAnalysis>& analyses, const std::optional<Rows>& poses) {
  if (!poses) return judged_poses(robot, tolerances, analyses);
  std::vector<Pose> all;
  all.reserve(analyses.size());
  for (const RequirementAnalysis& one : analyses) all.push_back(one.three_sigma.pose);
  for (std::size_t k = 0; k < poses->count(); ++k) all.push_back(pose_of((*poses)[k], pose_width(robot)));
  return all;
}

py::dict requirement_of(const Robot& robot, const RequirementAnalysis& one, const RequirementStatistics& drawn,
                        double confidence) {
  const SigmaAtPose& worst = drawn.at_worst();
  py::dict largest;
  for (const double share : {0.5, 0.9, 0.95, 0.99}) {
    largest[py::str(fmt::format("p{:g}", 100.0 * share))] = drawn.largest.quantile(share);
  }
  largest["p95_interval"] = pair_of(drawn.largest.quantile_interval(0.95, confidence));
  return py::dict("quantity"_a = name(one.requirement.characteristic),
                  "unit"_a = array_unit(unit(one.requirement.characteristic.quantity)),
                  "limit"_a = one.requirement.limit, "worst_case"_a = one.worst_case.value,
                  "worst_case_pose"_a = array_of(one.worst_case.pose, robot), "rss_3sigma"_a = one.three_sigma.value,
                  "rss_pose"_a = array_of(one.three_sigma.pose, robot), "monte_carlo_3sigma"_a = 3.0 * worst.sigma,
                  "monte_carlo_3sigma_interval"_a = pair_of(worst.interval, 3.0),
                  "monte_carlo_pose"_a = array_of(worst.pose, robot), "cpk"_a = drawn.cpk(), "passed"_a = drawn.passed,
                  "largest_on_a_machine"_a = largest, "contributors"_a = shares_of(one.contributors));
}

MonteCarloOptions sampling_of(const Keywords& given) {
  MonteCarloOptions options;
  given.choose("model", {{"linear", Model::linear}, {"exact", Model::exact}}, options.model);
  given.take("seed", "a whole number", options.seed);
  auto machines = static_cast<std::int64_t>(options.max_machines);
  given.take("max_machines", "a whole number", machines);
  options.max_machines = checked("max_machines", machines, option_limits::kMaxMachines);
  given.take("threads", "a whole number", options.threads);
  given.take_number("sigma_error", option_limits::kRelativeError, options.sigma_error);
  given.take_number("confidence", option_limits::kConfidence, options.confidence);
  return options;
}

FailureOptions failures_of(const Keywords& given, const MonteCarloOptions& drawing) {
  FailureOptions options{.seed = drawing.seed, .confidence = drawing.confidence, .threads = drawing.threads};
  given.take_number("failure_error", option_limits::kRelativeError, options.relative_error);
  return options;
}

py::dict share_of(const WeighedShare& share) {
  return py::dict("value"_a = share.value, "low"_a = share.interval.low, "high"_a = share.interval.high,
                  "machines"_a = share.machines, "effective"_a = share.effective);
}

py::dict failure_of(const FailureShare& failures) {
  const py::object exact = failures.exact ? py::object(share_of(*failures.exact)) : py::object(py::none());
  return py::dict("status"_a = std::string(name(failures.status)), "reason"_a = failures.reason,
                  "linear"_a = share_of(failures.linear), "check"_a = share_of(failures.check), "exact"_a = exact,
                  "not_closed"_a = failures.not_closed);
}

py::dict analyzed(const Robot& robot, const Tolerances& tolerances,
                  const std::vector<std::pair<std::string, double>>& wanted, const std::optional<Array>& poses,
                  const py::dict& keywords) {
  const std::vector<Requirement> requirements = requirements_of(wanted);
  const MonteCarloOptions options = sampling_of(Keywords(keywords));
  std::optional<Rows> at;
  if (poses) at.emplace(*poses, "poses", pose_width(robot));
  const FailureOptions rare = failures_of(Keywords(keywords), options);
  std::vector<RequirementAnalysis> analyses;
  FailureShare failures;
  const MonteCarlo batch = [&] {
    const Released released;
    analyses = analyze(robot, tolerances, requirements);
    const std::vector<Pose> poses_tried = drawn_poses(robot, tolerances, analyses, at);
    failures = failure_share(robot, tolerances, requirements, poses_tried, rare);
    return monte_carlo(robot, tolerances, requirements, poses_tried, options);
  }();
  py::list list;
  for (std::size_t k = 0; k < analyses.size(); ++k) {
    list.append(requirement_of(robot, analyses[k], batch.requirements[k], options.confidence));
  }
  const Proportion share = yield(failures, batch, options.confidence);
  return py::dict("machines"_a = batch.machines, "converged"_a = batch.converged, "not_closed"_a = batch.not_closed,
                  "passed"_a = batch.passed, "confidence"_a = options.confidence, "requirements"_a = list,
                  "yield_"_a = share.value, "yield_interval"_a = pair_of(share.interval),
                  "dpmo"_a = defects_per_million(share).value, "failure"_a = failure_of(failures));
}

py::dict allocation_of(const Robot& robot, const Allocation& found) {
  py::list outcomes;
  for (const RequirementOutcome& one : found.requirements) {
    outcomes.append(py::dict("quantity"_a = name(one.requirement.characteristic),
                             "criterion"_a = std::string(name(one.requirement.criterion)),
                             "limit"_a = one.requirement.limit, "worst"_a = one.worst.value,
                             "worst_pose"_a = array_of(one.worst.pose, robot), "price"_a = one.price));
  }
  return py::dict("status"_a = std::string(name(found.status)), "reason"_a = found.reason, "cost"_a = found.cost,
                  "ok"_a = found.ok(), "tolerances"_a = found.tolerances, "requirements"_a = outcomes);
}

py::dict equal_influence(const Robot& robot, const Tolerances& rest, const py::dict& keywords) {
  const Keywords given(keywords);
  EqualInfluence problem{.rest = rest};
  given.take_number("max_tilt_rad", plausible::kLimitRad, problem.max_tilt);
  given.take_number("least_rad", plausible::kLimitRad, problem.least);
  given.choose("bound", {{"sum-of-maxima", Bound::sum_of_maxima}, {"true-maximum", Bound::true_maximum}},
               problem.bound);
  given.choose("least_is", {{"tolerance", LeastReading::tolerance}, {"sigma", LeastReading::sigma}},
               problem.least_reading);
  const auto found = [&] {
    const Released released;
    return allocate(robot, problem);
  }();
  return allocation_of(robot, found);
}

py::dict solved(const Robot& robot, const Tolerances& rest, const std::string& path) {
  const auto found = [&] {
    const Released released;
    const AllocationProblem problem = problem_of(robot, rest, path);
    if (problem.variables.empty()) throw InputFileError(path, 0, "expected costs ([cost.NAME]), got none");
    return allocate(robot, problem);
  }();
  return allocation_of(robot, found);
}

py::dict sensitivity_of(const Robot& robot, const Tolerances& tolerances, const std::string& quantity,
                        bool all_rotations, double relative_error) {
  checked("relative_error", relative_error, plausible::kLimit);
  const Characteristic what = characteristic_of(quantity);
  GlobalSensitivity global;
  ValueAtPose worst;
  std::vector<Contributor> shares;
  {
    const Released released;
    global = global_sensitivity(robot, what, {.all_rotations = all_rotations, .relative_error = relative_error});
    worst = worst_spread(robot, what, tolerances, Spread::statistical);
    shares = contributors(robot, LinearModel(robot).rows(worst.pose, what), tolerances);
  }
  const PerSource units = paper_units(robot);
  const auto vector = [&](const PerSource& values) { return vector_of_sources(values, robot); };
  return py::dict("mean"_a = vector(global.mean), "error"_a = vector(global.error),
                  "largest"_a = vector(global.largest), "paper_units"_a = vector(units), "poses"_a = global.poses,
                  "unit"_a = array_unit(unit(what.quantity)), "worst_3sigma"_a = worst.value,
                  "worst_pose"_a = array_of(worst.pose, robot), "contributors"_a = shares_of(shares));
}

}  // namespace

void add_tolerance(py::module_& module) {
  class_of_states<Tolerances>(module, "Tolerances")
      .def(
          "half_widths",
          [](const Tolerances& t, const Robot& robot) { return vector_of_sources(half_widths(t), robot); }, "robot"_a)
      .def(
          "std", [](const Tolerances& t, const Robot& robot) { return vector_of_sources(variances(t).sqrt(), robot); },
          "robot"_a)
      .def_property_readonly("assumed", [](const Tolerances& t) { return texts_of(t.assumed); })
      .def(
          "toml", [](const Tolerances& t, const Robot& robot) { return io::tolerances_toml(t, robot.limbs()); },
          "robot"_a);
  module.def(
      "tolerances_of", [](const Robot& robot) { return tolerances_of(robot); }, "robot"_a);
  module.def("stated_tolerances", &stated, "robot"_a, "half_widths"_a, "others"_a, "distribution"_a);
  module.def(
      "read_tolerances",
      [](const Robot& robot, const std::string& path) { return io::read_tolerances(io::read_stored(path), robot); },
      "robot"_a, "path"_a);
  module.def("problem_requirements", &problem_requirements, "robot"_a, "tolerances"_a, "path"_a);
  module.def("analyze", &analyzed, "robot"_a, "tolerances"_a, "requirements"_a, "poses"_a, "keywords"_a);
  module.def("equal_influence", &equal_influence, "robot"_a, "rest"_a, "keywords"_a);
  module.def("allocate", &solved, "robot"_a, "rest"_a, "path"_a);
  module.def("sensitivity", &sensitivity_of, "robot"_a, "tolerances"_a, "quantity"_a, "all_rotations"_a,
             "relative_error"_a);
}

}  // namespace paracal::python

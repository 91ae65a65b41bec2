#include "paracal/io/allocation_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/tables/names.hpp"
#include "paracal/error.hpp"
#include "paracal/tolerance/workspace_samples.hpp"
#include "paracal/units.hpp"
#include "section.hpp"

namespace paracal::io {
namespace {

/// Exponents of a cost.
constexpr plausible::Range kPower{0.01, 10.0};

/// The key of a limit says its unit: limit_mm, limit_rad or limit_deg.
double limit_of(Section& section, Quantity quantity, const Robot& robot) {
  if (unit(quantity) == Unit::mm) return section.number("limit_mm", plausible::limit(robot.reach()));
  return section.find("limit_deg") != nullptr ? to_radians(section.number("limit_deg", plausible::kLimitDeg))
                                              : section.number("limit_rad", plausible::kLimitRad);
}

/// Of half-widths.
plausible::Range half_width(Unit unit, double reach) {
  if (unit == Unit::rad) return plausible::kLimitDeg;
  return unit == Unit::mm ? plausible::limit(reach) : plausible::Range{plausible::kNothing, kGainLength, "mm/m"};
}

Requirement requirement_of(Section section, const Robot& robot) {
  Requirement requirement;
  const std::string text = section.text("quantity");
  const std::optional<Characteristic> characteristic = characteristic_named(text);
  if (!characteristic) {
    std::string known;
    for (const Quantity quantity : kQuantities) known.append(name({quantity, false})).append(", ");
    section.fail(*section.find("quantity"),
                 fmt::format("expected {}or one of these followed by \"-compensated\", got \"{}\"", known, text));
  }
  if (const std::string_view why = why_not_asked(robot, *characteristic); !why.empty()) {
    section.fail(*section.find("quantity"), fmt::format("{}: {}, got {}", text, why, robot.name()));
  }
  requirement.characteristic = *characteristic;
  requirement.limit = limit_of(section, characteristic->quantity, robot);
  requirement.is_in_degrees = section.find("limit_deg") != nullptr;
  if (const toml::node* node = section.find("criterion")) {
    const std::string criterion = section.text("criterion");
    const auto named = [&](Spread one) { return criterion == name(one); };
    constexpr std::array kKnown{Spread::statistical, Spread::worst_case, Spread::yield};
    const auto found = std::ranges::find_if(kKnown, named);
    if (found == kKnown.end()) {
      section.fail(*node, fmt::format("expected \"statistical\", \"worst-case\" or \"yield\", got \"{}\"", criterion));
    }
    requirement.criterion = *found;
  }
  section.refuse_others();
  return requirement;
}

std::vector<Grade> grades_of(Section& section, double unit_size, const plausible::Range& range) {
  std::vector<Grade> grades;
  for (Section& one : section.tables("grade")) {
    Grade grade;
    grade.name = one.text("name");
    grade.tolerance = unit_size * one.number("tolerance", range);
    grade.cost = one.number("cost", {-plausible::kCost.most, plausible::kCost.most});
    one.refuse_others();
    grades.push_back(std::move(grade));
  }
  if (grades.empty()) section.fail(fmt::format("expected grades ([[{}]]), got none", section.key_path("grade")));
  return grades;
}

/// @param unit_size  the file's unit in mm or rad, which A, B, C and the bounds are stated in.
CostCurve curve_of(Section& section, double unit_size, const plausible::Range& range) {
  const toml::node* node = section.find("law");
  const std::string text = node != nullptr ? section.text("law") : "reciprocal";
  const std::optional<CostLaw> law = cost_law_named(text);
  if (!law) {
    section.fail(*node,
                 fmt::format("expected reciprocal, reciprocal-square, exponential, power or grades for {}, got \"{}\"",
                             section.key_path("law"), text));
  }
  CostCurve curve{.law = *law};
  if (*law == CostLaw::grades) {
    curve.grades = grades_of(section, unit_size, range);
    return curve;
  }
  curve.A = section.number_or("A", 0.0, {-plausible::kCost.most, plausible::kCost.most});
  curve.B = section.number("B", plausible::kCost);
  switch (*law) {
    case CostLaw::reciprocal:
      curve.B *= unit_size;
      break;
    case CostLaw::reciprocal_square:
      curve.B *= unit_size * unit_size;
      break;
    case CostLaw::exponential:
      curve.C = unit_size * section.number("C", range);
      break;
    case CostLaw::power:
      curve.C = section.number("C", kPower);
      curve.B *= std::pow(unit_size, curve.C);
      break;
    case CostLaw::grades:
      break;
  }
  return curve;
}

DesignVariable variable_of(Section section, std::vector<Source> sources, const Robot& robot) {
  DesignVariable variable{.sources = std::move(sources), .cost = {}};
  const Unit inside = unit(variable.sources.front(), robot.actuator());
  const double unit_size = from_file_unit(inside, 1.0);
  const plausible::Range range = half_width(inside, robot.reach());
  variable.cost = curve_of(section, unit_size, range);
  if (variable.cost.law != CostLaw::grades) {
    variable.lower = unit_size * section.number("lower", range);
    variable.upper = unit_size * section.number("upper", range);
    if (variable.upper < variable.lower)
      section.fail(fmt::format("expected {} of at least lower", section.key_path("upper")));
  }
  section.refuse_others();
  return variable;
}

std::vector<DesignVariable> variables_of(Section section, const Robot& robot) {
  const Actuator actuator = robot.actuator();
  std::vector<DesignVariable> variables;
  for (const Source source : leading_sources(robot.limbs())) {
    std::optional<Section> cost = section.optional_table(file_key(source, actuator));
    if (!cost) continue;
    variables.push_back(variable_of(std::move(*cost), sharing(source, robot.limbs()), robot));
  }
  section.refuse_others();
  return variables;
}

/// With limits by yield, and only with these.
void read_max_failures(Section& root, const Robot& robot, AllocationProblem& problem) {
  const bool asked =
      std::ranges::any_of(problem.requirements, [](const Requirement& one) { return one.criterion == Spread::yield; });
  const toml::node* node = root.find("max_failures");
  if (node == nullptr && asked)
    root.fail("expected max_failures (accepted failure rate, for criterion = \"yield\"), got none");
  if (node == nullptr) return;
  const double share = root.number("max_failures", plausible::kFinite);
  if (!asked) root.fail(*node, "expected a requirement with criterion = \"yield\" for max_failures, got none");
  if (!(share > 0.0) || !(share < 0.5)) {
    root.fail(*node, fmt::format("expected max_failures above 0 and below 0.5, got {}", share));
  }
  problem.max_failures = share;
  problem.poses = surface_poses(robot);
}

}  // namespace

AllocationProblem read_allocation_problem(const TextFile& file, const Tolerances& rest, const Robot& robot) {
  const toml::table document = parse_toml(file);
  Section root(file.name, "", document);
  AllocationProblem problem{.rest = rest};
  for (const Section& section : root.tables("requirement")) {
    problem.requirements.push_back(requirement_of(section, robot));
  }
  if (problem.requirements.empty()) root.fail("expected at least one [[requirement]], got none");
  if (const std::optional<Section> costs = root.optional_table("cost")) {
    problem.variables = variables_of(*costs, robot);
  }
  read_max_failures(root, robot, problem);
  root.refuse_others();
  return problem;
}

}  // namespace paracal::io

#include "tolerancing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "measuring.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/tolerance/drawing_statement.hpp"
#include "paracal/units.hpp"

namespace paracal::app {

Tolerances tolerances_of(const Robot& robot, const std::string& file) {
  if (!file.empty()) return read_priors(io::read_stored(file), robot);
  return paracal::tolerances_of(robot);
}

std::optional<double> AngleOption::value() const {
  if (deg) return to_radians(*deg);
  return zone.empty() ? rad : turn_within(zone);
}

AngleUnit AngleOption::unit() const {
  if (deg) return {to_degrees(1.0), "deg"};
  if (zone.empty()) return {};
  const std::string length = zone.substr(zone.find('/') + 1);  // as it was checked
  return {std::stod(length), fmt::format("mm over {} mm", length)};
}

namespace {

Rule zone_validator() {
  const auto complaint = [](const std::string& text) {
    return turn_within(text) ? std::string()
                             : fmt::format("expected T/L with 0 < T < L in mm, as 0.1/100, got {}", text);
  };
  return {complaint, "T/L"};
}

}  // namespace

std::array<Option*, 3> add_angle_options(Command& command, AngleOption& angle, const std::string& option_in_rad,
                                         const std::string& stem, const std::string& text) {
  Option* rad = command.add_option(option_in_rad, angle.rad, text + ", in rad")
                    ->check(within(plausible::kLimitRad))
                    ->takes("RAD");
  Option* deg = command.add_option(stem + "-deg", angle.deg, "the same limit in degrees")
                    ->check(within(plausible::kLimitDeg))
                    ->excludes(rad);
  Option* zone =
      command.add_option(stem + "-mm", angle.zone, "the same limit in mm over a length in mm, such as 0.1/100")
          ->takes("MM/MM")
          ->check(zone_validator())
          ->excludes(rad)
          ->excludes(deg);
  return {rad, deg, zone};
}

Shown shown(Quantity quantity, double value) {
  if (unit(quantity) == Unit::mm) return {value, "mm"};
  if (quantity == Quantity::rotation) return {to_degrees(value), "deg"};
  return {value, "rad"};
}

Shown shown(const Requirement& requirement, double value, const AngleUnit& angles) {
  const Quantity quantity = requirement.characteristic.quantity;
  if (unit(quantity) == Unit::mm || quantity == Quantity::rotation) return shown(quantity, value);
  const AngleUnit unit = requirement.is_in_degrees ? AngleUnit{to_degrees(1.0), "deg"} : angles;
  return {unit.per_rad * value, unit.name};
}

std::string json_key(Characteristic characteristic) {
  std::string key = name(characteristic);
  std::ranges::replace(key, '-', '_');
  return fmt::format("{}_{}", key, shown(characteristic.quantity, 0.0).unit);
}

std::string pose_text(const Robot& robot, const Pose& pose) {
  const Eigen::Vector3d& r = pose.position;
  std::string place = fmt::format("({:.0f}, {:.0f}, {:.0f}) mm", r.x() + 0.0, r.y() + 0.0, r.z());
  if (robot.is_level()) return fmt::format("{}, {:.0f} deg", place, to_degrees(pose.rotation) + 0.0);
  if (!robot.commands_tilt()) return place;
  const Eigen::Vector3d tilt = pose.tilt.unaryExpr([](double angle) { return std::round(to_degrees(angle)) + 0.0; });
  return fmt::format("{}, tilted by ({:.0f}, {:.0f}, {:.0f}) deg", place, tilt.x(), tilt.y(), tilt.z());
}

namespace {

/// The next smaller number of so many digits; itself where it has few.
double rounded_down(double value) {
  constexpr int kTyped = 6, kDigits = 2;  // nobody types more; a drawing states two or three
  if (value <= 0.0 || std::stod(fmt::format("{:.{}g}", value, kTyped)) == value) return value;
  const double size = std::pow(10.0, std::floor(std::log10(value)) - (kDigits - 1));
  return std::stod(fmt::format("{:.{}g}", size * std::floor(value / size), kDigits));
}

}  // namespace

Tolerances rounded_down(const Robot& robot, Tolerances chosen, const Tolerances& rest) {
  for (const Source source : sources_of(robot.limbs())) {
    if (chosen[source] == rest[source]) continue;
    const Unit unit = paracal::unit(source, robot.actuator());
    chosen[source] = from_file_unit(unit, rounded_down(to_file_unit(unit, chosen[source])));
  }
  return chosen;
}

io::Json tilt_group_json(const PerSource& values) {
  io::Json json = io::Json::object();
  for (const Source source : all_sources()) {
    if (!tilts_plate(source)) continue;
    const bool over_width = source == "rod_difference" || source == "width_difference";
    json[fmt::format("{}{}", name(source), over_width ? "_over_c" : "")] = values(place(source));
  }
  return json;
}

void add_half_widths(io::Json& json, const Robot& robot, const Tolerances& tolerances) {
  json["half_widths"] = io::to_json(tolerances, robot.limbs());
  json["drawing"] = io::drawing_json(tolerances, robot);
}

io::Json contributors_json(const std::vector<Contributor>& contributors) {
  return io::json_array(contributors, [](const Contributor& one) {
    return io::Json{{"name", name(one.source)}, {"share", one.share}};
  });
}

std::string pareto(const std::vector<Contributor>& contributors) {
  constexpr double kLongest = 40.0;
  constexpr double kNegligible = 5e-4;
  std::string text;
  for (const Contributor& one : contributors) {
    if (one.share < kNegligible) continue;
    const auto length = static_cast<std::size_t>(std::lround(kLongest * one.share / contributors.front().share));
    fmt::format_to(std::back_inserter(text), "  {:<17}{:>6.1f} %  {}\n", name(one.source), 100.0 * one.share,
                   std::string(length, '#'));
  }
  return text;
}

Rule characteristic_validator() {
  const auto complaint = [](const std::string& text) {
    if (characteristic_named(text)) return std::string();
    std::string known;
    for (const Quantity quantity : kQuantities) known.append(known.empty() ? "" : ", ").append(name({quantity, false}));
    return fmt::format("expected one of {} (each also with \"-compensated\" appended), got {}", known, text);
  };
  return {complaint, "QUANTITY"};
}

SensitivityFindings find_sensitivity(const Robot& robot, Characteristic what, const Tolerances& tolerances,
                                     const GlobalSensitivityOptions& options) {
  SensitivityFindings found{.what = what, .global = global_sensitivity(robot, what, options)};
  found.tolerances = tolerances;
  found.worst = worst_spread(robot, what, tolerances, Spread::statistical);
  found.contributors = contributors(robot, LinearModel(robot).rows(found.worst.pose, what), tolerances);
  return found;
}

namespace {

/// By source: of tilt in the paper's units under the contract's six keys, of anything else, and with six degrees of
/// freedom, per mm, mm/m or rad.
io::Json per_source_json(const Robot& robot, Quantity quantity, const PerSource& values) {
  if (quantity == Quantity::tilt && robot.is_level()) return tilt_group_json(values * paper_units(robot));
  io::Json json = io::Json::object();
  for (const Source source : sources_of(robot.limbs())) {
    json[std::string(name(source))] = shown(quantity, values(place(source))).value;
  }
  return json;
}

}  // namespace

io::Json sensitivity_json(const Robot& robot, const SensitivityFindings& found) {
  const Quantity quantity = found.what.quantity;
  const auto of = [&](const PerSource& values) { return per_source_json(robot, quantity, values); };
  io::Json json{{"quantity", name(found.what)},
                {"poses", found.global.poses},
                {"global", of(found.global.mean)},
                {"global_error", of(found.global.error)},
                {"largest", of(found.global.largest)}};
  if (found.local) json["local"] = of(*found.local);
  json["worst"] = io::to_json(found.worst.pose, robot.commands_tilt());
  json["worst"]["three_sigma_" + json_key(found.what)] = shown(quantity, found.worst.value).value;
  json["contributors"] = contributors_json(found.contributors);
  add_half_widths(json, robot, found.tolerances);
  json["assumed"] = found.tolerances.assumed;
  return json;
}

io::Json three_sigma_json(const Robot& robot, Characteristic what, const Tolerances& tolerances) {
  const Shown unit = shown(what.quantity, 1.0);
  io::Json map = report::three_sigma_map(robot, what, tolerances, unit.value);
  map["quantity"] = name(what);
  map["unit"] = unit.unit;
  return map;
}

namespace {

/// The decimals of a percentage that show two digits of its distance from 100 %.
int decimals(double missing) {
  constexpr int kFewest = 3, kMost = 14;
  if (!(missing > 0.0)) return kFewest;
  return std::clamp(-static_cast<int>(std::floor(std::log10(100.0 * missing))) + 1, kFewest, kMost);
}

std::string share_text(const WeighedShare& share) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", share.value, share.interval.low, share.interval.high);
}

/// Which model and which simulated machines the yield comes from.
std::string source_text(const FailureShare& failures, const MonteCarlo& drawn) {
  const bool is_exact = drawn.model == Model::exact;
  switch (failures.status) {
    case FailureStatus::impossible:
      return fmt::format(
          "  counted: no failure in {} simulated machines; linear model: no machine within its tolerances can fail\n",
          drawn.machines);
    case FailureStatus::unsettled:
      return fmt::format("  counted: {} simulated machines, {} model{}; rarer failures not estimated: {}\n",
                         drawn.machines, is_exact ? "exact" : "linear", is_exact ? "" : " (try --model exact)",
                         failures.reason);
    case FailureStatus::settled:
      break;
  }
  const std::string linear =
      fmt::format("linear model: failure rate {}\n  (importance sampling, {} machines; second estimate {:.3g})",
                  share_text(failures.linear), failures.linear.machines, failures.check.value);
  if (is_counted(failures, drawn)) {
    return fmt::format("  counted: {} simulated machines, exact model; {}\n  no importance sampling: {}\n",
                       drawn.machines, linear, failures.reason);
  }
  if (!failures.exact) {
    return fmt::format("  {}\n  exact model not estimated ({}); use --model exact\n", linear, failures.reason);
  }
  return fmt::format("  exact model, {} simulated machines; {}\n", failures.exact->machines, linear);
}

}  // namespace

std::string yield_text(const FailureShare& failures, const MonteCarlo& drawn, double confidence) {
  const Proportion share = yield(failures, drawn, confidence), defects = defects_per_million(share);
  const double missing = is_counted(failures, drawn) ? 1.0 - share.value : failures.best().value;
  const int digits = decimals(missing);
  return fmt::format("yield {:.{}f} % [{:.{}f}, {:.{}f}]; defects per million {:.3g} [{:.3g}, {:.3g}]\n",
                     100.0 * share.value, digits, 100.0 * share.interval.low, digits, 100.0 * share.interval.high,
                     digits, defects.value, defects.interval.low, defects.interval.high) +
         source_text(failures, drawn);
}

std::string failure_line(const FailureShare& failures) {
  switch (failures.status) {
    case FailureStatus::impossible:
      return "  failure rate         0: no machine within its tolerances can fail (linear model)\n";
    case FailureStatus::unsettled:
      return fmt::format("  failure rate         not estimated: {}\n", failures.reason);
    case FailureStatus::settled:
      break;
  }
  return fmt::format("  failure rate         {}{}\n", share_text(failures.best()),
                     failures.exact ? "" : " (linear model)");
}

}  // namespace paracal::app

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "measuring.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct Options {
  MeasuringOptions measuring;
  std::string calibration;
  std::optional<double> limit_mm, limit_aligned_mm, limit_deg;
};

KnownErrors known_errors_of(const io::CalibratedMachine& machine) {
  KnownErrors known{machine.errors, {}, machine.covariance};
  for (const ParameterEstimate& one : machine.parameters) known.parameters.push_back({one.limb, one.source});
  if (known.covariance.size() == 0) known.parameters.clear();
  return known;
}

ValidationOptions validation_options(const Options& options) {
  ValidationOptions validation{.noise = options.measuring.noise(),
                               .frame = options.measuring.frame_kind(),
                               .rotation_zero = options.measuring.rotation_kind()};
  validation.limits.distance = options.limit_mm;
  validation.limits.volumetric = options.limit_aligned_mm;
  if (options.limit_deg) validation.limits.rotation = to_radians(*options.limit_deg);
  return validation;
}

io::Json iso_json(const Iso9283& iso) {
  io::Json json{{"max_AP_mm", iso.max_AP},
                {"max_RP_mm", iso.max_RP},
                {"max_AD_mm", iso.max_AD},
                {"max_RD_mm", iso.max_RD},
                {"poses", io::Json::array()}};
  for (const PoseCriteria& one : iso.poses) {
    json["poses"].push_back({{"pose", one.pose},
                             {"repeats", one.repeats},
                             {"AP_mm", one.AP},
                             {"RP_mm", one.RP},
                             {"AD_mm", one.AD},
                             {"RD_mm", one.RD}});
    if (!one.AP_rotation) continue;
    json["poses"].back()["AP_deg"] = to_degrees(*one.AP_rotation);
    json["poses"].back()["RP_deg"] = to_degrees(*one.RP_rotation);
  }
  return json;
}

/// Each pose against the first of its series.
io::Json poses_json(const Validation& validation) {
  io::Json json = io::Json::array();
  const ValidatedPose* home = nullptr;
  for (const ValidatedPose& one : validation.poses) {
    if (!home || home->series != one.series) home = &one;
    const PoseError before = error_relative_to(home->before, one.before),
                    after = error_relative_to(home->after, one.after);
    const auto error = [&](const PoseError& e) {
      io::Json json_error{{"d_rho_mm", e.distance}, {"d_v_mm", e.volumetric}, {"d_phi_deg", nullptr}};
      if (one.rotation) json_error["d_phi_deg"] = to_degrees(e.rotation);
      return json_error;
    };
    json.push_back({{"series", one.series}, {"pose", one.pose}, {"before", error(before)}, {"after", error(after)}});
    if (!one.covariance) continue;
    const Eigen::Matrix4d& c = *one.covariance;
    json.back()["predicted_U_mm"] = {kCoverageFactor * std::sqrt(c(0, 0)), kCoverageFactor * std::sqrt(c(1, 1)),
                                     kCoverageFactor * std::sqrt(c(2, 2))};
    json.back()["predicted_U_deg"] = to_degrees(kCoverageFactor * std::sqrt(c(3, 3)));
  }
  return json;
}

io::Json json_of(const Validation& validation) {
  io::Json json{{"accepted", validation.accepted},          {"reasons", validation.reasons},
                {"before", io::to_json(validation.before)}, {"after", io::to_json(validation.after)},
                {"iso9283", iso_json(validation.iso9283)},  {"checks", io::Json::array()},
                {"poses", poses_json(validation)}};
  for (const LimitCheck& check : validation.checks) {
    json["checks"].push_back({{"quantity", check.quantity},
                              {"error", check.error},
                              {"U", check.uncertainty},
                              {"limit", check.limit},
                              {"conformity", name(check.conformity)}});
  }
  return json;
}

std::string text_of(const Validation& validation) {
  std::string text = fmt::format("validation: {}\n", validation.accepted ? "accepted" : "not accepted");
  const auto out = std::back_inserter(text);
  for (const std::string& reason : validation.reasons) fmt::format_to(out, "  because {}\n", reason);
  fmt::format_to(out, "  largest errors over {} poses{:>14}{:>11}\n", validation.poses.size(), "before", "after");
  const auto line = [&](const char* what, double before, double after) {
    fmt::format_to(out, "  {:<38}{:>8.3f}{:>11.3f}\n", what, before, after);
  };
  const PoseErrorSummary &before = validation.before, &after = validation.after;
  line("distance to home, mm", before.max_abs_distance, after.max_abs_distance);
  line("position relative to home, mm", before.max_volumetric, after.max_volumetric);
  line("position after best alignment, mm", before.max_volumetric_aligned, after.max_volumetric_aligned);
  if (before.max_abs_rotation) {
    line("rotation relative to home, deg", to_degrees(*before.max_abs_rotation), to_degrees(*after.max_abs_rotation));
  }
  if (!validation.iso9283.poses.empty()) {
    const Iso9283& iso = validation.iso9283;
    fmt::format_to(out, "  ISO 9283, uncompensated, worst pose: AP {:.3f}, RP {:.3f}, AD {:.3f}, RD {:.3f} mm\n",
                   iso.max_AP, iso.max_RP, iso.max_AD, iso.max_RD);
  }
  for (const LimitCheck& check : validation.checks) {
    fmt::format_to(out, "  {}: {:.4g}, U {:.2g} (k = 2), limit {:.4g}: {}\n", check.quantity, check.error,
                   check.uncertainty, check.limit, name(check.conformity));
  }
  return text;
}

void run(const Options& options, Session& session) {
  const Robot robot = session.robot();
  const io::CalibratedMachine machine = io::read_calibration(io::read_file(options.calibration), robot);
  const Measurements measurements = options.measuring.read(robot.limb_count());
  const Validation validation = validate(robot, known_errors_of(machine), measurements, validation_options(options));
  session.json() ? session.print_json(json_of(validation)) : session.print(text_of(validation));
  if (!validation.accepted) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_validate(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "validate", "Calibrate a machine",
                                          "a calibration on poses that it has not seen; ISO 9283 from repeats");
  const auto options = std::make_shared<Options>();
  command->add_option("--calibration", options->calibration, "calibration (JSON)")->required();
  add_measuring_options(*command, options->measuring);
  command->add_option("--limit-mm", options->limit_mm, "largest distance error allowed")->check(positive_finite());
  command
      ->add_option("--limit-aligned-mm", options->limit_aligned_mm, "largest position error allowed, after alignment")
      ->check(positive_finite());
  command->add_option("--limit-deg", options->limit_deg, "largest rotation error allowed")->check(positive_finite());
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <memory>

#include "paracal/calibration/identification.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/units.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string measurements;
  std::string poses;
  std::string stage = "rough";
  double sigma_mm = CalibrationOptions{}.distance_sigma;
  double sigma_deg = to_degrees(CalibrationOptions{}.rotation_sigma);
};

std::int64_t seconds_of(std::string_view text) {
  constexpr std::int64_t kYear9999 = 253402300799;
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc{} || end != text.data() + text.size() || seconds < 0 || seconds > kYear9999) {
    throw WrongUsage(fmt::format("SOURCE_DATE_EPOCH: expected seconds since 1970, got \"{}\"", text));
  }
  return seconds;
}

/// Now, or SOURCE_DATE_EPOCH where someone wants the same bytes again.
std::int64_t date() {
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) return seconds_of(fixed);
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string residual_table(const Calibration& calibration) {
  std::string text = "  measured minus predicted, mm       distance     before      after\n";
  for (const ReadingResidual& residual : calibration.residuals) {
    fmt::format_to(std::back_inserter(text), "  {:<32}{:>11.3f}{:>11.3f}{:>11.3f}\n",
                   residual.from + " - " + residual.to, residual.distance, residual.distance_before,
                   residual.distance_after);
  }
  return text;
}

void run(const Options& options, Session& session) {
  const Robot robot = session.robot();
  const Measurements measurements = io::read_distances(options.measurements, options.poses, robot.limb_count());
  const Calibration calibration = calibrate(
      robot, measurements, {.distance_sigma = options.sigma_mm, .rotation_sigma = to_radians(options.sigma_deg)});
  const io::Json file = io::to_json(calibration, date());
  if (!session.out().empty()) session.print_json(file);
  if (session.json()) {
    if (session.out().empty()) session.print_json(file);
  } else {
    print_summary(calibration.brief() + residual_table(calibration) +
                  (session.out().empty() ? "" : fmt::format("  written to {}\n", session.out())));
  }
  if (!calibration.accepted()) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_calibrate(CLI::App& app, Session& session) {
  CLI::App* command =
      session.add_command(app, "calibrate", "Calibrate a machine",
                          "identify source errors from measurements; --out keeps the calibration (JSON)");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("--measurements", options->measurements,
                   "distances (CSV: from,to,distance_mm[,rotation_deg,sigma_mm])")
      ->required();
  command->add_option("--poses", options->poses, "poses that the distances name (CSV)")->required();
  command->add_option("--stage", options->stage, "rough: the encoder offsets")
      ->check(CLI::IsMember({"rough"}))
      ->capture_default_str();
  command->add_option("--sigma-mm", options->sigma_mm, "standard deviation of distances that state none")
      ->check(positive_finite())
      ->capture_default_str();
  command->add_option("--sigma-deg", options->sigma_deg, "standard deviation of rotations")
      ->check(positive_finite())
      ->capture_default_str();
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app

#include "paracal/compensation/export.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

#include "session.hpp"

namespace paracal::app {
namespace {

struct Options {
  std::string calibration;
  std::string target;
};

using Writer = std::string (*)(const Robot&, const SourceErrors&, const ExportOrigin&);
const std::map<std::string, Writer> kTargets{{"c99", c99_header}, {"linuxcnc", linuxcnc_component}};

void run(const Options& options, const Session& session) {
  const Robot robot = session.robot();
  const io::TextFile file = io::read_file(options.calibration);
  const SourceErrors errors = io::read_calibration(file, robot).errors;
  const ExportOrigin origin{.calibration = std::filesystem::path(options.calibration).filename().string(),
                            .sha256 = io::sha256(file.text),
                            .date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(now())))};
  const std::string text = kTargets.at(options.target)(robot, errors, origin);
  session.json()
      ? session.print_json(
            {{"target", options.target}, {"calibration_sha256", origin.sha256}, {"date", origin.date}, {"text", text}})
      : session.print(text);
}

}  // namespace

void add_export(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "export", "Compensate a machine", "the compensator for a controller");
  const auto options = std::make_shared<Options>();
  command->add_option("--calibration", options->calibration, "calibration (JSON)")->required();
  command->add_option("--target", options->target, "c99: one freestanding C99 header; linuxcnc: paracal_kins.comp")
      ->required()
      ->check(CLI::IsMember(kTargets));
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app

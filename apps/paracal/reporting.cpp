#include "reporting.hpp"

#include <algorithm>
#include <filesystem>

#include "embedded.hpp"
#include "paracal/error.hpp"
#include "paracal/report/error_map.hpp"
#include "paracal/report/page.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/version.hpp"
#include "session.hpp"

namespace paracal::app {

std::shared_ptr<std::string> add_report_option(Command& command, Session& session) {
  auto file = std::make_shared<std::string>();
  session.outputs.declare(command.add_option("--report", *file, "also write an HTML report, one self-contained file"));
  return file;
}

std::vector<InputFile> with_files(std::vector<InputFile> inputs, const Session& session,
                                  const std::vector<std::string>& files) {
  const auto add = [&](const std::string& name) {
    if (name.empty() || std::ranges::find(inputs, name, &InputFile::name) != inputs.end()) return;
    const io::TextFile file = io::read_file(name);
    inputs.push_back({file.name, io::sha256(file)});
  };
  for (const std::string& name : files) add(name);
  if (const auto& robot = session.robot_file()) add(robot->string());
  return inputs;
}

namespace {

/// Of files without their folders, which name users and customers.
std::string word_of_page(const std::string& word) {
  std::error_code ignored;
  const std::size_t value = word.starts_with("--") ? word.find('=') + 1 : 0;  // 0 where there is no value, too
  const std::filesystem::path path = word.substr(value);
  const bool names_file = path.has_filename() && path.has_parent_path() && exists(path.parent_path(), ignored);
  return names_file ? word.substr(0, value) + path.filename().string() : word;
}

std::string command_of_page(std::vector<std::string> words) {
  std::ranges::transform(words, words.begin(), word_of_page);
  return shell_line(words);
}

}  // namespace

io::Json report_data(const Session& session, const Robot& robot, const ReportContent& content) {
  return {{"format", "paracal report 1"},
          {"program", std::string("paracal ").append(version())},
          {"date", io::utc(now())},
          {"command", command_of_page(session.words)},
          {"kind", content.kind},
          {"robot", io::to_json(robot)},
          {"results", content.results},
          {"figures", content.figures},
          {"inputs", io::to_json(content.inputs)}};
}

std::string report_page(const io::Json& data) { return report::page(detail::report_page().front().text, data); }

void write_report(const std::string& file, Session& session, const Robot& robot, const ReportContent& content) {
  session.outputs.store.write(file, report_page(report_data(session, robot, content)));
}

namespace {

/// Lengths from a set-up that is sought with the rest do not see how high the machine stands, as heights above a plane:
/// what is drawn is what they do see.
void level(std::vector<report::ErrorArrow>& arrows) {
  double mean = 0.0;
  for (const report::ErrorArrow& arrow : arrows) mean += arrow.before.z() / static_cast<double>(arrows.size());
  for (report::ErrorArrow& arrow : arrows) arrow.before.z() -= mean;
}

}  // namespace

void add_error_map(const Robot& robot, const KnownErrors& known, ReportContent& content) {
  try {
    content.figures["error_map"] = report::error_map(robot, known);
  } catch (const Unreachable&) {
    for (io::Json& result : content.results) {
      result["notes"].push_back("no map of errors: the machine cannot reach all poses of its workspace");
    }
  }
}

CalibrationPage page_of(const Calibration& calibration, const Measurements& measurements) {
  CalibrationPage page{.arrows = report::measured_arrows(calibration, measurements), .map = calibration.accepted()};
  if (!page.arrows.empty() || !calibration.accepted()) return page;
  page.arrows = report::predicted_arrows(calibration.robot, calibration.errors(), measurements.stations);
  if (!measurements.lengths.empty()) level(page.arrows);
  return page;
}

void write_calibration_page(const std::string& file, Session& session, const Calibration& calibration,
                            const io::Json& json, const CalibrationPage& page) {
  const Robot& robot = calibration.robot;
  const KnownErrors known = known_errors(calibration);
  io::Json figures = io::Json::object();
  if (page.plan && robot.is_level()) figures["observability"] = report::observability(robot);
  if (!page.arrows.empty()) figures["scene"] = report::scene(robot, page.arrows, known.errors);
  ReportContent content{.kind = "calibration",
                        .results = {{"calibration", json}},
                        .figures = std::move(figures),
                        .inputs = with_files(calibration.files, session, page.files)};
  if (page.map) add_error_map(robot, known, content);
  write_report(file, session, robot, content);
}

}  // namespace paracal::app

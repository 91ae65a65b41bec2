#include "reporting.hpp"

#include <algorithm>

#include "embedded.hpp"
#include "paracal/report/page.hpp"
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

io::Json report_data(const Session& session, const Robot& robot, const ReportContent& content) {
  return {{"format", "paracal report 1"},
          {"program", std::string("paracal ").append(version())},
          {"date", io::utc(now())},
          {"command", session.command_line},
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

}  // namespace paracal::app

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/io/json.hpp"

namespace paracal::app {

class Session;

/// What a report shows.
struct ReportContent {
  std::string kind;                       ///< what was done: "calibration", "validation", ...
  io::Json results;                       ///< by command, as --json prints them
  io::Json figures = io::Json::object();  ///< what drawings need beyond
  std::vector<InputFile> inputs = {};
};

/// --report FILE; empty when it was not asked for.
std::shared_ptr<std::string> add_report_option(Command& command, Session& session);

/// Files that were read and are not in `inputs` yet, with the robot's; empty names are passed over.
std::vector<InputFile> with_files(std::vector<InputFile> inputs, const Session& session,
                                  const std::vector<std::string>& files);

/// The content with all that is needed to repeat it: what the page reads.
io::Json report_data(const Session& session, const Robot& robot, const ReportContent& content);

/// One HTML file that shows these data.
std::string report_page(const io::Json& data);

/// Writes the page, whole or not at all.
void write_report(const std::string& file, Session& session, const Robot& robot, const ReportContent& content);

}  // namespace paracal::app

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "paracal/io/published.hpp"
#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/reproduction.hpp"
#include "paracal/report/scene.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

using report::Reproduction;
using report::ReproductionRow;

std::string table(const Reproduction& reproduction) {
  std::string text = fmt::format("{:<58}{:>10}{:>10}{:>11}\n", "published quantity", "paper", "ours", "tolerance");
  for (const ReproductionRow& row : reproduction.rows) {
    fmt::format_to(std::back_inserter(text), "{:<58}{:>10.3f}{:>10.3f}{:>11}  {}\n", row.quantity + ", " + row.unit,
                   row.paper, row.ours, fmt::format("{:.2g}", row.tolerance), row.ok() ? "ok" : "DIFFERS");
  }
  const auto good = std::ranges::count_if(reproduction.rows, &ReproductionRow::ok);
  return text + fmt::format("{} of {} published numbers reproduced\n", good, reproduction.rows.size());
}

io::Json rows_json(const Reproduction& reproduction) {
  io::Json rows = io::Json::array();
  for (const ReproductionRow& row : reproduction.rows) {
    rows.push_back({{"id", row.id},
                    {"quantity", row.quantity},
                    {"unit", row.unit},
                    {"paper", row.paper},
                    {"ours", row.ours},
                    {"tolerance", row.tolerance},
                    {"ok", row.ok()}});
  }
  return rows;
}

/// The paper's tables as rows, and its figures from our numbers: 5 and 6 (tilt), 7 and 8 (poses), the machine and its
/// map.
void write_page(const std::string& file, const Session& session, const Reproduction& reproduction,
                const io::Json& result) {
  const Calibration& calibration = reproduction.calibration;
  const Robot& robot = calibration.robot;
  const Characteristic tilt{Quantity::tilt};
  const Tolerances tolerances = tolerances_of(robot);
  const KnownErrors known = known_errors(calibration);
  const auto arrows = report::predicted_arrows(robot, known.errors, io::published_huang2016().rough.stations);
  write_report(file, session, robot,
               {.kind = "reproduction",
                .results = {{"reproduction", result},
                            {"calibration", io::to_json(calibration, now())},
                            {"sensitivity", sensitivity_json(robot, find_sensitivity(robot, tilt, tolerances))}},
                .figures = {{"scene", report::scene(robot, arrows, known.errors)},
                            {"error_map", report::error_map(robot, known)},
                            {"observability", report::observability(robot)},
                            {"sigma_map", three_sigma_json(robot, tilt, tolerances)}},
                .inputs = calibration.files});
}

}  // namespace

void add_reproduce(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "reproduce", "Check this program", "published numbers beside ours");
  const auto paper = std::make_shared<std::string>();
  command->add_option("paper", *paper, "which publication")->required()->check(CLI::IsMember({"huang2016"}));
  const std::shared_ptr<std::string> page = add_report_option(*command);
  command->callback([&session, paper, page] {
    const Reproduction reproduction = report::reproduce_huang2016(io::published_huang2016());
    const io::Json result{{"paper", *paper}, {"rows", rows_json(reproduction)}};
    if (!page->empty()) write_page(*page, session, reproduction, result);
    session.json() ? session.print_json(result) : session.print(table(reproduction));
    if (!reproduction.ok()) session.exit_code = kVerdictIsNo;
  });
}

}  // namespace paracal::app

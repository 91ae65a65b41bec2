#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "paper/published.hpp"
#include "paper/reproduction.hpp"
#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/scene.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "tolerancing.hpp"

namespace paracal::app {
namespace {

using report::Finding;
using report::Reproduction;
using report::ReproductionRow;

std::string row_text(const ReproductionRow& row) {
  const auto& [tolerance, finding, reason] = row.judgement;
  const std::string line = fmt::format("  {:<54}{:>9.3f}{:>10.3f}{:>11.2g}  {}\n", row.quantity + ", " + row.unit,
                                       row.paper, row.ours, tolerance, name(finding));
  return row.ok() ? line : line + "      " + reason + "\n";
}

/// The rows of one table, and the cause where some are not reproduced.
std::string table_text(std::span<const ReproductionRow> rows) {
  std::string text = "\n" + rows.front().table + "\n", cause;
  for (const ReproductionRow& row : rows) {
    text += row_text(row);
    if (!row.cause.empty()) cause = "    cause: " + row.cause + "\n";
  }
  return text + cause;
}

std::string rows_text(std::span<const ReproductionRow> rows) {
  std::string text = fmt::format("\n{:<56}{:>9}{:>10}{:>11}\n", "", "paper", "ours", "tolerance");
  while (!rows.empty()) {
    const auto other = std::ranges::find_if(rows, [&](const auto& row) { return row.table != rows.front().table; });
    const auto size = static_cast<std::size_t>(other - rows.begin());
    text += table_text(rows.first(size));
    rows = rows.subspan(size);
  }
  return text;
}

std::string table(const Reproduction& reproduction) {
  std::string text = "published numbers compared with ours, all by one rule:\n";
  for (const std::string& sentence : report::rule_in_words()) text += "- " + sentence + "\n";
  text += rows_text(reproduction.rows) + fmt::format("\n{} published numbers", reproduction.rows.size());
  const char* mark = ": ";
  for (const Finding finding :
       {Finding::reproduced, Finding::not_contradicted, Finding::not_reproduced, Finding::cannot_be_tested}) {
    text += fmt::format("{}{} {}", std::exchange(mark, ", "), reproduction.count(finding), name(finding));
  }
  return text + "\n";
}

io::Json row_json(const ReproductionRow& row) {
  return {{"id", row.id},
          {"table", row.table},
          {"quantity", row.quantity},
          {"unit", row.unit},
          {"paper", row.paper},
          {"ours", row.ours},
          {"tolerance", row.judgement.tolerance},
          {"ok", row.ok()},
          {"verdict", name(row.judgement.finding)},
          {"reason", row.cause.empty() ? row.judgement.reason : row.judgement.reason + "; " + row.cause}};
}

io::Json result_json(const std::string& paper, const Reproduction& reproduction) {
  return {{"paper", paper},
          {"rule", report::rule_in_words()},
          {"rows", io::json_array(reproduction.rows, row_json)},
          {"counts",
           {{"reproduced", reproduction.count(Finding::reproduced)},
            {"not_contradicted", reproduction.count(Finding::not_contradicted)},
            {"not_reproduced", reproduction.count(Finding::not_reproduced)},
            {"cannot_be_tested", reproduction.count(Finding::cannot_be_tested)}}}};
}

/// The paper's tables as rows, and its figures from our numbers: 5 and 6 (tilt), 7 and 8 (poses), the machine and its
/// map.
void write_page(const std::string& file, Session& session, const Reproduction& reproduction, const io::Json& result) {
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

void add_reproduce(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "reproduce", "Check this program", "compare published results with ours");
  const auto paper = std::make_shared<std::string>();
  command->add_option("paper", *paper, "publication to reproduce")->required()->check(one_of({"huang2016"}));
  command->get_option("--robot")->check(one_of({"huang2016"}));
  command->example("All tables and figures of Huang et al. (2016)", "paracal reproduce huang2016");
  const std::shared_ptr<std::string> page = add_report_option(*command, session);
  command->callback([&session, paper, page] {
    const Reproduction reproduction = report::reproduce_huang2016(io::published_huang2016(), session.threads());
    const io::Json result = result_json(*paper, reproduction);
    if (!page->empty()) write_page(*page, session, reproduction, result);
    session.json() ? session.print_json(result) : session.print(table(reproduction));
  });
}

}  // namespace paracal::app

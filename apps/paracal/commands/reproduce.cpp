#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "paracal/io/published.hpp"
#include "paracal/report/reproduction.hpp"
#include "session.hpp"

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

}  // namespace

void add_reproduce(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "reproduce", "Check this program", "published numbers beside ours");
  const auto paper = std::make_shared<std::string>();
  command->add_option("paper", *paper, "which publication")->required()->check(CLI::IsMember({"huang2016"}));
  command->callback([&session, paper] {
    const Reproduction reproduction = report::reproduce_huang2016(io::published_huang2016());
    session.json() ? session.print_json(io::Json{{"paper", *paper}, {"rows", rows_json(reproduction)}})
                   : session.print(table(reproduction));
    if (!reproduction.ok()) session.exit_code = kVerdictIsNo;
  });
}

}  // namespace paracal::app

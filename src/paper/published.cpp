#include "published.hpp"

#include "embedded.hpp"
#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

TextFile embedded(std::string_view name) {
  for (const detail::EmbeddedFile& file : detail::published_data()) {
    if (file.name == name) return {"huang2016/" + std::string(name), std::string(file.text)};
  }
  throw Error("no published data named " + std::string(name));
}

std::vector<PublishedHuang2016::Table3Row> table3(std::string_view state) {
  const CsvTable table(embedded("table3.csv"));
  std::vector<PublishedHuang2016::Table3Row> rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.text(row, "state") != state) continue;
    rows.push_back({table.text(row, "point"),
                    {table.number(row, "d_rho_mm", plausible::kFinite), table.number(row, "d_v_mm", plausible::kFinite),
                     to_radians(table.number(row, "d_phi_deg", plausible::kFinite))}});
  }
  return rows;
}

std::array<double, ErrorModel::kTilt> table2() {
  const CsvTable table(embedded("table2.csv"));
  return {1e-3 * table.number(0, "rod_difference_over_c", plausible::kFinite),
          1e-3 * table.number(0, "width_difference_over_c", plausible::kFinite),
          1e-3 * table.number(0, "alpha03", plausible::kFinite),
          1e-3 * table.number(0, "beta03", plausible::kFinite),
          1e-3 * table.number(0, "alpha2", plausible::kFinite),
          1e-3 * table.number(0, "beta2", plausible::kFinite)};
}

/// Table 4 prints angles times the arm's length, in mm.
SourceErrors table4() {
  const CsvTable table(embedded("table4.csv"));
  const double arm = catalogue::huang2016().nominal().limbs[0].arm;
  SourceErrors errors;
  for (std::size_t limb = 0; limb < table.row_count(); ++limb) {
    for (const Source source : sources_of(Actuator::revolute).first(ErrorModel::kPosition)) {
      const bool angle = unit(source, Actuator::revolute) == Unit::rad;
      const std::string column = (angle ? "L_" : "") + std::string(name(source));
      errors(limb, source) =
          table.optional_number(limb, column, plausible::kFinite).value_or(0.0) / (angle ? arm : 1.0);
    }
  }
  return errors;
}

PoseError table5(std::string_view state) {
  const CsvTable table(embedded("table5.csv"));
  const std::size_t row = table.text(0, "state") == state ? 0 : 1;
  return {table.number(row, "d_rho_mm", plausible::kFinite), table.number(row, "d_v_mm", plausible::kFinite),
          to_radians(table.number(row, "d_phi_deg", plausible::kFinite))};
}

}  // namespace

PublishedHuang2016 published_huang2016() {
  return {.rough = read_distances(embedded("distances.csv"), embedded("poses.csv")),
          .offsets = read_source_errors(embedded("offsets.toml"), 4),
          .before = table3("before"),
          .after = table3("after"),
          .table2 = table2(),
          .figures = {},
          .table4 = table4(),
          .table5_before = table5("before"),
          .table5_after = table5("after")};
}

}  // namespace paracal::io

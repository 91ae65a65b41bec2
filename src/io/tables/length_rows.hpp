#pragma once

// Private to io: the rows of a table of lengths.

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "columns.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/io/csv.hpp"

namespace paracal::io {

/// Of the first kind where there is none, whose column is then told to be missing.
inline const LengthWords& kind_of(const CsvTable& table) {
  const auto& kinds = length_kinds();
  const auto has = [&](const LengthWords& kind) { return table.has(kind.column); };
  const auto found = std::ranges::find_if(kinds, has);
  return found == kinds.end() ? kinds.front() : *found;
}

/// Rows of a table of lengths, whose header it has checked: a series for every set-up that they name.
class LengthRows {
 public:
  LengthRows(const CsvTable& table, std::string title, double reach)
      : table_(table), kind_(kind_of(table)), title_(std::move(title)), reach_(reach), has_at_(says_at()) {
    std::vector<std::string_view> columns{"pose", kind_.column, "sigma_mm"};
    if (has_columns()) columns.insert(columns.end(), kind_.at_columns.begin(), kind_.at_columns.end());
    table.allow_only(columns);
  }

  void add(std::size_t row, std::size_t station) {
    const plausible::Range range = kind_.positive ? plausible::positive_length(reach_) : plausible::length(reach_);
    const double length = table_.number(row, kind_.column, range);
    LengthSeries& series = series_at(row);
    if (series.readings.empty()) first_rows_.push_back(row);
    series.readings.push_back(
        {.station = station, .length = length, .sigma = table_.optional_number(row, "sigma_mm", plausible::kNoise)});
  }

  /// @throws InputFileError for a set-up whose readings do no more than tell where it is.
  std::vector<LengthSeries> take() && {
    for (std::size_t k = 0; k < series_.size(); ++k) {
      if (series_[k].readings.size() > kind_.unknowns) continue;
      table_.fail(first_rows_[k],
                  fmt::format("expected at least {} readings of one setup ({} determine its position), got {} of {}: "
                              "measure more poses",
                              kind_.unknowns + 1, kind_.unknowns, series_[k].readings.size(), series_[k].name));
    }
    return std::move(series_);
  }

 private:
  bool has_columns() const { return !kind_.at_columns.front().empty(); }
  bool says_at() const {
    return kind_.needs_at || (has_columns() && std::ranges::any_of(kind_.at_columns, [&](std::string_view column) {
                                return table_.has(column);
                              }));
  }

  std::optional<Eigen::Vector3d> at(std::size_t row) const {
    if (!has_at_) return std::nullopt;
    Eigen::Vector3d at;
    const plausible::Range range = kind_.needs_at ? plausible::kDirection : plausible::length(reach_);
    for (Eigen::Index k = 0; k < 3; ++k) {
      at(k) = table_.number(row, kind_.at_columns[static_cast<std::size_t>(k)], range);
    }
    if (kind_.needs_at && at.isZero(0.0)) table_.fail(row, fmt::format("expected {}, got 0, 0, 0", kind_.at));
    return at;
  }

  LengthSeries& series_at(std::size_t row) {
    const std::optional<Eigen::Vector3d> at = this->at(row);
    const auto same = [&](const LengthSeries& one) { return one.at == at; };
    const auto found = std::ranges::find_if(series_, same);
    if (found != series_.end()) return *found;
    std::string name = title_;
    if (!series_.empty()) name += fmt::format(" ({:g}, {:g}, {:g})", at->x(), at->y(), at->z());
    return series_.emplace_back(LengthSeries{std::move(name), kind_.kind, {}, at});
  }

  const CsvTable& table_;
  const LengthWords& kind_;
  std::string title_;
  double reach_;  ///< of the robot, mm
  bool has_at_;
  std::vector<LengthSeries> series_;
  std::vector<std::size_t> first_rows_ = {};  ///< of each
};

}  // namespace paracal::io

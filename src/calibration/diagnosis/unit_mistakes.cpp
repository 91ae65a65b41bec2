#include "mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "command_mistakes.hpp"
#include "reading_mistakes.hpp"

namespace paracal::detail {
namespace {

/// Readings that may be in a unit of their own.
struct Batch {
  std::string text;  ///< "the readings of heights.csv"
  std::function<void(Measurements&, double)> scale;
};

std::string series_named(const std::string& name, std::string_view kind, std::size_t place) {
  return name.empty() ? fmt::format("the {} of series {}", kind, place + 1) : fmt::format("the readings of {}", name);
}

void add_points(const Measurements& measurements, std::vector<Batch>& all) {
  const std::size_t count = measurements.series.size();
  for (std::size_t k = 0; k < count; ++k) {
    all.push_back({series_named(measurements.series[k].name, "points", k),
                   [k](Measurements& m, double factor) { scale_points(m.series[k], factor); }});
  }
}

void add_lengths(const Measurements& measurements, std::vector<Batch>& all) {
  for (std::size_t k = 0; k < measurements.lengths.size(); ++k) {
    const LengthSeries& series = measurements.lengths[k];
    all.push_back({series_named(series.name, words(series.kind).plural, k),
                   [k](Measurements& m, double factor) { scale_lengths(m.lengths[k], factor); }});
  }
}

void add_distances(const Measurements& measurements, std::vector<Batch>& all) {
  if (measurements.distances.empty()) return;
  all.push_back({"the distances", [](Measurements& m, double factor) { scale_distances(m, factor); }});
}

/// All of a kind, where it has several series.
void add_kinds(const Measurements& measurements, std::vector<Batch>& all) {
  if (measurements.series.size() > 1) {
    all.push_back({"the points", [](Measurements& m, double factor) {
                     for (PointSeries& series : m.series) scale_points(series, factor);
                   }});
  }
  for (const LengthWords& kind : length_kinds()) {
    const auto is_of_kind = [is = kind.kind](const LengthSeries& series) { return series.kind == is; };
    if (std::ranges::count_if(measurements.lengths, is_of_kind) < 2) continue;
    all.push_back({fmt::format("the {}", kind.plural), [is_of_kind](Measurements& m, double factor) {
                     for (LengthSeries& series : m.lengths) {
                       if (is_of_kind(series)) scale_lengths(series, factor);
                     }
                   }});
  }
}

/// Parts of the readings; none where there is but one.
std::vector<Batch> batches(const Measurements& measurements) {
  std::vector<Batch> all;
  add_points(measurements, all);
  add_lengths(measurements, all);
  add_distances(measurements, all);
  if (all.size() < 2) return {};
  add_kinds(measurements, all);
  return all;
}

}  // namespace

std::vector<Mistake> unit_mistakes(const Input& given) {
  const Measurements& measurements = given.measurements;
  const bool lengths = joint_unit(given.robot.actuator()) == Unit::mm && states_joints(measurements);
  const std::vector<Batch> parts = batches(measurements);
  std::vector<Mistake> all;
  const auto add = [&](std::string text, std::function<void(Measurements&)> undo) {
    all.push_back(mistake_of_measurements("unit", std::move(text), std::move(undo)));
  };
  if (auto part = part_in_another_unit(measurements)) all.push_back(std::move(*part));
  for (const auto& [name, mm] : kOtherUnits) {
    const double factor = mm;
    add(fmt::format("the readings are in {}", name), [=](Measurements& m) { scale_readings(m, factor); });
    for (const Batch& part : parts) {
      add(fmt::format("{} are in {}", part.text, name),
          [scale = part.scale, factor](Measurements& m) { scale(m, factor); });
    }
    if (!lengths && !commands_count(measurements)) continue;
    const auto scale_commanded = [=](Measurements& m) {
      scale_commands(m, factor);
      if (lengths) scale_joints(m, factor);
    };
    const char* commanded = lengths ? "joints and commanded poses" : "the commanded poses";
    add(fmt::format("{} are in {}", commanded, name), scale_commanded);
    add(fmt::format("the readings and {} are in {}", commanded, name), [=](Measurements& m) {
      scale_readings(m, factor);
      scale_commanded(m);
    });
  }
  return all;
}

}  // namespace paracal::detail

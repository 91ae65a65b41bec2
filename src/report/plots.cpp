#include "paracal/report/plots.hpp"

#include <algorithm>
#include <cmath>

#include "figures.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/tolerance/sensitivity.hpp"

namespace paracal::report {
namespace {

using detail::rounded;

constexpr int kHistogramBins = 40;

io::Json curve_json(const PaperPlan& plan) {
  const auto point_json = [](const CurvePoint& point) {
    return io::Json{{"n", point.n}, {"O2", rounded(point.indices.O2)}, {"change", rounded(point.change)}};
  };
  return {{"n", plan.n}, {"curve", io::json_array(plan.curve, point_json)}};
}

}  // namespace

io::Json observability(const Robot& robot) {
  return {{"rough", curve_json(paper_plan(robot, Stage::rough))}, {"fine", curve_json(paper_plan(robot, Stage::fine))}};
}

io::Json three_sigma_map(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                         double factor) {
  io::Json json = detail::map_axes(robot.workspace());
  for (const auto& [pose, sigma] : sigma_map(robot, characteristic, tolerances, detail::kMapGrid, false)) {
    json["points"].push_back(detail::place_json(pose.position));
    json["points"].back()["value"] = rounded(3.0 * factor * sigma);
  }
  return json;
}

io::Json histogram(const Histogram& histogram, double factor) {
  if (histogram.total() == 0) return {{"bin_width", 0.0}, {"counts", io::Json::array()}, {"total", 0}};
  const double last = histogram.quantile(1.0) * (1.0 + 1e-9);
  const double width = last > 0.0 ? last / kHistogramBins : 1.0;
  std::vector<std::uint64_t> counts(kHistogramBins, 0);
  for (const auto& [number, count] : histogram.counts()) {
    const double bin = std::floor(Histogram::value_of(number) / width);
    counts[static_cast<std::size_t>(std::clamp(bin, 0.0, kHistogramBins - 1.0))] += count;
  }
  return {{"bin_width", rounded(factor * width)}, {"counts", counts}, {"total", histogram.total()}};
}

}  // namespace paracal::report

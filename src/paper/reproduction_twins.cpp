#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "paracal/units.hpp"
#include "reproduction_rows.hpp"
#include "virtual_twins.hpp"

namespace paracal::report::detail {
namespace {

constexpr int kTwins = 399;    // 10 below and 10 above the central 95 % for one more
constexpr int kTilted = 2000;  // no fit, so more of them: the share that is asked for is small

std::vector<double> scaled(std::vector<double> values, double scale) {
  for (double& value : values) value *= scale;
  return values;
}

/// Found again, not reproduced: the median of what the paper's method finds on machines that have Table 4's errors. Of
/// e_y1 and e_y2 only the difference can be found (docs/paper-slips.md, 2.3).
class Table4 {
 public:
  Table4(const Robot& robot, const SourceErrors& paper, const Twins& twins, Rows& rows)
      : robot_(robot),
        paper_(paper),
        twins_(twins),
        table_(rows, fmt::format("Table 4: recovered from {} twins", twins.count),
               "each of these 95 % intervals misses the value in 1 of 20 cases") {}

  void add_rows() {
    for (std::size_t limb = 0; limb < robot_.limb_count(); ++limb) {
      for (const Source source : sources_of(robot_.actuator()).first(ErrorModel::kPosition)) {
        if (paper_(limb, source) != 0.0) add(limb, source);
      }
    }
    add_difference();
  }

 private:
  void add(std::size_t limb, Source source) {
    const bool angle = unit(source, robot_.actuator()) == Unit::rad;
    const double scale = angle ? robot_.nominal().limbs[0].arm : 1.0, paper = scale * paper_(limb, source);
    const std::vector<double> found = scaled(twins_.identified[limb][source], scale);
    const bool unseen = source == "e_y" && limb < 2;
    table_.add(fmt::format("table4.{}.limb{}", name(source), limb + 1),
               fmt::format("{}{} of limb {}", angle ? "L " : "", name(source), limb + 1), "mm", paper, median(found),
               unseen ? unidentifiable(found) : judged(paper, found));
  }

  void add_difference() {
    std::vector<double> found = twins_.identified[0]["e_y"];
    for (std::size_t n = 0; n < found.size(); ++n) found[n] -= twins_.identified[1]["e_y"][n];
    const double paper = paper_(0, "e_y") - paper_(1, "e_y");
    table_.add("table4.e_y.limb1-limb2", "e_y of limb 1 minus limb 2", "mm", paper, median(found),
               judged(paper, found, 2));
  }

  static Judgement judged(double paper, const std::vector<double>& found, int printed = 1) {
    return found_again(judge(paper, median(found), printed * rounding(3), median_interval(found)));
  }

  /// The tolerance says how much its finding scatters all the same.
  static Judgement unidentifiable(const std::vector<double>& found) {
    const Interval range = median_interval(found);
    return {0.5 * (range.high - range.low), Finding::cannot_be_tested,
            "distances determine only the difference of limbs 1 and 2"};
  }

  const Robot& robot_;
  const SourceErrors& paper_;
  const Twins& twins_;
  Table table_;
};

/// The published machine among its twins, measured as it was: all six by the same range.
void add_table5(const char* state, const PoseError& paper, const Largest& twins, Rows& rows) {
  Table table(rows, fmt::format("Table 5, {}: within the central 95 % of twins (median shown)", state),
              "d_v depends on the alignment of the instrument's frame, which the paper does not state");
  const auto add = [&](const char* symbol, const char* words, const char* unit, double published,
                       const std::vector<double>& found, int decimals) {
    table.add(fmt::format("table5.{}.{}", state, symbol), words, unit, published, median(found),
              judge(published, median(found), rounding(decimals), central_range(found)));
  };
  add("d_rho", "largest distance error", "mm", paper.distance, twins.distance, 3);
  add("d_v", "largest volumetric error", "mm", paper.volumetric, twins.volumetric, 3);
  add("d_phi", "largest rotational error", "deg", to_degrees(paper.rotation), scaled(twins.rotation, to_degrees(1.0)),
      1);
}

Proportion share(const std::vector<Place>& places, double rim, io::Layer layer) {
  const auto there = std::ranges::count_if(
      places, [&](const Place& place) { return place.layer == static_cast<int>(layer) && place.radius > 0.99 * rim; });
  return proportion(static_cast<std::uint64_t>(there), places.size(), kConfidence);
}

/// The published machine did so: 1 of 1.
void add_share(Table& table, const char* id, std::string words, const Proportion& share) {
  table.add(id, std::move(words), "1", 1.0, share.value, judge_share(share));
}

std::string_view name(io::Layer layer) {
  return layer == io::Layer::top ? "top" : layer == io::Layer::middle ? "middle" : "bottom";
}

/// Figure 9 shows where the largest errors of one machine stand.
void add_figure9(const Robot& robot, const io::PublishedHuang2016::Figures& published, const Largest& twins,
                 Rows& rows) {
  Table table(rows, "Figure 9: fraction of twins with the largest error where the paper's machine had it");
  const auto add = [&](const char* id, const char* error, const std::vector<Place>& places, io::Layer layer) {
    add_share(table, id, fmt::format("{} error, {} rim", error, name(layer)),
              share(places, robot.workspace().radius, layer));
  };
  add("figure9.a", "distance", twins.of_distance, published.distance);
  add("figure9.b", "volumetric", twins.of_volumetric, published.volumetric);
  add("figure9.c", "rotational", twins.of_rotation, published.rotation);
}

/// The concluding tilt and where it was found, among machines within Table 2's tolerances.
void add_tilt(const Robot& robot, const io::PublishedHuang2016::Figures& published, const Tilts& tilts, Rows& rows) {
  const auto reached = std::ranges::count_if(tilts.bottom, [&](double tilt) { return tilt >= published.tilt; });
  Table table(
      rows, "Tilt within Table 2's tolerances: fraction of twins that agree with the paper's machine",
      fmt::format("half of the twins stay below {:.3f}/100; noise of tilt readings is not included, because the "
                  "paper does not state the distance between its two reflectors",
                  100.0 * median(tilts.bottom)));
  add_share(table, "tilt.reached", fmt::format("tilt of {:.3f}/100 reached in the bottom layer", 1e2 * published.tilt),
            proportion(static_cast<std::uint64_t>(reached), tilts.bottom.size(), kConfidence));
  add_share(table, "tilt.bottom", fmt::format("largest tilt of all layers, {} rim", name(published.tilted_most)),
            share(tilts.largest, robot.workspace().radius, published.tilted_most));
}

}  // namespace

void add_twins(const Robot& robot, const io::PublishedHuang2016& published, unsigned threads, Rows& rows) {
  add_tilt(robot, published.figures, tilt_twins(robot, published.table4, kTilted, threads), rows);
  const Twins twins = calibrate_twins(robot, published.table4, kTwins, threads);
  Table4(robot, published.table4, twins, rows).add_rows();
  add_table5("before", published.table5_before, twins.before, rows);
  add_table5("after", published.table5_after, twins.after, rows);
  add_figure9(robot, published.figures, twins.after, rows);
}

}  // namespace paracal::report::detail

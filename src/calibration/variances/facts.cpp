#include "facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "fact_search.hpp"
#include "numerics/dense.hpp"
#include "reflector_places.hpp"

namespace paracal::detail {
namespace {

/// Odds that a machine or its readings have any of a kind of wrong fact, one in a hundred to one in two thousand, times
/// what it takes from a likelihood that the size of the fact is chosen after the readings (sizes are as likely on a
/// scale of logarithms over two decades, and are told to about a factor of four). A whole kind is wrong where a part
/// is, too: far less often.
constexpr double kChosen = 0.3;
constexpr double kAnyError = 0.01 * kChosen, kAnyKind = 0.0005 * kChosen, kAnyCentre = 0.001 * kChosen,
                 kAnyPose = 0.01 * kChosen, kAnyPlace = 0.01 * kChosen, kAnySeries = 0.01 * kChosen;

/// Lists what may be wrong, with what it does to the readings.
class FactList {
 public:
  FactList(const StageFit& fit, const Measurements& measurements, FactSearch& search)
      : fit_(fit), measurements_(measurements), search_(search) {}

  void add_errors() {
    const double odds = kAnyError / static_cast<double>(std::max<std::size_t>(sought().size(), 1));
    for (std::size_t k = 0; k < sought().size(); ++k) {
      add_parts({k}, fmt::format("{} of limb {}", name_of(k), sought()[k].limb + 1), odds);
    }
  }

  void add_kinds() {
    std::vector<Source> kinds;
    for (const SoughtSource& one : sought()) {
      if (std::ranges::find(kinds, one.source) == kinds.end()) kinds.push_back(one.source);
    }
    for (const Source kind : kinds) {
      add_parts(places([&](const SoughtSource& one) { return one.source == kind; }),
                fmt::format("{} of all limbs", name(kind)), kAnyKind / static_cast<double>(kinds.size()));
    }
  }

  /// A bracket that is mounted elsewhere is off in more than one coordinate.
  void add_joint_centres() {
    const std::size_t limbs = fit_.observation().robot().limb_count();
    for (std::size_t limb = 0; limb < limbs; ++limb) {
      add_centre(limb, {"e_x", "e_y", "e_z", "base_x", "base_y", "base_z", "normal", "across"}, limbs);
      add_centre(limb, {"plate_x", "plate_y", "plate_z"}, limbs);
    }
  }

  void add_poses(const LinearReadings& readings) {
    std::map<std::size_t, double> visits;
    for (const ReadingBlock& one : readings.blocks) {
      visits[one.station] += one.visits;
      if (one.from != one.station) visits[one.from] += one.visits;
    }
    for (const auto& [pose, count] : visits) {
      constexpr double kTwice = 2.0;  // a single reading that is wrong is an outlier
      if (count < kTwice) continue;
      search_.add({.fact = {.pose = pose},
                   .subject = fmt::format("pose {}", measurements_.stations[pose].name),
                   .odds = kAnyPose / static_cast<double>(measurements_.stations.size())});
    }
  }

  void add_places(const LinearReadings& readings) {
    for (ReflectorPlace& one : reflector_places(fit_, measurements_, readings)) {
      search_.add({.fact = {.mount = one.mount, .effect = std::move(one.effect)},
                   .subject = std::move(one.subject),
                   .odds = kAnyPlace});
    }
  }

  /// Beside another series: the noise of all of them is no single fact.
  void add_series(const LinearReadings& readings) {
    std::map<std::size_t, bool> all;
    for (const ReadingBlock& one : readings.blocks) all[one.series] |= one.stated;
    if (all.size() < 2) return;
    for (const auto& [series, stated] : all) {
      if (!stated) continue;
      search_.add({.fact = {.series = series},
                   .subject = name_of_series(series),
                   .odds = kAnySeries / static_cast<double>(all.size())});
    }
  }

 private:
  const std::vector<SoughtSource>& sought() const { return fit_.observation().sought(); }
  std::string_view name_of(std::size_t place) const { return name(sought()[place].source); }

  std::string name_of_series(std::size_t series) const {
    const ReadingSeries& one = *fit_.observation().series()[series];
    if (const auto kind = one.length_kind()) return fmt::format("the {} of {}", words(*kind).plural, one.name());
    return one.quantity() == Quantity::distance ? "the distances" : fmt::format("the points of {}", one.name());
  }

  template <typename Chosen>
  std::vector<std::size_t> places(Chosen&& chosen) const {
    std::vector<std::size_t> list;
    for (std::size_t k = 0; k < sought().size(); ++k) {
      if (sought()[k].prior_std && chosen(sought()[k])) list.push_back(k);
    }
    return list;
  }

  void add_centre(std::size_t limb, const std::vector<Source>& coordinates, std::size_t limbs) {
    std::vector<std::size_t> list = places([&](const SoughtSource& one) {
      return one.limb == limb && std::ranges::find(coordinates, one.source) != coordinates.end();
    });
    if (list.size() < 2) return;
    std::string names;
    for (const std::size_t k : list) names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(k));
    add_parts(std::move(list), fmt::format("{} of limb {}", names, limb + 1), kAnyCentre / static_cast<double>(limbs));
  }

  void add_parts(std::vector<std::size_t> errors, std::string subject, double odds) {
    if (errors.empty()) return;
    if (!std::ranges::all_of(errors, [&](std::size_t k) { return sought()[k].prior_std.has_value(); })) return;
    search_.add({.fact = {.errors = std::move(errors)}, .subject = std::move(subject), .odds = odds});
  }

  const StageFit& fit_;
  const Measurements& measurements_;
  FactSearch& search_;
};

}  // namespace

SuspectedFacts suspected_facts(const StageFit& fit, const Measurements& measurements, const CalibrationOptions& options,
                               const VarianceTable& table, const Eigen::VectorXd& u) {
  FactSearch search(table, u);
  FactList list(fit, measurements, search);
  list.add_errors();
  list.add_kinds();
  list.add_joint_centres();
  if (options.exclude_outliers) list.add_poses(table.readings());
  if (search.is_strange()) {
    list.add_places(table.readings());
    list.add_series(table.readings());
  }
  return search.found();
}

}  // namespace paracal::detail

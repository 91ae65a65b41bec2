#include "facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

/// Odds that a machine or its readings have any of a kind of wrong fact, one in a hundred to one in two thousand, times
/// what it takes from a likelihood that the size of the fact is chosen after the readings (sizes are as likely on a
/// scale of logarithms over two decades, and are told to about a factor of four). A whole kind is wrong where a part
/// is, too: far less often.
constexpr double kChosen = 0.3;
constexpr double kAnyError = 0.01 * kChosen, kAnyKind = 0.0005 * kChosen, kAnyCentre = 0.001 * kChosen,
                 kAnyPose = 0.01 * kChosen;

class Suspicion {
 public:
  Suspicion(const StageFit& fit, const VarianceTable& table, const VarianceTable::At& at)
      : fit_(fit), readings_(table.readings()), at_(at) {
    const auto by_parts = readings_.by_errors.leftCols(readings_.prior.rows());
    information_ = product(by_parts.transpose(), product(at.P, by_parts));
    told_ = product(by_parts.transpose(), at.z);
    squares_ = readings_.y.dot(at.z);
  }

  void add_errors() {
    const double odds = kAnyError / static_cast<double>(std::max<std::size_t>(sought().size(), 1));
    for (std::size_t k = 0; k < sought().size(); ++k) {
      add({k}, fmt::format("{} of limb {}", name_of(k), sought()[k].limb + 1), odds);
    }
  }

  void add_kinds() {
    std::vector<Source> kinds;
    for (const SoughtSource& one : sought()) {
      if (std::ranges::find(kinds, one.source) == kinds.end()) kinds.push_back(one.source);
    }
    for (const Source kind : kinds) {
      add(places([&](const SoughtSource& one) { return one.source == kind; }),
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

  void add_poses(const std::vector<Station>& stations) {
    std::vector<std::vector<Eigen::Index>> rows(stations.size());
    std::vector<double> blocks(stations.size()), visits(stations.size());
    for (std::size_t k = 0; k < readings_.blocks.size(); ++k) {
      const ReadingBlock& one = readings_.blocks[k];
      ++blocks[one.station];
      visits[one.station] += one.visits;
      if (one.from != one.station) {
        ++blocks[one.from];
        visits[one.from] += one.visits;
      }
      for (Eigen::Index row = 0; row < one.by_joint.rows(); ++row) {
        rows[one.station].push_back(readings_.first[k] + row);
        if (one.from != one.station) rows[one.from].push_back(readings_.first[k] + row);
      }
    }
    for (std::size_t s = 0; s < rows.size(); ++s) {
      constexpr double kTwice = 2.0;  // a single reading that is wrong is an outlier
      if (visits[s] < kTwice || 3 * std::ssize(rows[s]) > readings_.y.size()) continue;  // or most refer to it
      const Eigen::MatrixXd spread = at_.P(rows[s], rows[s]);
      const Eigen::VectorXd off = cholesky_solution(spread, at_.z(rows[s]));
      const double size = off.norm() / std::sqrt(static_cast<double>(off.size()));
      SuspectedFact one{{.factor = std::clamp(size, 5.0, 1e6), .pose = s},
                        fmt::format("pose {}", stations[s].name),
                        kAnyPose / static_cast<double>(stations.size()),
                        off.norm() / std::sqrt(blocks[s])};
      weigh(at_.z(rows[s]).dot(off), static_cast<double>(off.size()), std::move(one));
    }
  }

  std::vector<SuspectedFact> sorted() && {
    std::ranges::stable_sort(all_, std::greater{}, &SuspectedFact::worth);
    return std::move(all_);
  }

 private:
  const std::vector<SoughtSource>& sought() const { return fit_.observation().sought(); }
  std::string_view name_of(std::size_t place) const { return name(sought()[place].source); }

  template <typename Chosen>
  std::vector<std::size_t> places(Chosen&& chosen) const {
    std::vector<std::size_t> list;
    for (std::size_t k = 0; k < sought().size(); ++k) {
      if (sought()[k].prior_std && chosen(sought()[k])) list.push_back(k);
    }
    return list;
  }

  void add_centre(std::size_t limb, const std::vector<Source>& coordinates, std::size_t limbs) {
    const std::vector<std::size_t> list = places([&](const SoughtSource& one) {
      return one.limb == limb && std::ranges::find(coordinates, one.source) != coordinates.end();
    });
    if (list.size() < 2) return;
    std::string names;
    for (const std::size_t k : list) names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(k));
    add(list, fmt::format("{} of limb {}", names, limb + 1), kAnyCentre / static_cast<double>(limbs));
  }

  /// As far as readings tell them: what these do not tell, its tolerance does.
  void add(const std::vector<std::size_t>& errors, std::string subject, double odds) {
    constexpr double kLeast = 3.0, kMost = 1e3;
    const std::vector<Eigen::Index> at(errors.begin(), errors.end());
    if (!std::ranges::all_of(errors, [&](std::size_t k) { return sought()[k].prior_std.has_value(); })) return;
    if (at.empty()) return;
    const Eigen::VectorXd std = readings_.prior(at, at).diagonal().cwiseSqrt();
    Eigen::MatrixXd information = std.asDiagonal() * information_(at, at) * std.asDiagonal();
    information.diagonal().array() += 1.0 / (kMost * kMost);
    const Eigen::VectorXd told = std.cwiseProduct(told_(at)), off = cholesky_solution(information, told);
    const double size = off.norm() / std::sqrt(static_cast<double>(off.size()));
    weigh(told.dot(off), static_cast<double>(at.size()),
          {{errors, std::clamp(size, kLeast, kMost), {}}, std::move(subject), odds});
  }

  void weigh(double drop, double count, SuspectedFact one) {
    constexpr double kPlausible = -3.0;  // a chance of a twentieth: less changes no average
    const double freedom = std::max(static_cast<double>(readings_.y.size() - readings_.by_set_up.cols()), 1.0);
    const double left = std::max(1.0 - drop / std::max(squares_, 1e-300), 1e-12);
    one.worth = -0.5 * freedom * std::log(left) - 0.5 * count + std::log(one.odds);
    if (one.worth > kPlausible) all_.push_back(std::move(one));
  }

  const StageFit& fit_;
  const LinearReadings& readings_;
  const VarianceTable::At& at_;
  Eigen::MatrixXd information_;  ///< X^T P X
  Eigen::VectorXd told_;         ///< X^T z
  double squares_ = 0.0;         ///< Q
  std::vector<SuspectedFact> all_;
};

}  // namespace

std::vector<SuspectedFact> suspected_facts(const StageFit& fit, const std::vector<Station>& stations,
                                           const VarianceTable& table, const VarianceTable::At& at) {
  Suspicion suspicion(fit, table, at);
  suspicion.add_errors();
  suspicion.add_kinds();
  suspicion.add_joint_centres();
  suspicion.add_poses(stations);
  return std::move(suspicion).sorted();
}

}  // namespace paracal::detail

#include "fact_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr double kFarthest = 5.0;  // mm: a reflector that is farther off was put there, and its place is to be stated

/// What a size may be: times the tolerances of errors, noises of a pose's readings, mm of a reflector's place.
struct Sizes {
  double least, most;
};
Sizes sizes_of(const Fact& fact) {
  if (fact.pose) return {5.0, 1e6};
  if (fact.mount) return {0.01, 1e3};
  return {3.0, 1e3};
}

/// Root mean square of sizes by what they do to the readings: a direction that nothing shows does not count.
double seen_size(const Eigen::MatrixXd& square, const Eigen::VectorXd& off) {
  return square.trace() > 0.0 ? std::sqrt(std::max(off.dot(square * off), 0.0) / square.trace()) : 0.0;
}

/// Sorted by worth.
void keep_plausible(std::vector<FactSet>& sets, std::size_t most) {
  constexpr double kPlausible = -3.0;  // odds of a twentieth: less changes no average
  std::ranges::stable_sort(sets, std::greater{}, &FactSet::worth);
  std::erase_if(sets, [](const FactSet& one) { return !(one.worth > kPlausible); });
  sets.resize(std::min(sets.size(), most));
}

bool shares_an_error(const Fact& one, const Fact& other) {
  return std::ranges::any_of(one.errors,
                             [&](std::size_t k) { return std::ranges::find(other.errors, k) != other.errors.end(); });
}

}  // namespace

FactSearch::FactSearch(const VarianceTable& table, const Eigen::VectorXd& u) : table_(table), mode_(u) {
  take(table.of_exact_machine(u));
}

void FactSearch::take(const Eigen::VectorXd& u) {
  u_ = u;
  at_ = table_.at(u, false);
  all_ = table_.scatter_of_visits(u);
  const LinearReadings& readings = table_.readings();
  all_.sum += readings.y.dot(at_.z);
  all_.redundancy += std::max(static_cast<double>(readings.y.size() - readings.by_set_up.cols()), 1.0);
}

bool FactSearch::is_strange() const {
  constexpr double kStandardDeviations = 3.0;  // of a chi-square
  constexpr double kLarge = 1.5;               // times what is expected of instruments
  if (!std::isfinite(at_.cost)) return false;
  if (table_.largest_unstated_noise(mode_) > kLarge) return true;
  return all_.sum > all_.redundancy + kStandardDeviations * std::sqrt(2.0 * all_.redundancy);
}

std::vector<Eigen::Index> FactSearch::rows_of(std::size_t pose) const {
  std::vector<Eigen::Index> rows;
  const LinearReadings& readings = table_.readings();
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& one = readings.blocks[k];
    if (one.station != pose && one.from != pose) continue;
    for (Eigen::Index row = 0; row < one.by_joint.rows(); ++row) rows.push_back(readings.first[k] + row);
  }
  return rows;
}

double FactSearch::blocks_of(std::size_t pose) const {
  return static_cast<double>(std::ranges::count_if(
      table_.readings().blocks, [&](const ReadingBlock& one) { return one.station == pose || one.from == pose; }));
}

/// W holds errors of parts in units of their tolerances, then a column for every reading, then places of reflectors.
std::vector<Eigen::Index> FactSearch::columns_of(const Fact& fact, Eigen::Index& next_place) const {
  if (fact.series) return {};
  if (fact.mount) return {next_place++, next_place++, next_place++};
  if (!fact.pose) return {fact.errors.begin(), fact.errors.end()};
  std::vector<Eigen::Index> rows = rows_of(*fact.pose);
  if (3 * std::ssize(rows) > table_.readings().y.size()) return {};  // most refer to it
  for (Eigen::Index& row : rows) row += table_.readings().prior.rows();
  return rows;
}

void FactSearch::lay_out() {
  columns_.clear();
  const LinearReadings& readings = table_.readings();
  const bool poses = std::ranges::any_of(facts_, [](const SuspectedFact& one) { return one.fact.pose.has_value(); });
  const Eigen::Index n = readings.prior.rows(), rows = readings.y.size();
  Eigen::Index all = n + (poses ? rows : 0);
  for (const SuspectedFact& one : facts_) columns_.push_back(columns_of(one.fact, all));
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(rows, all);
  W.leftCols(n) = readings.by_errors.leftCols(n) * readings.prior.diagonal().cwiseSqrt().asDiagonal();
  if (poses) W.middleCols(n, rows).setIdentity();
  for (std::size_t k = 0; k < facts_.size(); ++k) {
    if (facts_[k].fact.mount) W.middleCols<3>(columns_[k].front()) = facts_[k].fact.effect;
  }
  square_ = product(W.transpose(), product(at_.P, W));
  told_ = W.transpose() * at_.z;
}

/// Of the logarithm of the likelihood, whatever the scale of the noise.
double FactSearch::gain(double drop) const {
  const double left = std::max(1.0 - drop / std::max(all_.sum, 1e-300), 1e-12);
  return -0.5 * all_.redundancy * std::log(left);
}

/// As far as readings tell sizes: what these do not tell, the largest size does.
FactSet FactSearch::weighed(std::vector<std::size_t> facts) const {
  std::vector<Eigen::Index> columns;
  std::vector<double> least;
  FactSet all{std::move(facts)};
  for (const std::size_t k : all.facts) {
    const double ridge = std::pow(sizes_of(facts_[k].fact).most, -2);
    columns.insert(columns.end(), columns_[k].begin(), columns_[k].end());
    least.insert(least.end(), columns_[k].size(), ridge);
    all.worth += std::log(facts_[k].odds);
  }
  const Eigen::MatrixXd square = square_(columns, columns);
  const Eigen::VectorXd told = told_(columns);
  Eigen::MatrixXd information = square;
  information.diagonal() += Eigen::Map<const Eigen::VectorXd>(least.data(), std::ssize(least));
  const Eigen::VectorXd off = cholesky_solution(information, told);
  Eigen::VectorXd scale(off.size());
  Eigen::Index first = 0;
  for (const std::size_t k : all.facts) {
    const Eigen::Index count = std::ssize(columns_[k]);
    const Sizes sizes = sizes_of(facts_[k].fact);
    const Eigen::VectorXd own = off.segment(first, count);
    const Eigen::MatrixXd of_own = square.block(first, first, count, count);
    const double size = seen_size(of_own, own);
    all.sizes.push_back(std::clamp(size, sizes.least, sizes.most));
    const Fact& fact = facts_[k].fact;
    all.off.push_back(
        fact.pose    ? own.norm() / std::sqrt(blocks_of(*fact.pose))
        : fact.mount ? size * std::sqrt(of_own.trace() / std::max(symmetric_eigenvalues(of_own).maxCoeff(), 1e-300))
                     : size);
    scale.segment(first, count).setConstant(all.sizes.back());
    first += count;
  }
  Eigen::MatrixXd volume = scale.asDiagonal() * square * scale.asDiagonal();
  volume.diagonal().array() += 1.0;
  all.worth += gain(told.dot(off)) - Cholesky(volume).log_root() - 0.5 * static_cast<double>(off.size());
  for (std::size_t k = 0; k < all.facts.size(); ++k) {
    if (facts_[all.facts[k]].fact.mount && !(all.off[k] <= kFarthest)) all.worth = kNever;
  }
  if (!std::isfinite(all.worth)) all.worth = kNever;  // nothing shows what it does
  return all;
}

/// Its own table at the noise that its readings show.
FactSet FactSearch::weighed_series(std::size_t place) const {
  constexpr double kLarger = 1.5;  // a standard deviation that is less above what was stated needs no fact
  const std::size_t series = *facts_[place].fact.series;
  const LinearReadings& readings = table_.readings();
  Scatter own = table_.scatter_of_visits(u_, series);
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& block = readings.blocks[k];
    if (block.series != series) continue;
    const auto rows = Eigen::seqN(readings.first[k], block.by_joint.rows());
    own.sum += at_.z(rows).squaredNorm() / block.visits;
    own.redundancy += at_.P.diagonal()(rows).sum() / block.visits;
  }
  Fact fact = facts_[place].fact;
  fact.size = std::sqrt(own.sum / std::max(own.redundancy, 1e-300));
  FactSet all{{place}, {fact.size}, {0.0}, kNever};
  if (!(fact.size > kLarger)) return all;
  Eigen::VectorXd u(u_.size() + 1);
  u << u_, std::log(fact.size);
  all.worth = at_.cost - table_.with({&fact}).at(u, false).cost + std::log(facts_[place].odds);
  return all;
}

std::vector<FactSet> FactSearch::singles() const {
  std::vector<FactSet> all;
  for (std::size_t k = 0; k < facts_.size(); ++k) {
    if (facts_[k].fact.series) {
      all.push_back(weighed_series(k));
    } else if (!columns_[k].empty()) {
      all.push_back(weighed({k}));
    }
  }
  return all;
}

bool FactSearch::go_together(std::size_t one, std::size_t other) const {
  if (columns_[one].empty() || columns_[other].empty()) return false;
  const Fact &a = facts_[one].fact, &b = facts_[other].fact;
  return !(a.mount && b.mount) && !shares_an_error(a, b);
}

/// The best with one fact more.
std::vector<FactSet> FactSearch::larger(const std::vector<FactSet>& sets) const {
  std::vector<FactSet> all;
  for (const FactSet& set : sets) {
    for (std::size_t k = 0; k < facts_.size(); ++k) {
      if (!std::ranges::all_of(set.facts, [&](std::size_t one) { return one != k && go_together(one, k); })) continue;
      std::vector<std::size_t> facts = set.facts;
      facts.insert(std::ranges::lower_bound(facts, k), k);
      if (std::ranges::find(all, facts, &FactSet::facts) != all.end()) continue;
      all.push_back(weighed(std::move(facts)));
    }
  }
  return all;
}

/// The best of each number of facts, then others.
std::vector<FactSet> FactSearch::best_sets() const {
  constexpr std::size_t kWidth = 8, kLargest = 3;
  std::vector<FactSet> front = singles(), best, others;
  for (std::size_t size = 1; size <= kLargest; ++size) {
    keep_plausible(front, kWidth);
    if (front.empty() || (size > 1 && front.front().worth < best.back().worth)) break;
    best.push_back(front.front());
    others.insert(others.end(), front.begin() + 1, front.end());
    if (!is_strange()) break;
    front = larger(front);
  }
  keep_plausible(others, others.size());
  best.insert(best.end(), others.begin(), others.end());
  return best;
}

SuspectedFacts FactSearch::found() {
  constexpr std::size_t kMostTables = 6, kSingles = 3;
  if (!std::isfinite(at_.cost) || facts_.empty()) return {};
  lay_out();
  std::vector<FactSet> sets = best_sets();
  sets.resize(std::min(sets.size(), kMostTables));
  if (is_strange()) {  // of facts that are far off the model is not linear: joints take up what then is left
    take(mode_);
    lay_out();
    std::vector<FactSet> alone = singles();
    keep_plausible(alone, kSingles);
    for (FactSet& one : alone) {
      if (std::ranges::find(sets, one.facts, &FactSet::facts) == sets.end()) sets.push_back(std::move(one));
    }
  }
  return {std::move(facts_), std::move(sets)};
}

}  // namespace paracal::detail

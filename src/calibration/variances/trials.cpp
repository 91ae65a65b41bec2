#include "trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace paracal::detail {
namespace {

bool holds(const FactSet& set, std::size_t fact) { return std::ranges::find(set.facts, fact) != set.facts.end(); }

void normalise(std::vector<WeighedTable>& tables) {
  double sum = 0.0;
  for (const WeighedTable& one : tables) sum += one.probability;
  for (WeighedTable& one : tables) one.probability /= sum;
}

}  // namespace

/// Errors that are among those of a larger fact are off where that one is so.
bool Trials::follows(std::size_t fact, std::size_t from) const {
  if (fact == from) return true;
  const std::vector<std::size_t>&some = facts[fact].fact.errors, &all = facts[from].fact.errors;
  return !some.empty() && std::ranges::includes(all, some);
}

double Trials::probability(std::size_t fact) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const bool is_so = std::ranges::any_of(sets[k].facts, [&](std::size_t one) { return follows(fact, one); });
    if (is_so) sum += tables[k + 1].probability;
  }
  return sum;
}

std::vector<std::size_t> Trials::certain(double least) const {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < facts.size(); ++k) {
    if (likeliest_set_with(k) && probability(k) >= least) all.push_back(k);
  }
  const std::vector<std::size_t> every = all;
  std::erase_if(all, [&](std::size_t k) {
    return std::ranges::any_of(every, [&](std::size_t other) { return other != k && follows(k, other); });
  });
  return all;
}

std::optional<std::size_t> Trials::likeliest_set_with(std::size_t fact) const {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (!holds(sets[k], fact)) continue;
    if (!best || tables[k + 1].probability > tables[*best + 1].probability) best = k;
  }
  return best;
}

double Trials::log_odds() const {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < tables.size(); ++k) {
    best = std::max(best, std::log(tables[k].probability / tables.front().probability));
  }
  return best;
}

double Trials::off(std::size_t fact) const {
  const FactSet& set = sets[*likeliest_set_with(fact)];
  return set.off[static_cast<std::size_t>(std::ranges::find(set.facts, fact) - set.facts.begin())];
}

double Trials::size(std::size_t fact) const {
  const std::size_t place = *likeliest_set_with(fact);
  const FactSet& set = sets[place];
  if (!facts[fact].fact.series) {
    return set.sizes[static_cast<std::size_t>(std::ranges::find(set.facts, fact) - set.facts.begin())];
  }
  const WeighedTable& table = tables[place + 1];
  return std::exp(table.mode.u(static_cast<Eigen::Index>(table.table.terms_of(Spreads::series_noise).front())));
}

void Trials::omit_improbable() {
  constexpr double kImprobable = 0.01;
  for (std::size_t k = sets.size(); k-- > 0;) {
    if (tables[k + 1].probability > kImprobable) continue;
    sets.erase(sets.begin() + static_cast<std::ptrdiff_t>(k));
    tables.erase(tables.begin() + static_cast<std::ptrdiff_t>(k) + 1);
  }
  normalise(tables);
}

namespace {

/// A set on its way to a table of its own.
struct Candidate {
  FactSet set;
  VarianceTable table;
  double log_odds;
  double quick;  ///< logarithm of the odds without a search for the mode
};

VarianceTable table_of(const FactSet& set, const std::vector<SuspectedFact>& all, const VarianceTable& none) {
  std::vector<Fact> facts;
  std::vector<const Fact*> together;
  facts.reserve(set.facts.size());
  for (std::size_t k = 0; k < set.facts.size(); ++k) {
    facts.push_back(all[set.facts[k]].fact);
    facts.back().size = set.sizes[k];
    together.push_back(&facts.back());
  }
  return none.with(together);
}

/// Logarithm of the density where most of the scatter is noise, and with the joints of the machine in which no fact is.
double quick_log_density(const VarianceTable& table, const Eigen::VectorXd& u_of_none) {
  Eigen::VectorXd u = table.starts().front();
  const double noise = -table.at(u, false).cost;
  u.head(u_of_none.size()) = u_of_none;
  return std::max(noise, -table.at(u, false).cost);
}

}  // namespace

Trials trials_of(WeighedTable none, SuspectedFacts suspected) {
  constexpr double kFarLess = 30.0;  // of a logarithm: a search for its mode does not make up for it
  std::vector<Candidate> candidates;
  double most = none.mode.log_density;
  for (FactSet& set : suspected.sets) {
    double log_odds = 0.0;
    for (const std::size_t fact : set.facts) log_odds += std::log(suspected.facts[fact].odds);
    VarianceTable table = table_of(set, suspected.facts, none.table);
    const double quick = log_odds + quick_log_density(table, none.mode.u);
    most = std::max(most, quick);
    candidates.push_back({std::move(set), std::move(table), log_odds, quick});
  }
  Trials all{.facts = std::move(suspected.facts), .sets = {}, .tables = {}};
  std::vector<double> log_odds{none.mode.log_evidence};
  all.tables.push_back(std::move(none));
  for (Candidate& one : candidates) {
    if (!(one.quick > most - kFarLess)) continue;
    VarianceTable::Mode mode = one.table.mode();
    log_odds.push_back(one.log_odds + mode.log_evidence);
    all.sets.push_back(std::move(one.set));
    all.tables.push_back({std::move(one.table), std::move(mode)});
  }
  const double best = *std::ranges::max_element(log_odds);
  for (std::size_t k = 0; k < log_odds.size(); ++k) all.tables[k].probability = std::exp(log_odds[k] - best);
  normalise(all.tables);
  return all;
}

}  // namespace paracal::detail

#pragma once

// Private to calibration: tables of variances in which suspected facts are so, beside that in which none is.

#include <optional>
#include <vector>

#include "facts.hpp"
#include "variance_posterior.hpp"

namespace paracal::detail {

struct Trials {
  std::vector<SuspectedFact> facts;
  std::vector<FactSet> sets;
  std::vector<WeighedTable> tables;  ///< of no fact, then of each set, with their probabilities

  /// That a fact is so, whatever the others are.
  double probability(std::size_t fact) const;
  /// Facts that are at least as probable as this; of an error and a set of errors that holds it the set.
  std::vector<std::size_t> certain(double least) const;
  /// Logarithm of the odds of the best set against none.
  double log_odds() const;
  /// How far it is off in the most probable set that holds it.
  double off(std::size_t fact) const;
  /// Its size there; of the noise of a series as its own table finds it.
  double size(std::size_t fact) const;
  /// Removes sets that are so improbable that they change no average.
  void omit_improbable();

 private:
  bool follows(std::size_t fact, std::size_t from) const;
  std::optional<std::size_t> likeliest_set_with(std::size_t fact) const;
};

/// A table of its own for each set, with its evidence and the odds of its facts.
Trials trials_of(WeighedTable none, SuspectedFacts suspected);

}  // namespace paracal::detail

#pragma once

// Private to calibration: which facts, alone or together, would explain the readings of a machine that is its geometry.

#include <Eigen/Core>
#include <vector>

#include "facts.hpp"

namespace paracal::detail {

class FactSearch {
 public:
  /// @param table  must live as long.
  /// @param u  of its mode.
  FactSearch(const VarianceTable& table, const Eigen::VectorXd& u);

  /// Readings scatter more than noise and tolerances let them, or nothing tells.
  bool is_strange() const;
  void add(SuspectedFact one) { facts_.push_back(std::move(one)); }
  /// The facts that the readings speak for, and those that deserve a table.
  SuspectedFacts found();

 private:
  /// Looks at the readings with these variances.
  void take(const Eigen::VectorXd& u);
  void lay_out();
  std::vector<FactSet> best_sets() const;
  std::vector<Eigen::Index> columns_of(const Fact& fact, Eigen::Index& next_place) const;
  std::vector<Eigen::Index> rows_of(std::size_t pose) const;
  double blocks_of(std::size_t pose) const;
  FactSet weighed(std::vector<std::size_t> facts) const;
  FactSet weighed_series(std::size_t place) const;
  std::vector<FactSet> singles() const;
  double gain(double drop) const;
  bool go_together(std::size_t one, std::size_t other) const;
  std::vector<FactSet> larger(const std::vector<FactSet>& sets) const;

  const VarianceTable& table_;
  Eigen::VectorXd mode_, u_;  ///< u_: of the exact machine first
  VarianceTable::At at_;
  Scatter all_;  ///< Q and d, those of the visits among them
  std::vector<SuspectedFact> facts_;
  std::vector<std::vector<Eigen::Index>> columns_;  ///< of each fact among these:
  Eigen::MatrixXd square_;                          ///< W^T P W of all columns W
  Eigen::VectorXd told_;                            ///< W^T z
};

}  // namespace paracal::detail

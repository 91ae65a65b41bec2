#pragma once

// Private to calibration: Fedorov's exchange of poses.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "exchange_poses.hpp"
#include "exchange_state.hpp"
#include "numerics/dense.hpp"
#include "numerics/small.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/interruption.hpp"

namespace paracal::detail {

inline constexpr int kMostRows = 7;  // two points and a rotation

/// The rows of all candidates, three each, laid out once for products with six columns: four candidates (a bundle) in
/// panels of four rows, in each the entries of one unknown beside each other.
class PackedRows {
 public:
  static constexpr Eigen::Index kBundle = 4, kPanel = 4, kPanels = 3;  ///< candidates, rows, panels of a bundle
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;
  using Product = Eigen::Matrix<double, kPanel * kPanels, 6>;

  /// @param weighted  unknowns x (3 x candidates).
  explicit PackedRows(const Eigen::MatrixXd& weighted) : unknowns_(weighted.rows()) {
    const Eigen::Index bundles = (weighted.cols() + kPanel * kPanels - 1) / (kPanel * kPanels);
    panels_.setZero(kPanel, unknowns_ * kPanels * bundles);
    for (Eigen::Index column = 0; column < weighted.cols(); ++column) {
      auto panel = panels_.middleCols(column / kPanel * unknowns_, unknowns_);
      panel.row(column % kPanel) = weighted.col(column).transpose();
    }
  }

  /// Rows of a bundle times columns: twelve sums in registers while the unknowns pass once.
  Product times(Eigen::Index bundle, const Columns& columns) const {
    Product product;
    for (Eigen::Index panel = 0; panel < kPanels; ++panel) {
      const Eigen::Index first = (bundle * kPanels + panel) * unknowns_;
      Eigen::Matrix<double, kPanel, 6> sum = Eigen::Matrix<double, kPanel, 6>::Zero();
      for (Eigen::Index k = 0; k < unknowns_; ++k) sum.noalias() += panels_.col(first + k) * columns.row(k);
      product.template middleRows<kPanel>(kPanel * panel) = sum;
    }
    return product;
  }

 private:
  Eigen::Index unknowns_;
  Eigen::Matrix<double, kPanel, Eigen::Dynamic> panels_;
};

/// Exchange of poses where a candidate has Rows rows (Dynamic: as many as the problem says). The quadratic forms of
/// every candidate k, near_k = A_k C A_k^T and far_k = A_k C B C A_k^T, are kept with C.
template <int Rows>
class Exchange {
 public:
  static constexpr int kMost = Rows == Eigen::Dynamic ? kMostRows : Rows;
  using Small = Eigen::Matrix<double, Rows, Rows, Eigen::ColMajor, kMost, kMost>;

  /// @param threads  0: all; every number of them chooses the same poses.
  Exchange(const Problem& problem, Criterion criterion, unsigned threads)
      : problem_(&problem),
        state_(problem, criterion),
        arena_(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads)) {
    if constexpr (Rows == 3) packed_.emplace(problem.weighted);
    refresh();
  }

  const Eigen::MatrixXd& covariance() const { return state_.covariance(); }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }
  double value() const { return state_.value(); }

  void add(Eigen::Index k) {
    move(k, 1.0);
    chosen_.push_back(k);
  }

  /// The candidate that helps most now.
  Eigen::Index best_addition() {
    std::vector<Gain> best(index(blocks()));
    for_each_block([&](Eigen::Index first, Eigen::Index count) {
      Gain& most = best[index(first / kBlock)];
      for (Eigen::Index k = first; k < first + count; ++k) {
        const double gain = gain_of(near_[index(k)], far_[index(k)]);
        if (gain > most.gain && !is_chosen(k)) most = {gain, k};
      }
    });
    return std::ranges::max_element(best, {}, &Gain::gain)->candidate;  // the first, where some are alike
  }

  /// Replaces the chosen pose at `place` by the best candidate, if that is better by more than rounding.
  bool exchange(std::size_t place) {
    constexpr double kWorthwhile = 1e-6;
    near_before_ = near_;
    far_before_ = far_;
    const Eigen::MatrixXd covariance_before = covariance();
    const double old_value = value();
    const Eigen::Index left = chosen_[place];
    move(left, -1.0);
    chosen_[place] = -1;
    const Eigen::Index best = best_addition();
    const double own = gain_of(near_[index(left)], far_[index(left)]);
    if (best != left && gain_of(near_[index(best)], far_[index(best)]) > own) {
      move(best, 1.0);
      chosen_[place] = best;
      const double scale = state_.is_volume() ? 1.0 : std::abs(old_value);
      if (value() < old_value - kWorthwhile * scale) return true;
    }
    std::swap(near_, near_before_);
    std::swap(far_, far_before_);
    state_.set_covariance(covariance_before);
    chosen_[place] = left;
    return false;
  }

  /// Recomputes everything from the chosen poses: the rounding of many updates goes, and the worst direction moves the
  /// goal.
  void refresh() {
    state_.refresh(chosen_);
    const auto count = static_cast<std::size_t>(problem_->candidates());
    near_.resize(count);
    far_.resize(count);
    for_each_block([&](Eigen::Index first, Eigen::Index number) {
      const ExchangeState::Forms forms = state_.forms(first, number);
      for (Eigen::Index k = 0; k < number; ++k) {
        near_[index(first + k)] = forms.near.middleRows(rows() * k, rows());
        far_[index(first + k)] = forms.far.middleRows(rows() * k, rows());
      }
    });
  }

 private:
  struct Gain {
    double gain = -std::numeric_limits<double>::infinity();
    Eigen::Index candidate = -1;
  };

  /// Candidates that are computed together, in whole bundles.
  static constexpr Eigen::Index kBlock = 16 * PackedRows::kBundle;
  Eigen::Index blocks() const { return (problem_->candidates() + kBlock - 1) / kBlock; }

  /// Calls work(first candidate, count) of every block, on all threads.
  template <typename Work>
  void for_each_block(const Work& work) {
    const auto one = [&](Eigen::Index block) {
      let_interrupt();
      const Eigen::Index first = kBlock * block;
      work(first, std::min(kBlock, problem_->candidates() - first));
    };
    arena_.execute([&] { tbb::parallel_for(Eigen::Index{0}, blocks(), one); });
  }

  static std::size_t index(Eigen::Index k) { return static_cast<std::size_t>(k); }
  Eigen::Index rows() const { return problem_->rows; }
  Small identity() const { return Small::Identity(rows(), rows()); }
  bool is_chosen(Eigen::Index k) const { return std::ranges::find(chosen_, k) != chosen_.end(); }

  /// How much the criterion shrinks when a pose with these forms is added.
  double gain_of(const Small& near, const Small& far) const {
    const SmallCholesky<Small> one_more(identity() + near);
    return state_.is_volume() ? 2.0 * one_more.log_root() : one_more.trace_of_solution(far);
  }

  /// Takes pose s in (sign = 1) or out (-1): C -> C - sign U N U^T,  U = C A_s^T,  N = (I + sign A_s C A_s^T)^-1.
  void move(Eigen::Index s, double sign) {
    let_interrupt();
    const Small inner = sign * inverse(identity() + sign * near_[index(s)]);  // sign N
    const ExchangeState::Direction along = state_.direction(s);
    const Small between = along.between;
    const bool linear = !state_.is_volume();
    for_each_candidate(along, [&](Eigen::Index k, const Small& xk, const Small& yk) {
      // Eigen's blocked products of this size take longer to compile and to run.
      const Small step = xk.lazyProduct(inner);
      near_[index(k)] -= step.lazyProduct(xk.transpose());
      if (!linear) return;
      const Small mixed = step.lazyProduct(yk.transpose());
      const Small changed = step.lazyProduct(between);
      far_[index(k)] += changed.lazyProduct(step.transpose());
      far_[index(k)] -= mixed + mixed.transpose();
    });
    state_.move(along, inner);
  }

  /// Calls take(k, A_k u, A_k v) for every candidate k.
  template <typename Take>
  void for_each_candidate(const ExchangeState::Direction& along, const Take& take) {
    if constexpr (Rows == 3) {
      const PackedRows::Columns columns = along.both;
      for_each_block([&](Eigen::Index block, Eigen::Index count) {
        for (Eigen::Index first = block; first < block + count; first += PackedRows::kBundle) {
          const PackedRows::Product product = packed_->times(first / PackedRows::kBundle, columns);
          for (Eigen::Index i = 0; i < PackedRows::kBundle && first + i < problem_->candidates(); ++i) {
            take(first + i, product.template block<3, 3>(3 * i, 0), product.template block<3, 3>(3 * i, 3));
          }
        }
      });
    } else {
      for_each_block([&](Eigen::Index first, Eigen::Index count) {
        const Eigen::MatrixXd product = state_.products(first, count, along);
        for (Eigen::Index k = 0; k < count; ++k) {
          take(first + k, product.block(rows() * k, 0, rows(), rows()),
               product.block(rows() * k, rows(), rows(), rows()));
        }
      });
    }
  }

  const Problem* problem_;
  ExchangeState state_;
  tbb::task_arena arena_;
  std::optional<PackedRows> packed_ = {};  ///< of three rows a candidate
  std::vector<Small> near_, far_, near_before_, far_before_;
  std::vector<Eigen::Index> chosen_;
};

inline Eigen::MatrixXd source_covariance(const Problem& problem, const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = problem.scale.size();
  return problem.scale.asDiagonal() * covariance.bottomRightCorner(n, n) * problem.scale.asDiagonal();
}

template <int Rows>
Selection exchange_poses(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options,
                         const Problem& problem, const PoseSpread& spread) {
  Selection selection;
  const auto others = static_cast<std::uint64_t>(options.poses - 1);
  std::uint64_t done = 0;
  const auto tell = [&, told = options.progress](std::uint64_t sweeps) {
    ++done;
    if (told) told(done, others * (1 + sweeps));
  };
  Exchange<Rows> exchange(problem, options.criterion, options.threads);
  exchange.add(0);
  while (static_cast<int>(exchange.chosen().size()) < options.poses) {
    if (options.criterion == Criterion::worst_direction) exchange.refresh();
    exchange.add(exchange.best_addition());
    selection.curve.push_back(spread.uncertainty(source_covariance(problem, exchange.covariance())));
    tell(1);
  }
  for (bool better = true; better && selection.sweeps < options.largest_sweeps; ++selection.sweeps) {
    better = false;
    for (std::size_t place = 1; place < exchange.chosen().size(); ++place) {
      const bool helped = exchange.exchange(place);
      tell(static_cast<std::uint64_t>(selection.sweeps) + 1);
      if (!helped) continue;
      better = true;
      ++selection.exchanges;
    }
    exchange.refresh();
  }
  for (const Eigen::Index k : exchange.chosen()) selection.stations.push_back(candidates[static_cast<std::size_t>(k)]);
  selection.criterion = exchange.value();
  selection.uncertainty = spread.uncertainty(source_covariance(problem, exchange.covariance()));
  selection.travel = shorten_way(robot, selection.stations);
  return selection;
}

}  // namespace paracal::detail

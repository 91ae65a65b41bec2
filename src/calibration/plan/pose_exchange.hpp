#pragma once

// Private to calibration: Fedorov's exchange of poses.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "exchange_poses.hpp"
#include "numerics/dense.hpp"
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
  using Tall = Eigen::Matrix<double, Eigen::Dynamic, Rows, Eigen::ColMajor, Eigen::Dynamic, kMost>;

  /// @param threads  0: all; every number of them chooses the same poses.
  Exchange(const Problem& problem, Criterion criterion, unsigned threads)
      : problem_(&problem),
        criterion_(criterion),
        arena_(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads)) {
    if constexpr (Rows == 3) packed_.emplace(problem.weighted);
    covariance_ = Eigen::MatrixXd::Identity(problem.weighted.rows(), problem.weighted.rows());
    goal_ = problem.goal;
    refresh();
  }

  const Eigen::MatrixXd& covariance() const { return covariance_; }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

  double value() const {
    if (criterion_ == Criterion::volume) return std::log(determinant(covariance_));
    if (criterion_ == Criterion::worst_direction) return worst();
    return goal_.cwiseProduct(covariance_).sum();
  }

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
    const Eigen::MatrixXd covariance_before = covariance_;
    const double old_value = value();
    const Eigen::Index left = chosen_[place];
    move(left, -1.0);
    chosen_[place] = -1;
    const Eigen::Index best = best_addition();
    const double own = gain_of(near_[index(left)], far_[index(left)]);
    if (best != left && gain_of(near_[index(best)], far_[index(best)]) > own) {
      move(best, 1.0);
      chosen_[place] = best;
      const double scale = criterion_ == Criterion::volume ? 1.0 : std::abs(old_value);
      if (value() < old_value - kWorthwhile * scale) return true;
    }
    std::swap(near_, near_before_);
    std::swap(far_, far_before_);
    covariance_ = covariance_before;
    chosen_[place] = left;
    return false;
  }

  /// Recomputes everything from the chosen poses: the rounding of many updates goes, and the worst direction moves the
  /// goal.
  void refresh() {
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(covariance_.rows(), covariance_.rows());
    for (const Eigen::Index k : chosen_) information += of(k) * of(k).transpose();
    covariance_ = cholesky_solution(information, Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    if (criterion_ == Criterion::worst_direction) goal_ = towards_worst();
    const Eigen::MatrixXd far = covariance_ * goal_ * covariance_;
    const auto count = static_cast<std::size_t>(problem_->candidates());
    near_.resize(count);
    far_.resize(count);
    for_each_block([&](Eigen::Index first, Eigen::Index number) {
      for (Eigen::Index k = first; k < first + number; ++k) {
        const auto rows = of(k);
        near_[index(k)] = rows.transpose() * (covariance_ * rows);
        far_[index(k)] = rows.transpose() * (far * rows);
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
  auto of(Eigen::Index k) const { return problem_->weighted.template middleCols<Rows>(rows() * k, rows()); }
  bool is_chosen(Eigen::Index k) const { return std::ranges::find(chosen_, k) != chosen_.end(); }

  Eigen::MatrixXd visible_covariance() const { return problem_->visible.transpose() * covariance_ * problem_->visible; }

  double worst() const { return symmetric_eigenvalues(visible_covariance()).maxCoeff(); }

  /// Gradient of tr(C^4), which the largest eigenvalues dominate, scaled to 1: a linear stand-in for the largest.
  Eigen::MatrixXd towards_worst() const {
    const Eigen::MatrixXd c = visible_covariance() / worst();
    return problem_->visible * (c * c * c) * problem_->visible.transpose();
  }

  /// How much the criterion shrinks when a pose with these forms is added.
  double gain_of(const Small& near, const Small& far) const {
    const Eigen::LLT<Small> one_more(identity() + near);
    if (criterion_ == Criterion::volume) return 2.0 * one_more.matrixLLT().diagonal().array().log().sum();
    return one_more.solve(far).trace();
  }

  /// Takes pose s in (sign = 1) or out (-1): C -> C - sign U N U^T,  U = C A_s^T,  N = (I + sign A_s C A_s^T)^-1.
  void move(Eigen::Index s, double sign) {
    let_interrupt();
    const Small inner = sign * (identity() + sign * near_[index(s)]).inverse();  // sign N
    const Tall u = covariance_ * of(s);
    const bool linear = criterion_ != Criterion::volume;
    // far_k = A_k C B C A_k^T needs A_k C B U besides A_k U.
    Tall v = Tall::Zero(u.rows(), rows());
    Small between = Small::Zero(rows(), rows());
    if (linear) {
      v = covariance_ * (goal_ * u);
      between = u.transpose() * goal_ * u;
    }
    for_each_candidate(u, v, [&](Eigen::Index k, const Small& xk, const Small& yk) {
      const Small step = xk * inner;
      near_[index(k)].noalias() -= step * xk.transpose();
      if (!linear) return;
      const Small mixed = step * yk.transpose();
      const Small changed = step * between;
      far_[index(k)].noalias() += changed * step.transpose();
      far_[index(k)] -= mixed + mixed.transpose();
    });
    covariance_ -= u * inner * u.transpose();
    covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  }

  /// Calls take(k, A_k u, A_k v) for every candidate k.
  template <typename Take>
  void for_each_candidate(const Tall& u, const Tall& v, const Take& take) {
    if constexpr (Rows == 3) {
      PackedRows::Columns columns(u.rows(), 6);
      columns << u, v;
      for_each_block([&](Eigen::Index block, Eigen::Index count) {
        for (Eigen::Index first = block; first < block + count; first += PackedRows::kBundle) {
          const PackedRows::Product product = packed_->times(first / PackedRows::kBundle, columns);
          for (Eigen::Index i = 0; i < PackedRows::kBundle && first + i < problem_->candidates(); ++i) {
            take(first + i, product.template block<3, 3>(3 * i, 0), product.template block<3, 3>(3 * i, 3));
          }
        }
      });
    } else {
      Eigen::MatrixXd columns(u.rows(), 2 * rows());
      columns << u, v;
      for_each_block([&](Eigen::Index first, Eigen::Index count) {
        const Eigen::MatrixXd product =
            problem_->weighted.middleCols(rows() * first, rows() * count).transpose() * columns;
        for (Eigen::Index k = 0; k < count; ++k) {
          take(first + k, product.block(rows() * k, 0, rows(), rows()),
               product.block(rows() * k, rows(), rows(), rows()));
        }
      });
    }
  }

  const Problem* problem_;
  Criterion criterion_;
  tbb::task_arena arena_;
  std::optional<PackedRows> packed_ = {};  ///< of three rows a candidate
  Eigen::MatrixXd covariance_, goal_;
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

#include "paracal/calibration/pose_selection.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "observation.hpp"
#include "paracal/calibration/information_root.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "sought.hpp"

namespace paracal {
namespace {

/// Candidates as weighted rows over x = (frame and the like | source errors), each in units of its prior, so that the
/// covariance before measuring is I.
struct Problem {
  int rows = 0;                                ///< a candidate
  Eigen::MatrixXd weighted;                    ///< unknowns x (rows x candidates): A_k^T side by side
  Eigen::MatrixXd goal;                        ///< B of the criterion tr(B C)
  Eigen::VectorXd scale;                       ///< of the source errors in x: their prior std
  std::vector<Eigen::Index> known_setup = {};  ///< places in x of what is known of the set-up: the instrument's scale
  Eigen::MatrixXd visible;  ///< orthonormal directions of x, in the group of interest, that the candidates see
  Eigen::Index candidates() const { return weighted.cols() / rows; }
};

/// Directions of the errors that are to be found (position group; all where tilt is read) that all candidates together
/// see.
Eigen::MatrixXd visible_directions(const Problem& problem, const std::vector<SoughtSource>& sought, bool tilt) {
  constexpr double kRankTolerance = 1e-6;
  const Eigen::Index unknowns = problem.weighted.rows(), sources = problem.scale.size();
  std::vector<Eigen::Index> wanted;
  for (Eigen::Index k = 0; k < sources; ++k) {
    if (tilt || !tilts_plate(sought[static_cast<std::size_t>(k)].source)) wanted.push_back(unknowns - sources + k);
  }
  const Eigen::Index n = static_cast<Eigen::Index>(wanted.size()), setup = unknowns - sources;
  Eigen::MatrixXd rows(problem.weighted.cols(), setup + n + 1);
  rows << problem.weighted.topRows(setup).transpose(), problem.weighted(wanted, Eigen::all).transpose(),
      Eigen::VectorXd::Zero(rows.rows());
  InformationRoot root(setup + n);
  for (const Eigen::Index known : problem.known_setup) root.add_prior(known, 0.0, 0.0, 1.0);
  root.add(rows);
  const Spectrum spectrum = analyse(root.root().bottomRightCorner(n, n), kRankTolerance, Eigen::VectorXd::Ones(n));
  const Eigen::MatrixXd whole =
      Eigen::MatrixXd(Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(spectrum.null_space).householderQ());
  Eigen::MatrixXd visible = Eigen::MatrixXd::Zero(unknowns, spectrum.rank);
  visible(wanted, Eigen::all) = whole.rightCols(spectrum.rank);
  return visible;
}

Problem make_problem(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options) {
  // Frame, encoder zero and second reflector have no priors; these say little beside readings of hundredths of a mm,
  // and keep the updates of C well-conditioned.
  constexpr double kTurn = 0.005, kOther = 1.0;
  CalibrationOptions calibration;
  calibration.noise = options.noise;
  calibration.tolerances = options.tolerances;
  const Measurements plan = planned_points(robot, candidates, options.rotation, options.second);
  detail::Observation observation(robot, plan, calibration, detail::all_with_priors(robot, calibration), true);
  const auto unknowns = observation.start({});
  const auto stations = unknowns ? observation.stations(*unknowns) : nullptr;
  if (!stations) throw Unreachable("a candidate pose is out of the nominal machine's reach");

  const Eigen::Index n = observation.unknown_count();
  Problem problem;
  Eigen::VectorXd unit = Eigen::VectorXd::Constant(n, kOther);
  unit.head<3>().setConstant(kTurn);
  for (std::size_t k = 0; k < observation.sought().size(); ++k) {
    unit(observation.nuisance_count() + static_cast<Eigen::Index>(k)) = observation.sought()[k].prior_std.value_or(1.0);
  }
  problem.known_setup = observation.scale_columns();
  for (const Eigen::Index scale : problem.known_setup) unit(scale) = calibration.scale_std;
  problem.scale = unit.tail(observation.source_count());
  Eigen::MatrixXd block;
  for (std::size_t k = 0; k < observation.groups().size(); ++k) {
    observation.rows(observation.groups()[k], *stations, *unknowns, block);
    if (k == 0) {
      problem.rows = static_cast<int>(block.rows());
      problem.weighted.resize(n, problem.rows * static_cast<Eigen::Index>(candidates.size()));
    }
    auto columns = problem.weighted.middleCols(problem.rows * static_cast<Eigen::Index>(k), problem.rows);
    columns = unit.asDiagonal() * block.leftCols(n).transpose();
  }
  problem.visible = visible_directions(problem, observation.sought(), options.second);
  return problem;
}

constexpr int kMostRows = 7;  // two points and a rotation

/// Exchange of poses where a candidate has Rows rows (Dynamic: as many as the problem says). The quadratic forms of
/// every candidate k, near_k = A_k C A_k^T and far_k = A_k C B C A_k^T, are kept with C.
template <int Rows>
class Exchange {
 public:
  static constexpr int kMost = Rows == Eigen::Dynamic ? kMostRows : Rows;
  using Small = Eigen::Matrix<double, Rows, Rows, Eigen::ColMajor, kMost, kMost>;
  using Tall = Eigen::Matrix<double, Eigen::Dynamic, Rows, Eigen::ColMajor, Eigen::Dynamic, kMost>;

  Exchange(const Problem& problem, Criterion criterion) : problem_(&problem), criterion_(criterion) {
    covariance_ = Eigen::MatrixXd::Identity(problem.weighted.rows(), problem.weighted.rows());
    goal_ = problem.goal;
    refresh();
  }

  const Eigen::MatrixXd& covariance() const { return covariance_; }
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

  double value() const {
    if (criterion_ == Criterion::volume) return std::log(covariance_.determinant());
    if (criterion_ == Criterion::worst_direction) return worst();
    return goal_.cwiseProduct(covariance_).sum();
  }

  void add(Eigen::Index k) {
    move(k, 1.0);
    chosen_.push_back(k);
  }

  /// The candidate that helps most now.
  Eigen::Index best_addition() const {
    Eigen::Index best = -1;
    double most = -std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < problem_->candidates(); ++k) {
      const double gain = gain_of(near_[index(k)], far_[index(k)]);
      if (gain > most && !is_chosen(k)) {
        most = gain;
        best = k;
      }
    }
    return best;
  }

  /// Replaces the chosen pose at `place` by the best candidate, if that is better by more than rounding.
  bool exchange(std::size_t place) {
    constexpr double kWorthwhile = 1e-6;
    const Exchange before = *this;
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
    *this = before;
    return false;
  }

  /// Recomputes everything from the chosen poses: the rounding of many updates goes, and the worst direction moves the
  /// goal.
  void refresh() {
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(covariance_.rows(), covariance_.rows());
    for (const Eigen::Index k : chosen_) information += of(k) * of(k).transpose();
    covariance_ = information.llt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    if (criterion_ == Criterion::worst_direction) goal_ = towards_worst();
    const Eigen::MatrixXd far = covariance_ * goal_ * covariance_;
    const auto count = static_cast<std::size_t>(problem_->candidates());
    near_.resize(count);
    far_.resize(count);
    for (Eigen::Index k = 0; k < problem_->candidates(); ++k) {
      const auto rows = of(k);
      near_[index(k)] = rows.transpose() * (covariance_ * rows);
      far_[index(k)] = rows.transpose() * (far * rows);
    }
  }

 private:
  static std::size_t index(Eigen::Index k) { return static_cast<std::size_t>(k); }
  Eigen::Index rows() const { return problem_->rows; }
  Small identity() const { return Small::Identity(rows(), rows()); }
  auto of(Eigen::Index k) const { return problem_->weighted.template middleCols<Rows>(rows() * k, rows()); }
  bool is_chosen(Eigen::Index k) const { return std::ranges::find(chosen_, k) != chosen_.end(); }

  Eigen::MatrixXd visible_covariance() const { return problem_->visible.transpose() * covariance_ * problem_->visible; }

  double worst() const {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(visible_covariance(), Eigen::EigenvaluesOnly)
        .eigenvalues()
        .maxCoeff();
  }

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
    const Small inner = sign * (identity() + sign * near_[index(s)]).inverse();  // sign N
    const Tall u = covariance_ * of(s);
    const bool linear = criterion_ != Criterion::volume;
    // far_k = A_k C B C A_k^T needs A_k C B U besides A_k U.
    Tall v;
    Small between = Small::Zero(rows(), rows());
    if (linear) {
      v = covariance_ * (goal_ * u);
      between = u.transpose() * goal_ * u;
    }
    const Tall x = problem_->weighted.transpose() * u;
    Tall y;
    if (linear) y = problem_->weighted.transpose() * v;
    for (Eigen::Index k = 0; k < problem_->candidates(); ++k) {
      const Small xk = x.template middleRows<Rows>(rows() * k, rows());
      const Small step = xk * inner;
      near_[index(k)].noalias() -= step * xk.transpose();
      if (!linear) continue;
      const Small yk = y.template middleRows<Rows>(rows() * k, rows());
      const Small mixed = step * yk.transpose();
      const Small changed = step * between;
      far_[index(k)].noalias() += changed * step.transpose();
      far_[index(k)] -= mixed + mixed.transpose();
    }
    covariance_ -= u * inner * u.transpose();
    covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  }

  const Problem* problem_;
  Criterion criterion_;
  Eigen::MatrixXd covariance_, goal_;
  std::vector<Small> near_, far_;
  std::vector<Eigen::Index> chosen_;
};

Eigen::MatrixXd source_covariance(const Problem& problem, const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = problem.scale.size();
  return problem.scale.asDiagonal() * covariance.bottomRightCorner(n, n) * problem.scale.asDiagonal();
}

template <int Rows>
Selection run(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options,
              const Problem& problem, const PoseSpread& spread) {
  Selection selection;
  Exchange<Rows> exchange(problem, options.criterion);
  exchange.add(0);
  while (static_cast<int>(exchange.chosen().size()) < options.poses) {
    if (options.criterion == Criterion::worst_direction) exchange.refresh();
    exchange.add(exchange.best_addition());
    selection.curve.push_back(spread.uncertainty(source_covariance(problem, exchange.covariance())));
  }
  for (bool better = true; better && selection.sweeps < options.largest_sweeps; ++selection.sweeps) {
    better = false;
    for (std::size_t place = 1; place < exchange.chosen().size(); ++place) {
      if (!exchange.exchange(place)) continue;
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

/// B of the criterion; the worst direction sets its own as it goes.
Eigen::MatrixXd goal_of(const Robot& robot, const SelectionOptions& options, const Problem& problem,
                        const PoseSpread& spread) {
  if (options.criterion != Criterion::pose_uncertainty) return problem.visible * problem.visible.transpose();
  const double lever = robot.slide() ? robot.slide()->pinion_radius : 0.0;
  const Eigen::Index unknowns = problem.weighted.rows(), n = problem.scale.size();
  Eigen::MatrixXd goal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  goal.bottomRightCorner(n, n) = problem.scale.asDiagonal() * spread.mean_square(lever) * problem.scale.asDiagonal();
  return goal;
}

}  // namespace

Selection select_stations(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options) {
  if (options.poses < 2 || candidates.size() < static_cast<std::size_t>(options.poses)) {
    throw InvalidArgument(
        fmt::format("pose selection: expected 2 to {} poses, got {}", candidates.size(), options.poses));
  }
  Problem problem = make_problem(robot, candidates, options);
  CalibrationOptions calibration;
  calibration.tolerances = options.tolerances;
  const PoseSpread spread(robot, {}, detail::all_with_priors(robot, calibration), workspace_stations(robot));
  problem.goal = goal_of(robot, options, problem, spread);
  // Points alone are the usual case; a size of its own for every other would take minutes to compile.
  if (problem.rows == 3) return run<3>(robot, candidates, options, problem, spread);
  return run<Eigen::Dynamic>(robot, candidates, options, problem, spread);
}

}  // namespace paracal

#include "variance_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/dense.hpp"
#include "numerics/square_root.hpp"
#include "variance_priors.hpp"

namespace paracal::detail {
namespace {

constexpr double kNothing = 1e-9;  // mm or rad: far below what an instrument resolves

Eigen::Index rows_of(const ReadingBlock& block) { return block.by_joint.rows(); }

}  // namespace

VarianceTable::VarianceTable(const StageFit& fit, const LinearReadings& readings, const DriveSplines& drives,
                             const Discrepancies& expected)
    : readings_(&readings),
      expected_(expected),
      noise_mm_(reading_noise(fit.observation())),
      entered_(fit.observation().noise()) {
  add_noise();
  add_joints(Spreads::visits);
  add_joints(Spreads::poses);
  add_errors(fit, drives);
  list_visits();
}

std::vector<std::size_t> VarianceTable::terms_of(Spreads what) const {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    if (terms_[k].what == what) places.push_back(k);
  }
  return places;
}

double VarianceTable::squares(const Eigen::VectorXd& u, std::initializer_list<Spreads> kinds) const {
  double sum = 0.0;
  for (const Spreads what : kinds) {
    for (const std::size_t term : terms_of(what)) {
      sum += std::exp(2.0 * u(static_cast<Eigen::Index>(term))) * terms_[term].trace();
    }
  }
  return sum;
}

std::size_t VarianceTable::term_of(Spreads what, Eigen::Index joint) const {
  const auto found =
      std::ranges::find_if(terms_, [&](const VarianceTerm& one) { return one.what == what && one.joint == joint; });
  return static_cast<std::size_t>(found - terms_.begin());
}

std::vector<std::size_t> VarianceTable::noise_of(const ReadingBlock& block) const {
  const auto series = static_cast<Eigen::Index>(block.series);
  const std::size_t noise = block.stated ? term_of(Spreads::stated_noise) : term_of(Spreads::noise, series);
  std::vector<std::size_t> rows(static_cast<std::size_t>(rows_of(block)), noise);
  if (!block.stated && block.angles > 0) {
    std::fill_n(rows.begin() + block.first_angle, block.angles, term_of(Spreads::orientation_noise, series));
  }
  return rows;
}

void VarianceTable::add_noise() {
  const Eigen::Index count = readings_->y.size();
  const auto add = [&](Spreads what, Eigen::Index series) {
    if (term_of(what, series) < terms_.size()) return;
    terms_.push_back({what, series, Eigen::VectorXd::Zero(count)});
  };
  for (const ReadingBlock& one : readings_->blocks) {
    const auto series = static_cast<Eigen::Index>(one.series);
    add(one.stated ? Spreads::stated_noise : Spreads::noise, one.stated ? -1 : series);
    if (!one.stated && one.angles > 0) add(Spreads::orientation_noise, series);
  }
  for (std::size_t k = 0; k < readings_->blocks.size(); ++k) {
    const std::vector<std::size_t> noise = noise_of(readings_->blocks[k]);
    for (std::size_t row = 0; row < noise.size(); ++row) {
      const Eigen::Index at = readings_->first[k] + static_cast<Eigen::Index>(row);
      terms_[noise[row]].diagonal(at) = 1.0 / readings_->blocks[k].visits;
    }
  }
}

void VarianceTable::add_joints(Spreads what) {
  const std::vector<ByJoints> all = what == Spreads::visits ? by_visits(*readings_) : by_poses(*readings_);
  VarianceTerm alike{what};
  for (Eigen::Index joint = 0; joint < readings_->blocks.front().by_joint.cols(); ++joint) {
    VarianceTerm term{what, joint};
    for (const ByJoints& one : all) term.columns.add(one.rows, readings_->joint_per_mm * one.by_joint.col(joint));
    alike.columns.append(term.columns);
    terms_.push_back(std::move(term));
  }
  terms_.push_back(std::move(alike));
}

VarianceTerm VarianceTable::term_of_errors(Spreads what, std::vector<Eigen::Index> places,
                                           const Eigen::MatrixXd& covariance) const {
  VarianceTerm term{.what = what, .places = std::move(places), .covariance = covariance};
  const Eigen::MatrixXd rows = readings_->by_errors(Eigen::all, term.places);
  term.with_readings = product(rows, covariance);
  term.by_errors = product(term.with_readings, rows.transpose());
  return term;
}

void VarianceTable::add_errors(const StageFit& fit, const DriveSplines& drives) {
  const std::vector<SoughtSource>& sought = fit.observation().sought();
  std::vector<Eigen::Index> splines, positions, tilts;
  for (Eigen::Index k = 0; k < readings_->by_errors.cols(); ++k) {
    const bool of_part = k < std::ssize(sought);
    const bool tilting = of_part && tilts_plate(sought[static_cast<std::size_t>(k)].source);
    (!of_part ? splines : tilting ? tilts : positions).push_back(k);
  }
  const double unit = std::pow(readings_->joint_per_mm, 2);
  terms_.push_back(term_of_errors(Spreads::drives, splines, unit * drives.covariance));
  if (!positions.empty()) {
    terms_.push_back(term_of_errors(Spreads::positions, positions, readings_->prior(positions, positions)));
  }
  if (!tilts.empty()) terms_.push_back(term_of_errors(Spreads::tilts, tilts, readings_->prior(tilts, tilts)));
}

void VarianceTable::list_visits() {
  for (const ReadingBlock& one : readings_->blocks) {
    if (one.visits < 2.0) continue;
    Visits visits{one.scatter, one.visits - 1.0, {}, noise_of(one), one.series};
    for (Eigen::Index joint = 0; joint < one.by_joint.cols(); ++joint) {
      const std::size_t term = term_of(Spreads::visits, joint);
      for (const std::size_t of : {term, term_of(Spreads::visits)}) {
        visits.joints.emplace_back(of, readings_->joint_per_mm * one.by_joint.col(joint));
        if (one.by_from_joint.size() == 0) continue;
        visits.joints.emplace_back(of, readings_->joint_per_mm * one.by_from_joint.col(joint));
      }
    }
    visits_.push_back(std::move(visits));
  }
}

Eigen::MatrixXd VarianceTable::covariance_of(const ReadingBlock& block, const Eigen::VectorXd& u) const {
  Eigen::MatrixXd V = covariance_of_visits(block, u) / block.visits;
  add_joints_to(block, u, Spreads::poses, V);
  return V;
}

Eigen::MatrixXd VarianceTable::covariance_of_visits(const ReadingBlock& block, const Eigen::VectorXd& u) const {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(rows_of(block), rows_of(block));
  Eigen::Index row = 0;
  for (const std::size_t noise : noise_of(block)) {
    W(row, row) = std::exp(2.0 * u(static_cast<Eigen::Index>(noise)));
    ++row;
  }
  add_joints_to(block, u, Spreads::visits, W);
  return W;
}

void VarianceTable::add_joints_to(const ReadingBlock& block, const Eigen::VectorXd& u, Spreads what,
                                  Eigen::MatrixXd& V) const {
  const auto variance = [&](std::size_t term) { return std::exp(2.0 * u(static_cast<Eigen::Index>(term))); };
  const double unit = std::pow(readings_->joint_per_mm, 2), alike = variance(term_of(what));
  for (Eigen::Index joint = 0; joint < block.by_joint.cols(); ++joint) {
    const double each = unit * (variance(term_of(what, joint)) + alike);
    V += each * block.by_joint.col(joint) * block.by_joint.col(joint).transpose();
    if (block.by_from_joint.size() == 0) continue;
    V += each * block.by_from_joint.col(joint) * block.by_from_joint.col(joint).transpose();
  }
}

Eigen::MatrixXd VarianceTable::covariance_beside_errors(const Eigen::VectorXd& u) const {
  const Eigen::Index count = readings_->y.size();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, count);
  for (const VarianceTerm& one : fixed_) {
    if (one.places.empty()) one.add_to(all, 1.0);
  }
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    if (terms_[k].places.empty()) terms_[k].add_to(all, std::exp(2.0 * u(static_cast<Eigen::Index>(k))));
  }
  return all;
}

Eigen::VectorXd VarianceTable::noise_variances(const Eigen::VectorXd& u) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(readings_->y.size());
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    if (terms_[k].diagonal.size() > 0) all += std::exp(2.0 * u(static_cast<Eigen::Index>(k))) * terms_[k].diagonal;
  }
  return all;
}

std::vector<std::pair<const VarianceTerm*, double>> VarianceTable::error_terms(const Eigen::VectorXd& u) const {
  std::vector<std::pair<const VarianceTerm*, double>> all;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    if (!terms_[k].places.empty()) all.emplace_back(&terms_[k], std::exp(u(static_cast<Eigen::Index>(k))));
  }
  for (const VarianceTerm& one : fixed_) {
    if (!one.places.empty()) all.emplace_back(&one, 1.0);
  }
  return all;
}

Eigen::MatrixXd VarianceTable::root_of_errors(const Eigen::VectorXd& u) const {
  Eigen::MatrixXd all(readings_->by_errors.cols(), 0);
  for (const auto& [term, std] : error_terms(u)) {
    const Eigen::MatrixXd root = square_root(term->covariance);
    const Eigen::Index first = all.cols(), more = root.cols();
    all.conservativeResize(Eigen::NoChange, first + more);
    all.rightCols(more).setZero();
    all(term->places, Eigen::seqN(first, more)) = std * root;
  }
  return all;
}

Cholesky VarianceTable::root_of_covariance(const Eigen::VectorXd& variances) const {
  const Eigen::Index count = readings_->y.size();
  Eigen::MatrixXd V = Eigen::MatrixXd::Zero(count, count);
  for (const VarianceTerm& one : fixed_) one.add_to(V, 1.0);
  for (std::size_t k = 0; k < terms_.size(); ++k) terms_[k].add_to(V, variances(static_cast<Eigen::Index>(k)));
  return Cholesky(V);
}

bool VarianceTable::take_up_set_up(const Cholesky& root, At& at) const {
  const LinearReadings& all = *readings_;
  const Eigen::MatrixXd by = root.solve(all.by_set_up);  // not by P: of exact readings that loses what is left
  const Eigen::MatrixXd information =
      product(all.by_set_up.transpose(), by) + product(all.set_up_root.transpose(), all.set_up_root);
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Cholesky of_set_up(scale.asDiagonal() * information * scale.asDiagonal());
  if (!of_set_up.ok()) return false;
  const Eigen::VectorXd told = product(by.transpose(), all.y) - product(all.set_up_root.transpose(), all.set_up_reach);
  at.set_up = scale.asDiagonal() * of_set_up.solve(scale.asDiagonal() * told);
  at.cost += of_set_up.log_root() - scale.array().log().sum() +
             0.5 * (product(all.set_up_root, at.set_up) + all.set_up_reach).squaredNorm();
  const Eigen::VectorXd left = all.y - product(all.by_set_up, at.set_up);
  at.z = root.solve(left);
  at.cost += 0.5 * left.dot(at.z);
  const Eigen::MatrixXd half = of_set_up.forward(scale.asDiagonal() * by.transpose());
  add_square(at.P, half.transpose(), -1.0);
  complete_from_lower(at.P);
  return true;
}

void VarianceTable::add_slopes(const Eigen::VectorXd& variances, At& at) const {
  const Eigen::Index n = variances.size();
  at.gradient.resize(n);
  Eigen::MatrixXd moved(at.z.size(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const VarianceTerm& term = terms_[static_cast<std::size_t>(k)];
    moved.col(k) = term.times(at.z);
    at.gradient(k) = variances(k) * (term.trace_with(at.P) - at.z.dot(moved.col(k)));
  }
  at.curvature =
      2.0 * variances.asDiagonal() * product(moved.transpose(), product(at.P, moved)) * variances.asDiagonal();
}

VarianceTable::At VarianceTable::at(const Eigen::VectorXd& u, bool derivatives) const {
  constexpr double kImpossible = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd variances = (2.0 * u).array().exp();
  At at;
  const Cholesky root = root_of_covariance(variances);
  if (!root.ok()) return {.cost = kImpossible};
  at.cost = root.log_root();
  at.P = root.inverse();
  if (readings_->by_set_up.cols() > 0) {
    if (!take_up_set_up(root, at)) return {.cost = kImpossible};
  } else {
    at.z = root.solve(readings_->y);
    at.cost += 0.5 * readings_->y.dot(at.z);
  }
  if (derivatives) add_slopes(variances, at);
  add_visits(variances, derivatives, at);
  add_prior(u, at);
  return at;
}

void VarianceTable::add_visits(const Eigen::VectorXd& variances, bool derivatives, At& at) const {
  for (const Visits& one : visits_) {
    const Eigen::Index rows = one.squares.rows();
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(rows, rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
      W(row, row) = variances(static_cast<Eigen::Index>(one.noise[static_cast<std::size_t>(row)]));
    }
    for (const auto& [term, h] : one.joints) W += variances(static_cast<Eigen::Index>(term)) * h * h.transpose();
    const Cholesky root(W);
    const Eigen::MatrixXd inverse = root.solve(Eigen::MatrixXd::Identity(rows, rows));
    const Eigen::MatrixXd told = product(inverse, one.squares);
    at.cost += one.freedom * root.log_root() + 0.5 * told.trace();
    if (!derivatives) continue;
    // With R_k as columns: a joint's h, and each row of a noise by itself.
    const Eigen::Index joints = std::ssize(one.joints);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, joints + rows);
    std::vector<std::size_t> terms(one.noise);
    for (Eigen::Index k = 0; k < joints; ++k) columns.col(rows + k) = one.joints[static_cast<std::size_t>(k)].second;
    columns.leftCols(rows).setIdentity();
    for (const auto& [term, h] : one.joints) terms.push_back(term);
    const Eigen::MatrixXd moved = product(product(columns.transpose(), inverse), columns);
    const Eigen::MatrixXd slope = one.freedom * inverse - product(told, inverse);
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(terms[k]), column = static_cast<Eigen::Index>(k);
      at.gradient(i) += variances(i) * columns.col(column).dot(slope.lazyProduct(columns.col(column)));
      for (std::size_t l = 0; l < terms.size(); ++l) {
        const auto j = static_cast<Eigen::Index>(terms[l]);
        at.curvature(i, j) +=
            2.0 * one.freedom * variances(i) * variances(j) * std::pow(moved(column, static_cast<Eigen::Index>(l)), 2);
      }
    }
  }
}

void VarianceTable::add_prior(const Eigen::VectorXd& u, At& at) const {
  constexpr double kStatedNoise = 0.1;  // of its logarithm: instruments are as their makers say
  const auto slope_of = [&](const VarianceTerm& term, double value) -> Slope {
    switch (term.what) {
      case Spreads::noise:
      case Spreads::orientation_noise:
        return any_noise(value, std::log(least_noise(term.joint)));
      case Spreads::stated_noise:
        return as_stated(value, kStatedNoise);
      case Spreads::series_noise:
        return of_suspected_noise(value, std::log(series_size_));
      case Spreads::visits:
        return half_cauchy(value, expected_.visits);
      case Spreads::poses:
        return half_cauchy(value, expected_.poses);
      case Spreads::drives:
        return half_cauchy(value, expected_.drives);
      case Spreads::positions:
      case Spreads::tilts:
        break;
    }
    return as_stated(value, expected_.tolerances);
  };
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const Slope one = slope_of(terms_[k], u(i));
    at.cost += one.cost;
    if (at.gradient.size() == 0) continue;
    at.gradient(i) += one.slope;
    at.curvature(i, i) += one.curvature;
  }
}

double VarianceTable::largest_unstated_noise(const Eigen::VectorXd& u) const {
  double largest = 0.0;
  for (const std::size_t term : terms_of(Spreads::noise)) {
    largest = std::max(largest, entered_[static_cast<std::size_t>(terms_[term].joint)].unstated *
                                    std::exp(u(static_cast<Eigen::Index>(term))));
  }
  return largest;
}

Scatter VarianceTable::scatter_of_visits(const Eigen::VectorXd& u, std::optional<std::size_t> series) const {
  Scatter all;
  for (const Visits& one : visits_) {
    if (series.value_or(one.series) != one.series) continue;
    for (std::size_t row = 0; row < one.noise.size(); ++row) {
      const auto at = static_cast<Eigen::Index>(row);
      all.sum += one.squares(at, at) * std::exp(-2.0 * u(static_cast<Eigen::Index>(one.noise[row])));
      all.redundancy += one.freedom;
    }
  }
  return all;
}

std::optional<double> VarianceTable::noise_of_visits() const {
  constexpr double kFewest = 3.0;
  double sum = 0.0, freedom = 0.0;
  for (const Visits& one : visits_) {
    sum += one.squares.trace();
    freedom += one.freedom * static_cast<double>(one.squares.rows());
  }
  return freedom < kFewest ? std::nullopt : std::optional(std::sqrt(sum / freedom));
}

bool VarianceTable::tells_noise() const {
  return noise_of_visits().has_value() || terms_of(Spreads::noise).empty() ||
         !terms_of(Spreads::orientation_noise).empty();
}

std::vector<Eigen::VectorXd> VarianceTable::starts() const {
  constexpr double kSmall = 0.004, kSmallVisits = 0.002;  // mm
  constexpr double kLeast = 0.2;                          // of the scatter: noise, where joints explain the rest
  const double scatter = std::max(noise_of_visits().value_or(1.0), kLeastNoise / largest_unstated(entered_));
  std::vector<Eigen::VectorXd> all;
  for (const bool loose : {false, true}) {
    if (loose && !tells_noise()) break;
    Eigen::VectorXd u(std::ssize(terms_));
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto start = [&] {
        switch (terms_[k].what) {
          case Spreads::noise:
            return scatter * (loose ? kLeast : 1.0);
          case Spreads::visits:
            return loose ? scatter * noise_mm_ : kSmallVisits;
          case Spreads::poses:
            return loose && visits_.empty() && terms_[k].joint < 0 ? noise_mm_ : kSmall;
          case Spreads::drives:
            return kSmall;
          case Spreads::series_noise:
            return series_size_;
          default:
            return 1.0;
        }
      };
      u(static_cast<Eigen::Index>(k)) = std::log(std::max(start(), kNothing));
    }
    all.push_back(std::move(u));
  }
  return all;
}

Eigen::VectorXd VarianceTable::of_exact_machine(Eigen::VectorXd u) const {
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    double& one = u(static_cast<Eigen::Index>(k));
    switch (terms_[k].what) {
      case Spreads::visits:
      case Spreads::poses:
      case Spreads::drives:
        one = std::log(kNothing);
        break;
      case Spreads::stated_noise:
      case Spreads::positions:
      case Spreads::tilts:
        one = 0.0;
        break;
      default:
        break;
    }
  }
  return u;
}

VarianceTable::Mode VarianceTable::mode_without(const std::vector<Spreads>& ways, Eigen::VectorXd start) const {
  std::vector<std::size_t> held;
  for (const Spreads what : ways) {
    for (const std::size_t term : terms_of(what)) {
      held.push_back(term);
      start(static_cast<Eigen::Index>(term)) = std::log(kNothing);
    }
  }
  return mode_from(start, held);
}

VarianceTable::Mode VarianceTable::mode_from(const Eigen::VectorXd& start, const std::vector<std::size_t>& held) const {
  constexpr int kRounds = 40;
  constexpr double kSettled = 0.03, kFarthest = 1.5, kDamped = 1e6;  // of logarithms: samples about the mode follow
  Eigen::VectorXd u = start;
  const auto at_free = [&](const Eigen::VectorXd& where) {
    At found = at(where, true);
    for (const std::size_t term : held) {
      const auto k = static_cast<Eigen::Index>(term);
      if (found.gradient.size() == 0) break;
      found.gradient(k) = 0.0;
      found.curvature.row(k).setZero();
      found.curvature.col(k).setZero();
      found.curvature(k, k) = 1.0;
    }
    return found;
  };
  At now = at_free(u);
  double damping = 0.1;
  for (int round = 0; round < kRounds && damping < kDamped && std::isfinite(now.cost); ++round) {
    Eigen::MatrixXd curvature = now.curvature;
    curvature.diagonal().array() += damping;
    const Eigen::VectorXd step = -cholesky_solution(curvature, now.gradient).cwiseMax(-kFarthest).cwiseMin(kFarthest);
    const At next = at_free(u + step);
    if (!(next.cost < now.cost)) {
      damping *= 10.0;
      if (step.cwiseAbs().maxCoeff() < kSettled) break;
      continue;
    }
    u += step;
    now = next;
    damping = std::max(0.2 * damping, 1e-3);
    if (step.cwiseAbs().maxCoeff() < kSettled) break;
  }
  return {u, now.curvature, -now.cost, -now.cost};
}

VarianceTable::Mode VarianceTable::mode() const {
  constexpr double kFlat = 0.5;  // a variance that nothing tells has the width of its prior, and no more
  std::optional<Mode> best;
  for (const Eigen::VectorXd& start : starts()) {
    Mode one = mode_from(start);
    if (!best || one.log_evidence > best->log_evidence) best = std::move(one);
  }
  const Eigen::VectorXd widths = symmetric_eigenvalues(best->curvature).cwiseMax(kFlat);
  best->log_evidence -= 0.5 * widths.array().log().sum();
  return *best;
}

}  // namespace paracal::detail

#include "order_effects.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "numerics/dense.hpp"
#include "order_candidates.hpp"

namespace paracal::detail {
namespace {

constexpr double kLargest = 10.0;  // mm: what any such effect may do to readings

/// Rows of a block of the means by the unknowns of the fit.
Eigen::MatrixXd by_unknowns(const LinearReadings& readings, std::size_t block) {
  const Eigen::Index first = readings.first[block], rows = readings.blocks[block].by_joint.rows(),
                     set_up = readings.by_set_up.cols(), errors = readings.prior.rows();
  Eigen::MatrixXd J(rows, set_up + errors);
  J << readings.by_set_up.middleRows(first, rows), readings.by_errors.block(first, 0, rows, errors);
  return J;
}

Eigen::RowVectorXd mean_factors(const OrderEffect& effect, const ReadingBlock& block) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(effect.size_count());
  for (const ReadingBlock::Visit& one : block.each) sum += effect.factors(one.group);
  return sum / static_cast<double>(block.each.size());
}

/// An order as the rows of the means, and of the visits about them, have it: drift by degree, then the side of each
/// joint.
struct OrderInRows {
  const ReadingOrder* order;
  Eigen::MatrixXd means, visits;
};

class OrderSearch {
 public:
  OrderSearch(const StageFit& fit, const VarianceTable& table, const Eigen::VectorXd& u)
      : fit_(fit), readings_(table.readings()), at_(table.at(u, false)) {
    const Eigen::Index rows = readings_.y.size(), unknowns = fit.observation().unknown_count(),
                       joints = static_cast<Eigen::Index>(fit.observation().robot().limb_count());
    J_.resize(rows, unknowns);
    J_ << readings_.by_set_up, readings_.by_errors.leftCols(readings_.prior.rows());
    H_.resize(rows, joints);
    white_J_ = Eigen::MatrixXd::Zero(rows, unknowns);
    white_H_ = Eigen::MatrixXd::Zero(rows, joints);
    squares_ = readings_.y.dot(at_.z);
    freedom_ = std::max(static_cast<double>(rows - readings_.by_set_up.cols()), 1.0);
    for (std::size_t k = 0; k < readings_.blocks.size(); ++k) look_at(k, table, u);
  }

  /// Those that deserve a table, the best first.
  std::vector<FoundOrder> plausible() {
    constexpr double kPlausible = -6.0;  // of a logarithm: joints that take up half of what drifts hide no more
    constexpr std::size_t kMostTables = 4;
    std::vector<FoundOrder> all;
    if (!std::isfinite(at_.cost)) return all;
    std::vector<OrderEffect> effects = order_candidates(fit_, readings_);
    std::erase_if(effects, [&](OrderEffect& one) { return !normalise(one); });
    add_weighed(effects, all);
    std::erase_if(all, [](const FoundOrder& one) { return !(one.log_odds > kPlausible); });
    std::ranges::stable_sort(all, std::greater{}, &FoundOrder::log_odds);
    all.resize(std::min(all.size(), kMostTables));
    return all;
  }

  /// What it takes from the evidence that the sizes follow the visits: of means the table of the effect counts it.
  double cost_of_visits(const FoundOrder& found) {
    const Eigen::MatrixXd visits = visits_of(found.effect);
    const double size = found.size();
    Eigen::MatrixXd volume = size * size * product(visits.transpose(), visits);
    const double told = std::min(1.0, volume.trace() / static_cast<double>(volume.rows()));
    volume.diagonal().array() += 1.0;
    return Cholesky(volume).log_root() + 0.5 * told * static_cast<double>(volume.rows());
  }

  /// What it moves any reading by, mm.
  double largest_of(const FoundOrder& found) const {
    double largest = 0.0;
    for (std::size_t k = 0; k < readings_.blocks.size(); ++k) {
      const ReadingBlock& block = readings_.blocks[k];
      const Eigen::MatrixXd along = found.effect.along(by_unknowns(readings_, k), block.by_joint);
      const Eigen::Index lengths = block.angles > 0 ? block.first_angle : along.rows();
      for (const ReadingBlock::Visit& visit : block.each) {
        const Eigen::VectorXd moved = along * found.effect.factors(visit.group).transpose().cwiseProduct(found.sizes);
        largest = std::max(largest, moved.head(lengths).norm());
      }
    }
    return largest * reading_noise(fit_.observation());
  }

 private:
  void look_at(std::size_t place, const VarianceTable& table, const Eigen::VectorXd& u) {
    const ReadingBlock& block = readings_.blocks[place];
    const auto rows = Eigen::seqN(readings_.first[place], block.by_joint.rows());
    H_(rows, Eigen::all) = block.by_joint;
    if (block.each.size() < 2) return;
    const Cholesky root(table.covariance_of_visits(block, u));
    white_J_(rows, Eigen::all) = root.forward(J_(rows, Eigen::all));
    white_H_(rows, Eigen::all) = root.forward(block.by_joint);
    for (const ReadingBlock::Visit& visit : block.each) {
      const Eigen::VectorXd off = root.forward(-visit.off);
      for (Eigen::Index row = 0; row < off.size(); ++row) {
        row_of_visit_.push_back(readings_.first[place] + row);
        off_.push_back(off(row));
      }
      squares_ += off.squaredNorm();
    }
    freedom_ += static_cast<double>((std::ssize(block.each) - 1) * block.by_joint.rows());
  }

  const OrderInRows& in_rows(const ReadingOrder& order) {
    for (const OrderInRows& one : orders_) {
      if (one.order == &order) return one;
    }
    const Eigen::Index factors = order.drift.cols() + order.sides.cols();
    orders_.push_back(
        {&order, Eigen::MatrixXd(readings_.y.size(), factors), Eigen::MatrixXd(std::ssize(off_), factors)});
    OrderInRows& all = orders_.back();
    Eigen::Index next = 0;
    const auto at = [&](std::size_t group) {
      Eigen::RowVectorXd row(factors);
      row << order.drift.row(static_cast<Eigen::Index>(group)), order.sides.row(static_cast<Eigen::Index>(group));
      return row;
    };
    for (std::size_t k = 0; k < readings_.blocks.size(); ++k) {
      const ReadingBlock& block = readings_.blocks[k];
      const Eigen::Index rows = block.by_joint.rows();
      Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(factors);
      for (const ReadingBlock::Visit& one : block.each) mean += at(one.group) / static_cast<double>(block.each.size());
      all.means.middleRows(readings_.first[k], rows).rowwise() = mean;
      if (block.each.size() < 2) continue;
      for (const ReadingBlock::Visit& one : block.each) {
        all.visits.middleRows(next, rows).rowwise() = at(one.group) - mean;
        next += rows;
      }
    }
    return all;
  }

  static Eigen::VectorXd along(const OrderEffect::Direction& direction, const Eigen::MatrixXd& columns) {
    Eigen::VectorXd sum = direction.front().second * columns.col(direction.front().first);
    for (std::size_t k = 1; k < direction.size(); ++k) sum += direction[k].second * columns.col(direction[k].first);
    return sum;
  }

  /// To sizes of 1 mm. @returns whether any reading shows it.
  bool normalise(OrderEffect& effect) const {
    constexpr double kNothing = 1e-9;  // noises a unit of the unknown
    const double noise = reading_noise(fit_.observation()), rows = static_cast<double>(J_.rows());
    for (OrderEffect::Direction& one : effect.directions) {
      const double rms = along(one, effect.by == OrderedBy::sides ? H_ : J_).norm() / std::sqrt(rows);
      if (!(rms > kNothing)) return false;
      for (auto& [place, weight] : one) weight /= noise * rms;
    }
    return true;
  }

  /// Sets columns of the means to what the sizes of an effect do there.
  void add_means(const OrderEffect& effect, Eigen::Ref<Eigen::MatrixXd> columns) {
    const OrderInRows& order = in_rows(*effect.order);
    const Eigen::Index directions = std::ssize(effect.directions);
    for (Eigen::Index k = 0; k < directions; ++k) {
      const OrderEffect::Direction& one = effect.directions[static_cast<std::size_t>(k)];
      const Eigen::VectorXd mean = along(one, effect.by == OrderedBy::sides ? H_ : J_);
      for (int d = 0; d < effect.degree; ++d) {
        columns.col(d * directions + k) = mean.cwiseProduct(order.means.col(factor_of(effect, one, d)));
      }
    }
  }

  /// The same of the visits about their means, whitened.
  Eigen::MatrixXd visits_of(const OrderEffect& effect) {
    const OrderInRows& order = in_rows(*effect.order);
    const Eigen::Index directions = std::ssize(effect.directions);
    Eigen::MatrixXd all(std::ssize(off_), effect.size_count());
    for (Eigen::Index k = 0; k < directions; ++k) {
      const OrderEffect::Direction& one = effect.directions[static_cast<std::size_t>(k)];
      const Eigen::VectorXd white = along(one, effect.by == OrderedBy::sides ? white_H_ : white_J_);
      for (int d = 0; d < effect.degree; ++d) {
        all.col(d * directions + k) = white(row_of_visit_).cwiseProduct(order.visits.col(factor_of(effect, one, d)));
      }
    }
    return all;
  }

  /// Its place among those of OrderInRows.
  static Eigen::Index factor_of(const OrderEffect& effect, const OrderEffect::Direction& direction, int degree) {
    return effect.by == OrderedBy::sides ? ReadingOrder::kDegrees + direction.front().first : degree;
  }

  /// Of drifts along a curve, and along a line alone.
  void add_weighed(const std::vector<OrderEffect>& effects, std::vector<FoundOrder>& all) {
    Eigen::Index count = 0;
    for (const OrderEffect& one : effects) count += one.size_count();
    Eigen::MatrixXd means(J_.rows(), count);
    Eigen::Index next = 0;
    for (const OrderEffect& one : effects) {
      add_means(one, means.middleCols(next, one.size_count()));
      next += one.size_count();
    }
    const Eigen::MatrixXd weighed = product(at_.P, means);  // of all at once: small products cost more than they do
    next = 0;
    for (const OrderEffect& one : effects) {
      const auto own = Eigen::seqN(next, one.size_count());
      add_weighed(one, means(Eigen::all, own), weighed(Eigen::all, own), all);
      next += one.size_count();
    }
  }

  void add_weighed(const OrderEffect& effect, const Eigen::MatrixXd& means, const Eigen::MatrixXd& weighed,
                   std::vector<FoundOrder>& all) {
    const Eigen::MatrixXd visits = visits_of(effect);
    const Eigen::Map<const Eigen::VectorXd> off(off_.data(), std::ssize(off_));
    const Eigen::MatrixXd square = means.transpose().lazyProduct(weighed) + visits.transpose().lazyProduct(visits);
    const Eigen::VectorXd told = means.transpose().lazyProduct(at_.z) + visits.transpose().lazyProduct(off);
    add_with_sizes(effect, effect.degree, square, told, all);
    const Eigen::Index of_line = std::ssize(effect.directions);
    if (effect.degree > 1) add_with_sizes(effect, 1, square.topLeftCorner(of_line, of_line), told.head(of_line), all);
  }

  /// The likelihood rises by (d / 2) log(Q / (Q - T)) whatever the scale of the noise, as in FactSearch. What it rises
  /// by in a sound machine is not listed.
  void add_with_sizes(const OrderEffect& effect, int degree, const Eigen::MatrixXd& square, const Eigen::VectorXd& told,
                      std::vector<FoundOrder>& all) const {
    constexpr double kChance = 3.0;  // of a logarithm: one sound machine in ten has an effect that is worth so much
    Eigen::MatrixXd information = square;
    information.diagonal().array() += std::pow(kLargest, -2);
    Eigen::VectorXd sizes = cholesky_solution(information, told);
    const double left = std::max(1.0 - told.dot(sizes) / std::max(squares_, 1e-300), 1e-12);
    double gain = -0.5 * freedom_ * std::log(left);
    if (!(gain > kChance)) return;
    FoundOrder found{.effect = effect, .sizes = std::move(sizes)};
    found.effect.degree = degree;
    const double size = found.size();
    Eigen::MatrixXd volume = size * size * square;
    volume.diagonal().array() += 1.0;
    gain -= Cholesky(volume).log_root() + 0.5 * static_cast<double>(found.sizes.size());
    found.log_odds = std::log(effect.odds) + gain;
    if (gain > kChance && std::isfinite(found.log_odds)) all.push_back(std::move(found));
  }

  const StageFit& fit_;
  const LinearReadings& readings_;
  VarianceTable::At at_;
  Eigen::MatrixXd J_, H_, white_J_, white_H_;  ///< of the means; whitened by how the visits of each scatter
  std::vector<Eigen::Index> row_of_visit_;     ///< row of the mean for each row of a visit
  std::vector<double> off_;                    ///< of visits, measured from their mean, whitened
  double squares_ = 0.0, freedom_ = 0.0;       ///< Q and d, the visits among them
  std::vector<OrderInRows> orders_;
};

/// Scatter of the visits of each block where an effect has been taken off.
std::vector<Eigen::MatrixXd> scatter_without(const FoundOrder& found, const LinearReadings& readings) {
  std::vector<Eigen::MatrixXd> all;
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& block = readings.blocks[k];
    Eigen::MatrixXd& scatter = all.emplace_back(block.scatter);
    if (block.each.size() < 2) continue;
    const Eigen::MatrixXd along = found.effect.along(by_unknowns(readings, k), block.by_joint);
    const Eigen::RowVectorXd mean = mean_factors(found.effect, block);
    scatter.setZero();
    for (const ReadingBlock::Visit& visit : block.each) {
      const Eigen::RowVectorXd factors = found.effect.factors(visit.group) - mean;
      const Eigen::VectorXd off = visit.off + along * factors.transpose().cwiseProduct(found.sizes);
      scatter += off * off.transpose();
    }
  }
  return all;
}

/// Joints and drives do less than the noise of the mean readings, and this is as instruments have it.
bool is_all_noise(const VarianceTable& table, const Eigen::VectorXd& u) {
  constexpr double kHardly = 1.0;  // of the squares of the noise of mean readings
  constexpr double kLarge = 1.5;   // times what is expected of instruments
  const double noise = table.squares(u, {Spreads::noise, Spreads::stated_noise, Spreads::orientation_noise});
  const bool is_known = table.noise_of_visits().has_value() || !(table.largest_unstated_noise(u) > kLarge);
  return is_known && table.squares(u, {Spreads::visits, Spreads::poses, Spreads::drives}) < kHardly * noise;
}

/// The odds of an effect by a table in which it is so. Drift where no pose is visited again may be what goes with the
/// place: it has to explain all that noise does not.
void give_own_table(const StageFit& fit, const WeighedTable& none, FoundOrder& one) {
  const LinearReadings& readings = none.table.readings();
  VarianceTable own = none.table;
  own.add_effect(on_means(one.effect, readings), one.size());
  own.take_scatter(scatter_without(one, readings));
  const VarianceTable::Mode mode = own.mode();
  one.log_odds = std::log(one.effect.odds) + mode.log_evidence - none.mode.log_evidence;
  if (std::isfinite(one.log_odds)) one.log_odds -= OrderSearch(fit, own, mode.u).cost_of_visits(one);
  const bool may_be_of_place = one.effect.by != OrderedBy::sides && !one.effect.order->tells_drift;
  const bool is_told = !may_be_of_place || is_all_noise(own, mode.u);
  if (!is_told || !std::isfinite(one.log_odds)) one.log_odds = -std::numeric_limits<double>::infinity();
}

/// The machine rather than an instrument where both explain the readings: U then includes its drift.
std::optional<FoundOrder> chosen(std::vector<FoundOrder> all, const OrderSearch& search) {
  constexpr double kAlike = 3.0;  // of a logarithm: odds of a twentieth
  std::ranges::stable_sort(all, std::greater{}, &FoundOrder::log_odds);
  if (all.empty() || !std::isfinite(all.front().log_odds)) return std::nullopt;
  double sum = 0.0;
  for (const FoundOrder& one : all) sum += std::exp(one.log_odds - all.front().log_odds);
  const double most = all.front().log_odds;
  std::erase_if(all, [&](const FoundOrder& one) { return one.log_odds < most - kAlike; });
  const auto machine =
      std::ranges::find_if(all, [](const FoundOrder& one) { return one.effect.by != OrderedBy::set_up; });
  FoundOrder best = machine == all.end() ? all.front() : *machine;
  for (const FoundOrder& one : all) {
    const std::string& subject = one.effect.subject;
    if (subject == best.effect.subject || std::ranges::find(best.others, subject) != best.others.end()) continue;
    best.others.push_back(subject);
  }
  best.log_odds = most + std::log(sum);
  best.largest = search.largest_of(best);
  return best;
}

}  // namespace

Eigen::MatrixXd OrderEffect::along(const Eigen::MatrixXd& J, const Eigen::MatrixXd& H) const {
  const Eigen::MatrixXd& columns = by == OrderedBy::sides ? H : J;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(columns.rows(), std::ssize(directions));
  for (std::size_t k = 0; k < directions.size(); ++k) {
    for (const auto& [place, weight] : directions[k]) {
      all.col(static_cast<Eigen::Index>(k)) += weight * columns.col(place);
    }
  }
  return all.replicate(1, degree);
}

Eigen::RowVectorXd OrderEffect::factors(std::size_t group) const {
  const auto row = static_cast<Eigen::Index>(group), count = std::ssize(directions);
  Eigen::RowVectorXd all(size_count());
  for (Eigen::Index k = 0; k < size_count(); ++k) {
    const Eigen::Index joint = directions[static_cast<std::size_t>(k % count)].front().first;
    all(k) = by == OrderedBy::sides ? order->sides(row, joint) : order->drift(row, k / count);
  }
  return all;
}

double FoundOrder::size() const {
  constexpr double kSmallest = 1e-4;
  return std::clamp(sizes.norm() / std::sqrt(static_cast<double>(sizes.size())), kSmallest, kLargest);
}

Eigen::VectorXd FoundOrder::farthest(const Observation& observation) const {
  const Eigen::Index count = std::ssize(effect.directions);
  Eigen::VectorXd most = Eigen::VectorXd::Zero(count);
  for (std::size_t g = 0; g < observation.groups().size(); ++g) {
    if (!observation.groups()[g].active) continue;
    const Eigen::VectorXd now = effect.factors(g).transpose().cwiseProduct(sizes);
    const Eigen::VectorXd along = now.reshaped(count, effect.degree).rowwise().sum();
    if (along.norm() > most.norm()) most = along;
  }
  Eigen::VectorXd off = Eigen::VectorXd::Zero(observation.unknown_count());
  for (Eigen::Index k = 0; k < count; ++k) {
    for (const auto& [place, weight] : effect.directions[static_cast<std::size_t>(k)]) off(place) += weight * most(k);
  }
  return off;
}

Eigen::VectorXd FoundOrder::half_widths(Eigen::Index joints) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(joints);
  if (effect.by != OrderedBy::sides) return all;
  for (std::size_t k = 0; k < effect.directions.size(); ++k) {
    const auto& [joint, weight] = effect.directions[k].front();
    all(joint) = std::abs(weight * sizes(static_cast<Eigen::Index>(k)));
  }
  return all;
}

std::optional<FoundOrder> best_order(const StageFit& fit, const WeighedTable& none) {
  OrderSearch search(fit, none.table, none.mode.u);
  std::vector<FoundOrder> all = search.plausible();
  for (FoundOrder& one : all) give_own_table(fit, none, one);
  return chosen(std::move(all), search);
}

Eigen::MatrixXd on_means(const OrderEffect& effect, const LinearReadings& readings) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(readings.y.size(), effect.size_count());
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& block = readings.blocks[k];
    all.middleRows(readings.first[k], block.by_joint.rows()) =
        effect.along(by_unknowns(readings, k), block.by_joint) * mean_factors(effect, block).asDiagonal();
  }
  return all;
}

void take_off(const FoundOrder& found, StageFit& fit) {
  Observation& observation = fit.observation_to_change();
  const Eigen::VectorXd& unknowns = fit.fit().parameters;
  const auto states = observation.stations(unknowns);
  const auto joints = static_cast<Eigen::Index>(observation.robot().limb_count());
  Eigen::MatrixXd rows, by_joint;
  for (std::size_t g = 0; g < observation.groups().size(); ++g) {
    const Group& group = observation.groups()[g];
    observation.rows(group, *states, unknowns, rows, &by_joint);
    const Eigen::MatrixXd along = found.effect.along(rows.leftCols(unknowns.size()), by_joint.leftCols(joints));
    observation.take_off(g, along * (found.effect.factors(g).transpose().cwiseProduct(found.sizes)));
  }
}

}  // namespace paracal::detail

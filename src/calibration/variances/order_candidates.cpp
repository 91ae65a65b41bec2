#include "order_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace paracal::detail {
namespace {

/// Odds before any reading that a machine warms, that something else of it moves, that an instrument does, and that
/// joints have backlash. Machines do warm up, and most joints have some play.
constexpr double kAnyWarms = 0.1, kAnyMoves = 0.01, kAnySetUp = 0.03, kAnyBacklash = 0.1;

/// Lengths that heat changes, and zeros of drives: not places on the base.
bool may_warm(Source source) {
  return is_joint_zero(source) || source == Source("arm_length") || source == Source("gain") ||
         source == Source("rod_mean") || source == Source("rod_length");
}

class OrderCandidates {
 public:
  OrderCandidates(const StageFit& fit, const LinearReadings& readings)
      : observation_(fit.observation()), readings_(readings), orders_(reading_orders(fit.observation())) {}

  std::vector<OrderEffect> all() {
    add_errors();
    add_rods();
    add_kinds();
    for (std::size_t series = 0; series < observation_.series().size(); ++series) add_set_up(series);
    add_joints();
    std::vector<OrderEffect> list;
    add_in_every_order(warming_, ReadingOrder::kDegrees, kAnyWarms, list);
    add_in_every_order(moving_, ReadingOrder::kDegrees, kAnyMoves, list);
    add_in_every_order(set_ups_, ReadingOrder::kDegrees, kAnySetUp, list);
    add_in_every_order(sides_, 1, kAnyBacklash, list);
    return list;
  }

 private:
  using Weights = std::vector<std::pair<std::size_t, double>>;  ///< errors by their places

  const std::vector<SoughtSource>& sought() const { return observation_.sought(); }

  void add_in_every_order(const std::vector<OrderEffect>& effects, int degree, double odds,
                          std::vector<OrderEffect>& list) const {
    for (const auto& order : orders_) {
      for (OrderEffect one : effects) {
        one.order = order;
        one.degree = degree;
        one.odds = odds / static_cast<double>(effects.size());
        if (one.by != OrderedBy::sides || shows_sides(one)) list.push_back(std::move(one));
      }
    }
  }

  static bool shows_sides(const OrderEffect& effect) {
    return std::ranges::all_of(effect.directions, [&](const OrderEffect::Direction& one) {
      const auto sides = effect.order->sides.col(one.front().first);
      return sides.maxCoeff() > 0.0 && sides.minCoeff() < 0.0;
    });
  }

  void add_drift(std::string subject, const Weights& weights, bool warms) {
    OrderEffect effect{.subject = std::move(subject), .directions = {{}}};
    for (const auto& [place, weight] : weights) {
      effect.directions.front().emplace_back(observation_.nuisance_count() + static_cast<Eigen::Index>(place), weight);
    }
    (warms ? warming_ : moving_).push_back(std::move(effect));
  }

  void add_errors() {
    for (std::size_t k = 0; k < sought().size(); ++k) {
      if (tilts_plate(sought()[k].source)) continue;
      add_drift(fmt::format("{} of limb {}", name(sought()[k].source), sought()[k].limb + 1), {{k, 1.0}},
                may_warm(sought()[k].source));
    }
  }

  /// One rod of a pair is longer: the mean of both by half of that.
  void add_rods() {
    for (std::size_t mean = 0; mean < sought().size(); ++mean) {
      if (sought()[mean].source != Source("rod_mean")) continue;
      for (std::size_t k = 0; k < sought().size(); ++k) {
        if (sought()[k].limb != sought()[mean].limb || sought()[k].source != Source("rod_difference")) continue;
        for (const int rod : {1, 2}) {
          add_drift(fmt::format("rod {} of limb {}", rod, sought()[mean].limb + 1),
                    {{mean, 0.5}, {k, rod == 1 ? 1.0 : -1.0}}, true);
        }
      }
    }
  }

  void add_kinds() {
    std::vector<Source> kinds;
    for (const SoughtSource& one : sought()) {
      if (!tilts_plate(one.source) && std::ranges::find(kinds, one.source) == kinds.end()) kinds.push_back(one.source);
    }
    for (const Source kind : kinds) {
      Weights weights;
      for (std::size_t k = 0; k < sought().size(); ++k) {
        if (sought()[k].source == kind) weights.emplace_back(k, 1.0);
      }
      if (weights.size() > 1) add_drift(fmt::format("{} of all limbs", name(kind)), weights, may_warm(kind));
    }
  }

  /// Unknowns of the set-up that move readings of this series.
  std::vector<Eigen::Index> columns_of(std::size_t series) const {
    std::vector<Eigen::Index> columns;
    for (Eigen::Index column = 0; column < readings_.by_set_up.cols(); ++column) {
      for (std::size_t k = 0; k < readings_.blocks.size(); ++k) {
        const ReadingBlock& block = readings_.blocks[k];
        if (block.series != series) continue;
        if (readings_.by_set_up.col(column).segment(readings_.first[k], block.by_joint.rows()).isZero()) continue;
        columns.push_back(column);
        break;
      }
    }
    return columns;
  }

  void add_set_up(std::size_t series) {
    const std::vector<Eigen::Index> zeros = observation_.series()[series]->zero_columns(), all = columns_of(series);
    const std::string subject = fmt::format("the setup of {}", observation_.series()[series]->name());
    for (const std::vector<Eigen::Index>* columns : {&zeros, &all}) {
      if (columns->empty() || (columns == &all && all.size() == zeros.size())) continue;
      OrderEffect effect{.by = OrderedBy::set_up, .subject = subject};
      for (const Eigen::Index column : *columns) effect.directions.push_back({{column, 1.0}});
      set_ups_.push_back(std::move(effect));
    }
  }

  void add_sides(std::string subject, const std::vector<Eigen::Index>& joints) {
    OrderEffect effect{.by = OrderedBy::sides, .subject = std::move(subject)};
    for (const Eigen::Index joint : joints) effect.directions.push_back({{joint, 1.0}});
    sides_.push_back(std::move(effect));
  }

  void add_joints() {
    std::vector<Eigen::Index> every;
    for (std::size_t limb = 0; limb < observation_.robot().limb_count(); ++limb) {
      every.push_back(static_cast<Eigen::Index>(limb));
      add_sides(fmt::format("the joint of limb {}", limb + 1), {every.back()});
    }
    if (every.size() > 1) add_sides("each joint", every);
  }

  const Observation& observation_;
  const LinearReadings& readings_;
  std::vector<std::shared_ptr<const ReadingOrder>> orders_;
  std::vector<OrderEffect> warming_, moving_, set_ups_, sides_;
};

}  // namespace

std::vector<OrderEffect> order_candidates(const StageFit& fit, const LinearReadings& readings) {
  return OrderCandidates(fit, readings).all();
}

}  // namespace paracal::detail

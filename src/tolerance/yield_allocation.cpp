#include "yield_allocation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cutting_planes.hpp"
#include "failing_machines.hpp"

namespace paracal::detail {
namespace {

constexpr int kMostRounds = 25;
constexpr double kTrust = 0.22;           // of log T in a round: a quarter, as far as machines drawn at T tell
constexpr double kSettled = 0.02;         // of log T, and ...
constexpr double kCostSettled = 2e-3;     // ... of the cost: what drawing anew moves
constexpr double kShareError = 0.05;      // of the share that is stated
constexpr double kLimitViolation = 1e-6;  // of a limit that is not by yield

class YieldAllocator {
 public:
  YieldAllocator(const Robot& robot, const AllocationProblem& problem)
      : robot_(robot), problem_(problem), poses_(problem.poses) {
    for (const Requirement& one : problem.requirements) {
      if (one.criterion == Spread::yield) limits_.push_back(one);
    }
  }

  Allocation run() {
    std::vector<double> x = tightest();
    if (!holds_tightest(x)) return finished(x);
    x = start();
    for (allocation_.rounds = 1; allocation_.rounds <= kMostRounds; ++allocation_.rounds) {
      state_share(x);
      if (allocation_.failures->status == FailureStatus::unsettled) break;
      const std::vector<double> next = cheapest_near(x);
      const bool settled = distance(x, next) <= kSettled && std::abs(cost(next) / cost(x) - 1.0) <= kCostSettled;
      x = next;
      if (add_cuts(x) || !settled) continue;
      if (!brought_to_share(x)) break;
      if (add_cuts(x)) continue;
      allocation_.status = AllocationStatus::optimal;
      return finished(x);
    }
    allocation_.status = AllocationStatus::not_converged;
    allocation_.reason = allocation_.failures && !allocation_.failures->reason.empty()
                             ? allocation_.failures->reason
                             : std::string("the solver did not converge");
    return finished(x);
  }

 private:
  std::vector<double> tightest() const {
    std::vector<double> x;
    for (const DesignVariable& one : problem_.variables) x.push_back(std::log(one.lower));
    return x;
  }

  static double distance(const std::vector<double>& one, const std::vector<double>& other) {
    double largest = 0.0;
    for (std::size_t v = 0; v < one.size(); ++v) largest = std::max(largest, std::abs(one[v] - other[v]));
    return largest;
  }

  /// The limits that hold at 3 sigma everywhere are a start, where there is such an answer.
  std::vector<double> start() const {
    AllocationProblem easier = problem_;
    easier.max_failures.reset();
    for (Requirement& one : easier.requirements) {
      if (one.criterion == Spread::yield) one.criterion = Spread::statistical;
    }
    const Allocation found = allocate(robot_, easier);
    if (!found.ok()) return tightest();
    std::vector<double> x;
    for (const DesignVariable& one : problem_.variables) x.push_back(std::log(found.tolerances[one.sources.front()]));
    return x;
  }

  Tolerances tolerances(const std::vector<double>& x) const { return with(problem_, half_widths_of(x)); }

  /// The workspace's poses, and those that were worst at these half-widths and before.
  void add_worst_poses(const Tolerances& tolerances) {
    for (const Requirement& one : limits_) {
      poses_.push_back(worst_spread(robot_, one.characteristic, tolerances, Spread::statistical).pose);
    }
  }

  void state_share(const std::vector<double>& x) {
    const Tolerances now = tolerances(x);
    add_worst_poses(now);
    allocation_.failures = failure_share(robot_, now, limits_, poses_, {.relative_error = kShareError});
  }

  bool holds_tightest(const std::vector<double>& x) {
    state_share(x);
    const FailureShare& share = *allocation_.failures;
    if (share.status == FailureStatus::settled && share.best().value > *problem_.max_failures) {
      allocation_.status = AllocationStatus::infeasible;
      allocation_.reason = fmt::format("failure rate {:.3g} with the tightest tolerances, above {:.3g}",
                                       share.best().value, *problem_.max_failures);
      return false;
    }
    if (!add_cuts(x)) return true;
    allocation_.status = AllocationStatus::infeasible;
    allocation_.reason = "a worst-case or statistical limit is exceeded with the tightest tolerances";
    return false;
  }

  /// Adds the worst poses of limits that are not by yield; false when all hold.
  bool add_cuts(const std::vector<double>& x) {
    bool violated = false;
    for (std::size_t k = 0; k < problem_.requirements.size(); ++k) {
      const Requirement& one = problem_.requirements[k];
      if (one.criterion == Spread::yield) continue;
      const ValueAtPose worst = worst_spread(robot_, one.characteristic, tolerances(x), one.criterion);
      if (worst.value <= one.limit * (1.0 + kLimitViolation)) continue;
      cuts_.push_back(cut_at(robot_, problem_, k, worst.pose, half_widths_of(x)));
      violated = true;
    }
    return violated;
  }

  /// Drawing anew moves the share by a few percent: all half-widths together are brought to where the upper end of its
  /// interval is what was asked, or a little below. False when they do not get there.
  bool brought_to_share(std::vector<double>& x) {
    constexpr double kLittle = 0.08;
    constexpr int kMostSteps = 6;
    for (int step = 0; step < kMostSteps; ++step) {
      state_share(x);
      if (allocation_.failures->status != FailureStatus::settled) return false;
      const double room = std::log(*problem_.max_failures / allocation_.failures->best().interval.high);
      const bool is_widest = distance(x, moved(x, 1.0)) < kCostSettled;
      if (room >= 0.0 && (room <= kLittle || is_widest || !cuts_.empty())) return true;
      const FailingMachines failing(robot_, problem_, limits_, poses_, half_widths_of(x));
      if (failing.empty()) return false;
      std::vector<double> slope(x.size());
      failing.log_share(x, slope);
      const double along = std::accumulate(slope.begin(), slope.end(), 0.0);
      if (!(along > 0.0)) return false;
      x = moved(x, (room - 0.25 * kLittle) / along);
    }
    return false;
  }

  /// All half-widths by the same factor, but within their bounds.
  std::vector<double> moved(std::vector<double> x, double by) const {
    for (std::size_t v = 0; v < x.size(); ++v) {
      const DesignVariable& one = problem_.variables[v];
      x[v] = std::clamp(x[v] + by, std::log(one.lower), std::log(one.upper));
    }
    return x;
  }

  double cost(const std::vector<double>& x) const {
    return total_cost(problem_, half_widths_of(x), robot_.limb_count());
  }

  /// The cheapest half-widths of which machines drawn at x still tell.
  std::vector<double> cheapest_near(const std::vector<double>& x) {
    const FailingMachines failing(robot_, problem_, limits_, poses_, half_widths_of(x));
    Minimization search{.objective = cost_objective(problem_, unit_cost()), .lower = {}, .upper = {}};
    for (std::size_t v = 0; v < x.size(); ++v) {
      const DesignVariable& one = problem_.variables[v];
      search.lower.push_back(std::max(std::log(one.lower), x[v] - kTrust));
      search.upper.push_back(std::min(std::log(one.upper), x[v] + kTrust));
    }
    if (failing.empty()) return search.upper;  // far from any limit
    // The exact share's upper end over what these machines say of the same half-widths.
    std::vector<double> none;
    const double more = std::log(allocation_.failures->best().interval.high) - failing.log_share(x, none);
    const double room = std::log(*problem_.max_failures) - more;
    search.constraints.emplace_back([&failing, room](const std::vector<double>& at, std::vector<double>& gradient) {
      return failing.log_share(at, gradient) - room;
    });
    for (const Cut& cut : cuts_) search.constraints.push_back(cut_objective(cut));
    std::vector<double> best = minimize(search, x).x;
    allocation_.failure_price = price(failing, best, room);
    return best;
  }

  double unit_cost() const { return std::max(std::abs(total_cost(problem_, half_widths_of(tightest()), 1)), 1e-300); }

  /// Cost saved by twice the share: -d cost / d x over d log P / d x, of variables that are not at a bound, times
  /// log 2.
  double price(const FailingMachines& failing, const std::vector<double>& x, double room) const {
    std::vector<double> slope(x.size());
    if (failing.log_share(x, slope) < room - kSettled) return 0.0;
    double cost = 0.0, share = 0.0;
    for (std::size_t v = 0; v < x.size(); ++v) {
      const DesignVariable& one = problem_.variables[v];
      const double width = std::exp(x[v]);
      if (width >= one.upper * (1.0 - kSettled) || width <= one.lower * (1.0 + kSettled)) continue;
      cost -= one.cost.slope(width) * width * slope[v];
      share += slope[v] * slope[v];
    }
    return share > 0.0 ? std::numbers::ln2 * cost / share * static_cast<double>(robot_.limb_count()) : 0.0;
  }

  Allocation finished(const std::vector<double>& x) {
    allocation_.tolerances = tolerances(x);
    allocation_.cost = cost(x);
    for (const Requirement& one : problem_.requirements) {
      allocation_.requirements.push_back(
          {one, worst_spread(robot_, one.characteristic, allocation_.tolerances, one.criterion), 0.0});
    }
    return allocation_;
  }

  const Robot& robot_;
  const AllocationProblem& problem_;
  std::vector<Requirement> limits_;  ///< by yield
  std::vector<Pose> poses_;
  std::vector<Cut> cuts_;
  Allocation allocation_;
};

}  // namespace

Allocation allocate_by_yield(const Robot& robot, const AllocationProblem& problem) {
  return YieldAllocator(robot, problem).run();
}

}  // namespace paracal::detail

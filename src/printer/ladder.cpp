#include "paracal/printer/ladder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "known_delta.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {
namespace {

using detail::KnownDelta, detail::ReadingNoise;

constexpr double kLeastOwn = 0.15;  // part of a reading's error in its residual: with less, the reading stands alone

/// The value below which a part of all values are.
double quantile(const Eigen::VectorXd& values, double part) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, at);
  return *at;
}

LadderFigure figure(const Eigen::VectorXd& values) {
  constexpr double kTail = 0.025;
  return {values.mean(), quantile(values, kTail), quantile(values, 1.0 - kTail)};
}

/// Readings that count, with their numbers among all.
struct Good {
  DeltaReadings readings;
  ReadingNumbers numbers;

  explicit Good(const DeltaReadings& all) : readings(all) {
    for (std::size_t k = 0; k < all.heights.size(); ++k) numbers.heights.push_back(k);
    for (std::size_t k = 0; k < all.distances.size(); ++k) numbers.distances.push_back(k);
  }
  Eigen::Index heights() const { return std::ssize(readings.heights); }
};

/// Of one kind: residuals in mm and their own parts.
struct OneKind {
  Eigen::VectorXd residuals, own_parts;

  /// Standard deviation, without gross ones: each residual is smaller than the error by the root of its own part.
  double noise(double least, const std::vector<std::size_t>& gross) const {
    double sum = 0.0;
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < residuals.size(); ++k) {
      if (std::ranges::find(gross, static_cast<std::size_t>(k)) != gross.end()) continue;
      sum += residuals(k) * residuals(k) / std::max(own_parts(k), kLeastOwn);
      ++count;
    }
    return std::max(least, count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0);
  }

  /// Those whose error, if left out, is larger than a limit and than any noise.
  std::vector<std::size_t> gross(double least, double noises) const {
    constexpr double kOfMedian = 1.4826;  // a standard deviation, in a normal distribution
    std::vector<std::size_t> numbers;
    if (residuals.size() == 0) return numbers;
    const Eigen::VectorXd errors = residuals.cwiseAbs().cwiseQuotient(own_parts.cwiseMax(kLeastOwn));
    const double limit = std::max(least, noises * kOfMedian * quantile(errors, 0.5));
    for (Eigen::Index k = 0; k < errors.size(); ++k) {
      if (errors(k) > limit && own_parts(k) >= kLeastOwn) numbers.push_back(static_cast<std::size_t>(k));
    }
    constexpr std::size_t kFew = 4;  // one in so many: where more are wrong, nobody can tell which
    if (kFew * numbers.size() > static_cast<std::size_t>(errors.size())) numbers.clear();
    return numbers;
  }
};

void leave_out(std::vector<std::size_t>& numbers, const std::vector<std::size_t>& gross,
               std::vector<std::size_t>& excluded) {
  for (std::size_t k = gross.size(); k-- > 0;) {
    const std::size_t one = gross[k];
    excluded.push_back(numbers[one]);
    numbers.erase(numbers.begin() + static_cast<std::ptrdiff_t>(one));
  }
  std::ranges::sort(excluded);
}

/// Fits and judges the rungs of one printer.
class Climb {
 public:
  Climb(const DeltaGeometry& saved, const DeltaReadings& readings, const LadderOptions& options)
      : saved_(saved),
        options_(options),
        good_(readings),
        has_distances_(!readings.distances.empty()),
        noise_{options.priors.height, options.priors.distance} {}

  std::optional<Ladder> run() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const auto fit = fit_of(top(), saved_);
      if (!fit) return std::nullopt;
      if (!excludes_gross(KnownDelta(*fit, saved_, good_.readings, noise_, options_))) break;
    }
    noise_ = shown_;
    const auto fit = fit_of(top(), saved_);
    if (!fit) return std::nullopt;
    known_.emplace(*fit, saved_, good_.readings, noise_, options_);
    constexpr Eigen::Index kMachines = 1000;  // a probability of 95 % is then known within 1.4 % (95 %)
    machines_ = known_->possible(kMachines);
    before_ = known_->behaviour(saved_, machines_);
    if (!before_) return std::nullopt;
    found_.noise_height = noise_.height;
    found_.noise_distance = noise_.distance;
    check_readings();
    climb();
    return std::move(found_);
  }

 private:
  Rung top() const { return has_distances_ ? Rung::rods : Rung::towers; }

  std::optional<DeltaGeometry> fit_of(Rung rung, const DeltaGeometry& start, bool fits_radius = true) const {
    return detail::fit_numbers(start, saved_, good_.readings, detail::rung_basis(saved_.actuator, rung, fits_radius),
                               noise_, options_.priors);
  }

  OneKind kind(const KnownDelta& known, bool heights) const {
    const Eigen::Index h = good_.heights(), d = known.residuals().size() - h;
    const auto of = [&](const Eigen::VectorXd& all) -> Eigen::VectorXd { return heights ? all.head(h) : all.tail(d); };
    return {of(known.residuals()) * (heights ? noise_.height : noise_.distance), of(known.own_parts())};
  }

  /// Excludes gross readings, and takes the noise from the others. The noise is not taken again from a fit that relies
  /// on it: of few readings, priors and noise would explain each other.
  /// @returns whether there were any.
  bool excludes_gross(const KnownDelta& known) {
    const LadderRules& rules = options_.rules;
    const OneKind heights = kind(known, true), distances = kind(known, false);
    const ReadingNumbers gross{heights.gross(rules.gross_height, rules.gross),
                               distances.gross(rules.gross_distance, rules.gross)};
    good_.readings = without(good_.readings, gross);
    leave_out(good_.numbers.heights, gross.heights, found_.gross.heights);
    leave_out(good_.numbers.distances, gross.distances, found_.gross.distances);
    const bool has_gross = !gross.heights.empty() || !gross.distances.empty();
    shown_ = {heights.noise(rules.least_height, gross.heights), distances.noise(rules.least_distance, gross.distances)};
    return has_gross;
  }

  /// A reading is checked by the others if they would show a gross error of it.
  void check_readings() {
    for (const bool heights : {true, false}) {
      const OneKind of = kind(*known_, heights);
      const std::vector<std::size_t>& numbers = heights ? good_.numbers.heights : good_.numbers.distances;
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (of.own_parts(static_cast<Eigen::Index>(k)) >= kLeastOwn) continue;
        (heights ? found_.unchecked.heights : found_.unchecked.distances).push_back(numbers[k]);
      }
    }
  }

  RungValues judged(Rung rung, const DeltaGeometry& values) const {
    RungValues one{.rung = rung, .geometry = values, .first_layer = {}, .size = {}, .depth = INFINITY};
    const auto with = known_->behaviour(values, machines_);
    if (!with) return one;
    const auto share = [](const auto& where) {
      return static_cast<double>(where.count()) / static_cast<double>(where.size());
    };
    one.first_layer = figure(with->layer);
    one.size = figure(with->size);
    one.chance = share(with->layer.array() < before_->layer.array());
    one.chance_size = share(with->size.array().abs() > before_->size.array().abs() + options_.rules.size);
    one.heights.assign(with->heights.begin(), with->heights.end());
    one.depth = quantile(with->depth, options_.rules.safe);
    return one;
  }

  /// Values that lift a nozzle out of the bed by most of its depth may be advised.
  double deepest() const { return std::max(options_.rules.deepest, options_.rules.of_saved * found_.saved().depth); }

  bool keeps_size(const RungValues& one) const { return one.chance_size <= 1.0 - options_.rules.certain; }

  /// Heights that endstops alone leave unprintable, and that this rung levels: no bowed bed looks like that.
  bool must_move_radius(const RungValues& one) const {
    if (has_distances_ || found_.rungs.size() < 2) return false;
    const double below = found_.rungs[1].first_layer.value;
    return below >= options_.rules.level && one.first_layer.value <= 0.5 * below;
  }

  /// With the radius as far as the size of prints is not worse.
  RungValues with_held_radius(Rung rung, double radius) const {
    constexpr int kHalvings = 8;
    double least = 0.0, most = 1.0;
    DeltaGeometry moved = saved_;
    const auto moved_by = [&](double part) {
      moved.radius = saved_.radius + part * (radius - saved_.radius);
      return moved;
    };
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (least + most);
      const RungValues one = judged(rung, moved_by(middle));
      const bool is_small = std::abs(one.size.value - found_.saved().size.value) <= options_.rules.size;
      (is_small || keeps_size(one) ? least : most) = middle;
    }
    RungValues held = judged(rung, fit_of(rung, moved_by(least), false).value_or(saved_));
    held.holds_radius = true;
    return held;
  }

  void climb() {
    found_.rungs.push_back(judged(Rung::saved, saved_));
    for (const Rung rung : {Rung::height, Rung::radius, Rung::towers, Rung::rods}) {
      if (rung > top()) break;
      RungValues one = judged(rung, fit_of(rung, saved_).value_or(saved_));
      const bool may_hold = rung == Rung::radius || rung == Rung::towers;
      const bool is_forced = may_hold && must_move_radius(one);
      if (may_hold && !keeps_size(one) && !is_forced) one = with_held_radius(rung, one.geometry.radius);
      one.is_allowed = one.chance >= options_.rules.certain && one.depth <= deepest() &&
                       one.first_layer.value <= found_.best().first_layer.value &&
                       (keeps_size(one) || is_forced || one.holds_radius);
      found_.rungs.push_back(one);
      if (one.is_allowed) found_.advised = found_.rungs.size() - 1;
    }
  }

  const DeltaGeometry& saved_;
  const LadderOptions& options_;
  Good good_;
  bool has_distances_;
  ReadingNoise noise_, shown_{};  ///< in use, and as the readings show it
  std::optional<KnownDelta> known_;
  Eigen::MatrixXd machines_;
  std::optional<KnownDelta::Behaviour> before_;
  Ladder found_;
};

}  // namespace

std::string_view name(Rung rung) {
  constexpr std::array<std::string_view, 5> kNames{"saved", "height", "radius", "towers", "rods"};
  return kNames.at(static_cast<std::size_t>(rung));
}

DeltaReadings without(const DeltaReadings& readings, const ReadingNumbers& numbers) {
  DeltaReadings rest;
  const auto copy = [](const auto& from, const std::vector<std::size_t>& left_out, auto& to) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      if (std::ranges::find(left_out, k) == left_out.end()) to.push_back(from[k]);
    }
  };
  copy(readings.heights, numbers.heights, rest.heights);
  copy(readings.distances, numbers.distances, rest.distances);
  return rest;
}

std::vector<Eigen::Vector3d> printable_disk(double radius) {
  constexpr int kRings = 5, kAround = 12;
  std::vector<Eigen::Vector3d> places{Eigen::Vector3d::Zero()};
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      places.push_back(Workspace::on_circle(radius * ring / kRings, 2.0 * std::numbers::pi * k / kAround, 0.0));
    }
  }
  return places;
}

std::optional<DeltaGeometry> fit_rung(const DeltaGeometry& saved, const DeltaReadings& readings, Rung rung,
                                      const LadderPriors& priors) {
  return detail::fit_numbers(saved, saved, readings, detail::rung_basis(saved.actuator, rung),
                             {priors.height, priors.distance}, priors);
}

std::optional<Ladder> ladder(const DeltaGeometry& saved, const DeltaReadings& readings, const LadderOptions& options) {
  return Climb(saved, readings, options).run();
}

}  // namespace paracal

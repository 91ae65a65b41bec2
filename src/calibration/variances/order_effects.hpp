#pragma once

// Private to calibration: what changes along the order of the readings, or with the side from which a joint came.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reading_order.hpp"
#include "variance_posterior.hpp"

namespace paracal::detail {

/// What an effect of the order is of.
enum class OrderedBy : std::uint8_t {
  machine,  ///< errors of parts drift
  set_up,   ///< the frame or the zero of an instrument does
  sides,    ///< joints stop on the side from which they came
};

/// An effect on a reading with rows J by the unknowns and H by the joints, linear in its sizes:
///
///   sum_d p_d(t) J D size_d   of a drift along directions D of the unknowns, p_d and t as ReadingOrder has them,
///   H D diag(s) size          of joints that came from the sides s, where each column of D is of one joint.
struct OrderEffect {
  /// Of unknowns, set-up first, or of joints: places with their weights.
  using Direction = std::vector<std::pair<Eigen::Index, double>>;

  OrderedBy by = OrderedBy::machine;
  std::string subject = {};                ///< "rod 1 of limb 2"
  std::vector<Direction> directions = {};  ///< the columns of D: a size of 1 moves the mean readings by 1 mm rms
  int degree = 1;                          ///< the highest of a drift
  std::shared_ptr<const ReadingOrder> order = {};
  double odds = 0.0;  ///< before the readings

  Eigen::Index size_count() const { return std::ssize(directions) * degree; }
  /// What sizes do to a reading where time and sides are 1: rows x sizes.
  Eigen::MatrixXd along(const Eigen::MatrixXd& J, const Eigen::MatrixXd& H) const;
  /// The factor of each size at a reading.
  Eigen::RowVectorXd factors(std::size_t group) const;
};

/// An effect, and how large it is.
struct FoundOrder {
  OrderEffect effect;
  Eigen::VectorXd sizes = {};
  double log_odds = 0.0;                 ///< after the readings, against none; of the best: of any such effect
  double largest = 0.0;                  ///< what it moves any reading by, mm
  std::vector<std::string> others = {};  ///< subjects that explain the readings about as well

  double probability() const { return 1.0 / (1.0 + std::exp(-log_odds)); }
  /// Standard deviation of its sizes, within what such effects may do.
  double size() const;
  /// How far a drifting machine was at most from that of the mean time, of the unknowns: it may stay there.
  Eigen::VectorXd farthest(const Observation& observation) const;
  /// How far each joint stops from the middle of its play, rad or mm.
  Eigen::VectorXd half_widths(Eigen::Index joints) const;
};

/// The effect that explains the readings best. Effects are ranked where joints may stop elsewhere as the table has it,
/// so that what no order explains is not taken for one. The best get a table of their own, in which joints need not
/// explain what the effect does.
/// @returns empty where nothing of the kind is more probable than none.
std::optional<FoundOrder> best_order(const StageFit& fit, const WeighedTable& none);

/// What it does to the mean readings of a table: rows x sizes.
Eigen::MatrixXd on_means(const OrderEffect& effect, const LinearReadings& readings);

/// The fit where it has been taken off the readings. To be settled again.
void take_off(const FoundOrder& found, StageFit& fit);

}  // namespace paracal::detail

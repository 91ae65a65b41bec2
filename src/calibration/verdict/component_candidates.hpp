#pragma once

// Private to calibration: components of variance that may be there, and how much they promise.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

/// What widens: of each the best is tried, whatever the others promise.
enum class ComponentFamily : std::uint8_t {
  noise,    ///< of joints or of readings
  group,    ///< priors of all errors, of the position or of the tilt group
  kind,     ///< of one kind of error on all limbs
  in_limb,  ///< of the coordinates of one joint centre of a limb
  one,      ///< of one error
};

/// A component that may be there.
struct ComponentCandidate {
  ComponentFamily family = ComponentFamily::noise;
  std::string subject = {};  ///< "e_z of limb 2"; of families that name a part
  double promised = 0.0;     ///< drop of -2 log likelihood
  double price = 0.0;        ///< what trying as many alike takes from that drop: 2 log of their number
  std::function<void(StageFit&)> begin = {};
  std::function<double(const StageFit&)> size = {};              ///< what it came to
  std::function<std::string(const StageFit&, double)> say = {};  ///< and that in words

  double worth() const { return promised - price; }
  bool names_part() const { return !subject.empty(); }
};

/// Candidates whose promise exceeds their price by less are not tried.
inline constexpr double kWorthTrying = 2.0;

/// By how much -2 log likelihood can drop at best when the variance of `freedom` squares, `ratio` times what was
/// expected, is sought: freedom (ratio - 1 - log ratio), none for squares that are too small.
double promised_drop(double ratio, double freedom);

/// Joints that stand elsewhere, and stated noise that is not what was stated.
void add_noise_candidates(const StageFit& fit, std::vector<ComponentCandidate>& all);

/// Wider priors (wider_priors.cpp).
void add_prior_candidates(const StageFit& fit, std::vector<ComponentCandidate>& all);

/// Those that promise most, the best of each family, and parts that promise about as much as the best of them: the
/// promise is a linear model's, and a part that is far off bends the fit more than that.
std::vector<ComponentCandidate> worth_trying(std::vector<ComponentCandidate> all);

}  // namespace paracal::detail

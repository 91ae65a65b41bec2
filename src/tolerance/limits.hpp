#pragma once

// Private to tolerance: where limits break, and by how much a machine uses them up.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drawing.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/tolerance/response.hpp"
#include "tilted_mixture.hpp"

namespace paracal::detail {

class Limits {
 public:
  /// @throws Unreachable, InvalidArgument as LinearModel::rows.
  Limits(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
         const std::vector<Pose>& poses);

  const VaryingErrors& errors() const { return errors_; }

  /// All ways in which a limit may break: of each requirement at each pose, along the principal axes of its components'
  /// covariance and half way between them.
  std::vector<FailureMode> modes() const;

  /// The largest value of each machine over its limit, by the linear model: what is above 1 fails.
  Eigen::ArrayXd used_up(const Eigen::MatrixXd& errors) const;

  /// What the exact model says of a machine, where the linear one has it near a limit.
  struct Trial {
    bool fails = false, closes = true;
    double linear = 0.0;  ///< where it fails: what the linear model has used up there; the largest of several
  };
  /// @param near    of a limit: what must be used up by the linear model for a pose to be tried.
  /// @param stream  of the errors that no linear response feels.
  Trial try_exactly(const Eigen::VectorXd& errors, double near, std::uint64_t seed, std::uint64_t stream) const;

 private:
  struct Place {
    double linear = 0.0;  ///< used up there
    std::size_t requirement = 0, pose = 0;
  };
  std::vector<Place> places_near_limits(const Eigen::VectorXd& errors, double near) const;
  SourceErrors all_errors(const Eigen::VectorXd& varying, std::uint64_t seed, std::uint64_t stream) const;
  void add_modes(const Eigen::MatrixXd& rows, std::vector<FailureMode>& all) const;

  const Robot& robot_;
  const Tolerances& tolerances_;
  const std::vector<Requirement>& requirements_;
  Response response_;
  Drawing drawing_;
  VaryingErrors errors_;
};

}  // namespace paracal::detail

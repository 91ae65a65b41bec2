#pragma once

// Private to printer: a delta as its readings show it, with what they leave open.

#include <Eigen/Core>
#include <optional>

#include "rung_fit.hpp"

namespace paracal::detail {

/// Numbers of the firmware, shapes of the bed and a bias of all distances, estimated together about a geometry that
/// fits: a Gaussian, linear in all of them.
class KnownDelta {
 public:
  /// @param geometry  of the widest fit. @throws nothing; see is_closed().
  KnownDelta(const DeltaGeometry& geometry, const DeltaGeometry& saved, const DeltaReadings& readings,
             const ReadingNoise& noise, const LadderOptions& options);

  /// Part of an error of a reading that stays in its residual, reading by reading.
  const Eigen::VectorXd& own_parts() const { return own_parts_; }
  /// Residuals of the readings, in standard deviations.
  const Eigen::VectorXd& residuals() const { return residuals_; }

  /// Machines that the readings leave possible, one a column: the same ones at each call.
  Eigen::MatrixXd possible(Eigen::Index count) const;

  /// What a firmware with some values does on possible machines.
  struct Behaviour {
    Eigen::VectorXd depth;    ///< of the nozzle below the bed, mm
    Eigen::VectorXd layer;    ///< first layer, mm rms over the disk
    Eigen::VectorXd size;     ///< relative error of the size of prints
    Eigen::VectorXd heights;  ///< of the nozzle above the bed on the expected machine, mm: over printable_disk()
  };
  /// Empty where the values reach less than half of the disk. Places that they do not reach do not count.
  std::optional<Behaviour> behaviour(const DeltaGeometry& values, const Eigen::MatrixXd& machines) const;

 private:
  DeltaGeometry geometry_;
  double radius_;
  DeltaBasis free_;  ///< the numbers
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd mean_, residuals_, own_parts_;
};

}  // namespace paracal::detail

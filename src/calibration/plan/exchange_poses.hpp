#pragma once

// Private to calibration: the search for the best poses among candidates.

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/pose_selection.hpp"

namespace paracal::detail {

/// Candidates as weighted rows over x = (frame and the like | source errors), each in units of its prior, so that the
/// covariance before measuring is I.
struct Problem {
  int rows = 0;                      ///< a candidate
  Eigen::MatrixXd weighted;          ///< unknowns x (rows x candidates): A_k^T side by side
  Eigen::MatrixXd goal;              ///< B of the criterion tr(B C)
  Eigen::VectorXd scale;             ///< of the source errors in x: their prior std
  Eigen::MatrixXd known_setup = {};  ///< rows [set-up] of what is known of it: the instrument's scale
  Eigen::MatrixXd visible;           ///< orthonormal directions of x, in the group of interest, that the candidates see
  Eigen::Index candidates() const { return weighted.cols() / rows; }
};

/// Adds the best candidate until there are enough, then exchanges poses while that helps. Candidates have Rows rows
/// each, 3 or Eigen::Dynamic: as many as the problem says. One file each, as each takes long to compile.
template <int Rows>
Selection exchange_poses(const Robot& robot, const std::vector<Station>& candidates, const SelectionOptions& options,
                         const Problem& problem, const PoseSpread& spread);
extern template Selection exchange_poses<3>(const Robot&, const std::vector<Station>&, const SelectionOptions&,
                                            const Problem&, const PoseSpread&);
extern template Selection exchange_poses<Eigen::Dynamic>(const Robot&, const std::vector<Station>&,
                                                         const SelectionOptions&, const Problem&, const PoseSpread&);

}  // namespace paracal::detail

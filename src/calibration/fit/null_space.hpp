#pragma once

// Private to calibration: what readings do not determine, in words.

#include "paracal/calibration/calibration.hpp"

namespace paracal::detail {

/// The directions of a null space (its columns) in words: gauge motions in it first, the remainder by their main
/// parameters.
std::vector<NullDirection> in_words(const Robot& robot, const Eigen::MatrixXd& null_space,
                                    const std::vector<SoughtSource>& parameters);

/// A line for each of the first five directions, and one that counts the others.
std::string undetermined_lines(const std::vector<NullDirection>& null_space);

/// Factor a parameter that makes lengths and angles comparable: to the units of [huang2016, Eq. (4)].
Eigen::VectorXd paper_scales(const Robot& robot, const std::vector<SoughtSource>& parameters);

/// A direction over some parameters as one over others: zero where they have no place in the first.
Eigen::VectorXd among(const Eigen::VectorXd& direction, const std::vector<SoughtSource>& of,
                      const std::vector<SoughtSource>& others);

}  // namespace paracal::detail

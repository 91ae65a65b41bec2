#pragma once

#include <Eigen/Core>
#include <vector>

#include "paracal/mechanism/random.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// Draws the errors of many machines at once, but only those that move a response: columns of zeros and exact parts are
/// left out. Equal to draw_errors() number by number.
class Drawing {
 public:
  /// @param response  a column a parameter of the robot.
  Drawing(const Robot& robot, const Eigen::MatrixXd& response, const Tolerances& tolerances);

  /// The columns of the response that vary.
  const Eigen::MatrixXd& matrix() const { return matrix_; }

  /// Their columns in the response.
  const std::vector<Eigen::Index>& columns() const { return columns_; }

  /// Column m: the errors of machine first + m.
  void draw(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> errors) const;

 private:
  struct Pair {
    std::uint64_t number = 0;                 ///< of normal_pair()
    std::array<Eigen::Index, 2> row{-1, -1};  ///< where its two numbers go; -1: nowhere
  };

  /// Turns standard normal numbers into source errors: source_error() of each, but without a call a number where all
  /// are normal.
  void spread(Eigen::Ref<Eigen::MatrixXd> errors) const;

  const Tolerances* tolerances_;
  std::vector<Pair> pairs_;
  std::vector<Eigen::Index> columns_;
  std::vector<Source> sources_;  ///< a row of the errors
  Eigen::ArrayXd half_widths_;   ///< of them
  bool all_normal_ = false;
  Eigen::MatrixXd matrix_;
};

}  // namespace paracal::detail

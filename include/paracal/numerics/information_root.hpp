#pragma once

#include <Eigen/Core>

namespace paracal {

/// Square root of the information that rows of residuals carry about n parameters, streamed: of all rows [J | r] added
/// so far only the upper triangle T with T^T T = [J | r]^T [J | r] is kept,
///
///   \f[ T = \begin{pmatrix} R & q \\ 0 & e \end{pmatrix},    |J dp + r|^2 = |R dp + q|^2 + e^2 \f]
///
/// Orthogonal (Householder) folding of blocks of rows: as accurate as a factorization of the whole J, in memory that
/// depends on n alone. Rows are divided by their standard deviation first, so that R^T R is the inverse covariance.
class InformationRoot {
 public:
  explicit InformationRoot(Eigen::Index parameters);

  Eigen::Index parameter_count() const { return buffer_.cols() - 1; }
  /// Rows added so far.
  Eigen::Index row_count() const { return rows_; }

  /// Adds rows [J | r]; as many columns as parameters, and one.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& rows);
  /// Adds everything that another root over the same parameters has seen.
  void add(const InformationRoot& other);
  /// Adds the row "parameter = value within sigma", where the parameter stands at `current`.
  void add_prior(Eigen::Index parameter, double current, double value, double sigma);

  /// R, n x n, upper triangular.
  Eigen::MatrixXd root() const;
  /// q, n: the residuals as far as parameters can change them.
  Eigen::VectorXd reachable() const;
  /// Sum of the squared residuals, |q|^2 + e^2.
  double squared_residuals() const { return squared_residuals_; }

 private:
  void fold() const;

  // Triangle on top, rows not yet folded below; folding changes how the sum is stored, not what it says.
  mutable Eigen::MatrixXd buffer_;
  mutable Eigen::Index used_ = 0;
  mutable bool folded_ = true;
  Eigen::Index rows_ = 0;
  double squared_residuals_ = 0.0;
};

/// What a root says about its parameters: where it is blind, and how far it sees.
struct Spectrum {
  Eigen::VectorXd singular_values;  ///< of the root with columns scaled, largest first
  Eigen::VectorXd scale;            ///< each column of R was divided by this
  int rank = 0;
  Eigen::MatrixXd covariance;  ///< (R^T R)^+: nothing is said about null directions
  Eigen::MatrixXd null_space;  ///< unit columns: parameter directions that the rows do not see
};

/// Singular value decomposition of R D^-1. Values below `rank_tolerance` of the largest count as zero.
/// @param scale  D; empty: the column lengths of R (all-zero columns stay as they are).
Spectrum analyse(const Eigen::MatrixXd& root, double rank_tolerance, const Eigen::VectorXd& scale = {});

/// (R^T R)^-1 of a root without null directions. For one that has any, see analyse().
Eigen::MatrixXd inverse_information(const Eigen::MatrixXd& root);

}  // namespace paracal

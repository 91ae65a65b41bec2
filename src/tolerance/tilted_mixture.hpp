#pragma once

// Private to tolerance: machines drawn where limits break, and what each then counts.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "paracal/mechanism/parameter.hpp"
#include "source_law.hpp"

namespace paracal::detail {

/// The errors that vary, and their laws.
struct VaryingErrors {
  std::vector<Parameter> parameters;
  std::vector<SourceLaw> laws;

  Eigen::Index size() const { return static_cast<Eigen::Index>(parameters.size()); }
};

/// A way in which a limit may be broken: a . e > 1.
struct FailureMode {
  Eigen::VectorXd tilt;          ///< t = theta a, of each error: the tilted mean of a . e is 1
  double cumulant = 0.0;         ///< K(t)
  double log_probability = 0.0;  ///< of a . e > 1, about  [lugannani-rice1980, first term]
};

/// Empty where no machine within its drawings gets there.
std::optional<FailureMode> failure_mode(const VaryingErrors& errors, const Eigen::VectorXd& a);

/// The likeliest first, without those that hardly count.
std::vector<FailureMode> likeliest(std::vector<FailureMode> modes);
/// Of those, the few that no likelier one stands for.
std::vector<FailureMode> likeliest_apart(std::vector<FailureMode> modes, const VaryingErrors& errors);

/// q = a_0 f + sum a_j f_j, see failure_share(). Machine m is stream m of the seed, whose numbers are those of
/// draw_errors(), and one more that says which law it is drawn from.
class TiltedMixture {
 public:
  /// @param modes  those of which one is likely enough leave the law as drawn alone.
  TiltedMixture(const VaryingErrors& errors, std::vector<FailureMode> modes);

  bool is_plain() const { return shares_.size() == 1; }
  /// @param errors     column m: the varying errors of machine first + m.
  /// @param log_ratio  log(f / q) of each.
  void draw(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> errors,
            Eigen::Ref<Eigen::ArrayXd> log_ratio) const;

 private:
  std::size_t law_of(double probability) const;

  const VaryingErrors* errors_;
  Eigen::MatrixXd tilts_;       ///< a row a law, that as drawn first
  Eigen::ArrayXd log_weight_;   ///< log a_j - K(t_j)
  std::vector<double> shares_;  ///< a_0 + ... + a_j
};

}  // namespace paracal::detail

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <openturns/LinearFunction.hxx>
#include <openturns/Normal.hxx>
#include <string>

namespace paracal::benchmark {

/// Methods of OpenTURNS to compute the response of a Sample. Each is one matrix product (BLAS) for all machines. None
/// calls a function or creates a Point per machine, as other Functions of OpenTURNS do.
enum class OpenTurnsWay : std::uint8_t {
  linear_function,  ///< LinearFunction, one Sample of all machines: as its manual shows
  small_samples,    ///< LinearFunction, Samples below the 128 KB that malloc fetches afresh from the system every time,
                    ///< which is most of the time of large ones
  bare_product,     ///< MatrixImplementation::genSampleProd: without the passes for centre and constant, both zero
};

/// Sigma of tilt by Monte Carlo in OpenTURNS, by its fastest means:
///
///   - Normal without correlation: numbers by the ziggurat, without a product by a Cholesky factor. OpenTURNS draws on
///     one thread, its generator being one global state.
///   - The response, by one of the ways above. OpenBLAS on as many threads as asked; another BLAS decides itself.
///   - Sample::computeVariance: a reduction on as many threads (TBB) as asked.
///
/// It does less than monte_carlo(): neither fourth powers, for the interval of sigma, nor the largest value of every
/// machine, for the yield.
class OpenTurnsTilt {
 public:
  /// @param response  a column a source error; the upper half of the rows eps_x of every pose, the lower eps_y
  /// @param std       of the source errors
  OpenTurnsTilt(const Eigen::MatrixXd& response, const Eigen::VectorXd& std);

  /// At every pose.
  /// @param machines  a multiple of 512.
  Eigen::VectorXd sigma(OpenTurnsWay way, unsigned machines, unsigned threads) const;

  /// OpenTURNS and the BLAS that this process has loaded.
  static std::string libraries();

 private:
  OT::Sample response(OpenTurnsWay way, const OT::Sample& errors) const;

  OT::Normal errors_;
  OT::Matrix matrix_;
  OT::LinearFunction function_;
};

}  // namespace paracal::benchmark

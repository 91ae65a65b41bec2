#include "openturns_tilt.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <openturns/PlatformInfo.hxx>
#include <openturns/TBB.hxx>

namespace paracal::benchmark {
namespace {

/// A function of a library that this process has loaded, maybe.
template <typename Function>
Function* loaded(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_DEFAULT, name));
}

OT::Point point_of(const Eigen::VectorXd& numbers) {
  OT::Point point(static_cast<OT::UnsignedInteger>(numbers.size()));
  for (Eigen::Index k = 0; k < numbers.size(); ++k) point[static_cast<OT::UnsignedInteger>(k)] = numbers(k);
  return point;
}

OT::Matrix matrix_of(const Eigen::MatrixXd& numbers) {
  const auto rows = static_cast<OT::UnsignedInteger>(numbers.rows());
  const auto columns = static_cast<OT::UnsignedInteger>(numbers.cols());
  return {rows, columns, OT::Collection<OT::Scalar>(numbers.data(), numbers.data() + numbers.size())};
}

/// What was found fastest.
unsigned machines_a_sample(OpenTurnsWay way, unsigned machines) {
  switch (way) {
    case OpenTurnsWay::linear_function:
      return machines;
    case OpenTurnsWay::small_samples:
      return 64;
    case OpenTurnsWay::bare_product:
      return 128;
  }
  return machines;
}

}  // namespace

OpenTurnsTilt::OpenTurnsTilt(const Eigen::MatrixXd& response, const Eigen::VectorXd& std)
    : errors_(OT::Point(static_cast<OT::UnsignedInteger>(std.size())), point_of(std),
              OT::CorrelationMatrix(static_cast<OT::UnsignedInteger>(std.size()))),
      matrix_(matrix_of(response)),
      function_(OT::Point(static_cast<OT::UnsignedInteger>(response.cols())),
                OT::Point(static_cast<OT::UnsignedInteger>(response.rows())), matrix_) {}

OT::Sample OpenTurnsTilt::response(OpenTurnsWay way, const OT::Sample& errors) const {
  if (way != OpenTurnsWay::bare_product) return function_(errors);
  constexpr bool kTransposeMatrix = true, kTransposeSample = false;
  return matrix_.getImplementation()->genSampleProd(errors, kTransposeMatrix, kTransposeSample, 'R');
}

Eigen::VectorXd OpenTurnsTilt::sigma(OpenTurnsWay way, unsigned machines, unsigned threads) const {
  OT::TBB::SetThreadsNumber(threads);
  if (const auto set_threads = loaded<void(int)>("openblas_set_num_threads")) set_threads(static_cast<int>(threads));
  const unsigned sample = machines_a_sample(way, machines), samples = machines / sample;
  const auto poses = static_cast<Eigen::Index>(matrix_.getNbRows()) / 2;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(2 * poses);
  for (unsigned k = 0; k < samples; ++k) {
    const OT::Point variance = response(way, errors_.getSample(sample)).computeVariance();
    sum += Eigen::Map<const Eigen::VectorXd>(variance.data(), 2 * poses);
  }
  return ((sum.head(poses) + sum.tail(poses)) / samples).cwiseSqrt();
}

std::string OpenTurnsTilt::libraries() {
  std::string blas = "a BLAS that is not OpenBLAS";
  if (const auto describe = loaded<const char*()>("openblas_get_config")) {
    const std::string said = describe();  // "OpenBLAS 0.3.21 NO_LAPACKE ..."
    blas = said.substr(0, said.find(' ', said.find(' ') + 1));
    if (const auto core = loaded<const char*()>("openblas_get_corename")) blas += fmt::format(" ({})", core());
  }
  return fmt::format("OpenTURNS {} on {}", OT::PlatformInfo::GetVersion(), blas);
}

}  // namespace paracal::benchmark

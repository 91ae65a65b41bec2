// The compensator as a controller may compile it: these headers first and alone, without exceptions and without
// run-time types. That this file compiles is the test.

#include "paracal/compensation/parameter_buffer.hpp"
#include "paracal/compensation/stated_uncertainty.hpp"

#include <utility>

#if defined(EIGEN_CORE_H) || defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "expected the standard library alone, -fno-exceptions and -fno-rtti"
#endif

template class paracal::Compensator<double>;
template class paracal::Compensator<float>;
template class paracal::ParameterBuffer<double>;
template class paracal::ParameterBuffer<float>;
template class paracal::ParameterReader<double>;
template class paracal::ParameterReader<float>;
template class paracal::ChangingCompensator<double>;
template class paracal::ChangingCompensator<float>;

using Compensator = paracal::Compensator<double>;
static_assert(
    noexcept(std::declval<const Compensator&>().compensate({}, std::declval<paracal::CompensatorJoints<double>&>())));
static_assert(noexcept(paracal::stated_uncertainty(std::declval<const paracal::CompensatorParameters<float>&>(),
                                                   std::declval<const paracal::CompensatorCovariance<float>&>(), {},
                                                   std::declval<paracal::CompensatorUncertainty<float>&>())));
template paracal::CompensationStatus paracal::stated_uncertainty(const CompensatorParameters<double>&,
                                                                 const CompensatorCovariance<double>&,
                                                                 const CompensatorPose<double>&,
                                                                 CompensatorUncertainty<double>&) noexcept;

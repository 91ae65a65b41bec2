#pragma once

#include <cstdint>
#include <string>

#include "fine_fit.hpp"
#include "fine_solve.hpp"

namespace paracal::benchmark {

/// How Ceres solves for its step.
enum class CeresSolver : std::uint8_t { normal_cholesky, qr };

/// What a cost function of Ceres holds: a station, as its manual shows, or all of them, so that the machine and its
/// derivatives are built once an evaluation.
enum class CeresCost : std::uint8_t { one_station, all_stations };

/// The same fit by Ceres Solver with automatic derivatives, on one thread. In its favour, the closure is iterated in
/// plain numbers by forward(); one more Newton step in numbers that carry derivatives, with the Jacobian J of the
/// closure in plain numbers, then has the derivatives of the answer (implicit differentiation),
///
///   r(p) = r - [(J^T J)^-1 J^T f(p)]_r,
///
/// and steps begin undamped, as ours do.
FineAnswer solve_with_ceres(const FineFit& fit, CeresCost cost, CeresSolver solver);

/// The same with the rows and the Jacobian of our own fit: Ceres has the steps alone to take.
FineAnswer solve_with_ceres(const FineSolve& fit, CeresSolver solver);

/// "Ceres 2.1.0"
std::string ceres_version();

}  // namespace paracal::benchmark

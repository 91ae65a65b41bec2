#pragma once

// Private to tolerance: the cheapest tolerances with which few machines break a limit.

#include "paracal/tolerance/allocation.hpp"

namespace paracal::detail {

/// allocate() of a problem with limits by yield that was checked.
Allocation allocate_by_yield(const Robot& robot, const AllocationProblem& problem);

}  // namespace paracal::detail

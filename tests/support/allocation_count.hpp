#pragma once

#include <cstddef>

namespace paracal::test {

/// Heap blocks that this process has asked for so far: every call of malloc, calloc, realloc and aligned_alloc, which
/// operator new and Eigen end in.
std::size_t allocation_count();

}  // namespace paracal::test

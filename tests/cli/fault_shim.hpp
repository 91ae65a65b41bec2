#pragma once

namespace paracal::test {

/// In the place of a number of an error: the call says that it did nothing, and of no error.
inline constexpr int kTakesNothing = 10'000;

}  // namespace paracal::test

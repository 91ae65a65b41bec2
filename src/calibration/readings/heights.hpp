#pragma once

#include "length_model.hpp"

namespace paracal::detail {

/// Heights above a plane:
///
///   height     z - (z_0 + s_x x + s_y y)
///
/// with z_0 and the slopes sought.
const LengthModel& heights();

}  // namespace paracal::detail

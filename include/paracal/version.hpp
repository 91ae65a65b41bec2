#pragma once

#include <string_view>

namespace paracal {

/// Version of the library, e.g. "0.1.0"; written into every calibration.
std::string_view version();

}  // namespace paracal

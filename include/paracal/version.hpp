#pragma once

#include <string_view>

namespace paracal {

/// Version of the library, e.g. "0.2.0"; written into every calibration.
std::string_view version();

/// Commit and compiler of the library, e.g. "1a2b3c4d5e6f, GNU 12.2.0 Release"; "-dirty" behind a commit: and what was
/// not committed; written into every calibration and batch.
std::string_view build();

}  // namespace paracal

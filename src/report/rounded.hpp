#pragma once

// Private to report.

#include <Eigen/Core>

#include "paracal/io/json.hpp"

namespace paracal::report::detail {

/// Six digits: more than a drawing shows, a third of the bytes. Numbers that are not finite become null.
io::Json rounded(double value);
io::Json rounded(const Eigen::Vector3d& vector);

}  // namespace paracal::report::detail

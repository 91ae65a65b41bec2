#pragma once

// Private to io: small pieces of JSON.

#include <optional>

#include "paracal/io/json.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

inline Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// Of an angle in rad.
inline Json optional_degrees(const std::optional<double>& value) {
  return value ? Json(to_degrees(*value)) : Json(nullptr);
}

}  // namespace paracal::io

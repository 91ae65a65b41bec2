#pragma once

// Private to io: texts that nest deeper than any file of this program is does, which would exhaust the stack of whoever
// follows them.

#include <optional>
#include <string_view>

#include "paracal/io/json.hpp"

namespace paracal::io {

inline constexpr int kDeepest = 64;

/// A JSON text.
/// @throws Json::parse_error for anything else, and for one that is nested deeper than kDeepest.
Json parse_shallow(std::string_view text);

/// Line of the first dotted key of a TOML text with more than kDeepest parts, from 1.
std::optional<int> line_of_endless_key(std::string_view text);

}  // namespace paracal::io

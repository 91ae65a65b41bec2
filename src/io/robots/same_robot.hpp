#pragma once

// Private to io: whether two robots are the same, as far as a calibration is of one of them, and where it says so.

#include <optional>
#include <string>
#include <string_view>

#include "io/calibrations/json_node.hpp"
#include "paracal/io/json.hpp"

namespace paracal::io {

/// As difference(), of robots as they stand in JSON.
std::optional<std::string> robot_difference(const Json& expected, const Json& got);

/// The robot that a part of a file describes under the keys of a robot file.
/// @throws InputFileError for one that makes no sense.
Robot robot_in(const JsonNode& node, const std::string& file);

}  // namespace paracal::io

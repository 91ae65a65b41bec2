#pragma once

// Private to calibration: where the frame and the tool of a controller may be, and values as text.

#include <string>
#include <vector>

#include "controller_suspects.hpp"

namespace paracal::detail {

/// "720.00": as many decimals as the joints show, of the given most.
std::string shown(double value, double resolution, int most);
/// Two decimals of mm and three of deg at most, with the unit.
std::string shown_length(double value, double resolution);
std::string shown_angle(double value, double resolution);

/// A frame rotated about z, another origin along z or anywhere, a tool.
std::vector<ControllerSuspect> frame_suspects(const Robot& robot);

}  // namespace paracal::detail

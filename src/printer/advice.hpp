#pragma once

// Private to printer: what an owner is told to do, in words.

#include "paracal/printer/printer_calibration.hpp"

namespace paracal::detail {

/// Fewer heights alone than this make no new values.
inline constexpr std::size_t kFewestHeights = 13;

/// Sets the advice and the findings of a calibration that has everything else.
/// @param readings  all of them.
/// @param implausible  what cannot be; anything forbids advice.
void advise(const DeltaReadings& readings, const std::vector<std::string>& implausible, PrinterCalibration& result);

}  // namespace paracal::detail

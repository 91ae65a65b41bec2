#pragma once

// Private to printer: what an owner is told to do, in words.

#include "paracal/printer/printer_calibration.hpp"

namespace paracal::detail {

/// Sets the advice, the findings and the details of a calibration that has everything else.
/// @param good  the readings without gross ones.
/// @param implausible  what cannot be; anything forbids advice.
void advise(const DeltaReadings& good, const std::vector<std::string>& implausible, PrinterCalibration& result);

}  // namespace paracal::detail

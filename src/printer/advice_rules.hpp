#pragma once

// Private to printer: what is asked of values before they are advised, and what an owner is told to do, in words.

#include "paracal/printer/printer_calibration.hpp"

namespace paracal::detail {

/// A chance that is as good as certain.
inline constexpr double kCertain = 0.95;

/// Heights tell how flat a machine goes, and hardly how large: values that explain them a little better than those in
/// use may lose more in size, which nobody measured, than they gain. Only where the saved values are far off, the mean
/// square error of held-out heights falling by 5 parts in 6 (a factor of 2.4), are heights enough.
bool is_enough_of_heights(const PrinterCandidate& values, const PrinterCalibration& found);

/// Below the bed by so much, the nozzle at z = 0 scratches it: more than the thickness of a first layer, mm.
inline constexpr double kDeepest = 0.2;

inline bool scratches_bed(const PrinterCandidate& values) { return !(values.depth <= kDeepest); }

/// Better than the saved values by more than chance: by what the calibration knows and by the readings that were held
/// out; either may be certain alone if the other does not contradict. Heights that were held out say nothing of the
/// size of prints, and those of a bowed bed the wrong thing: what is known has to be certain of that by itself.
bool better(const PrinterCandidate& values, const PrinterCalibration& found);

PrinterAdvice advice_of(bool few, const PrinterCalibration& found);

/// Fewer heights alone than this make no new values.
inline constexpr std::size_t kFewestHeights = 13;

/// Sets the advice and the findings of a calibration that has everything else.
/// @param readings  all of them.
/// @param implausible  what cannot be; anything forbids advice.
void advise(const DeltaReadings& readings, const std::vector<std::string>& implausible, PrinterCalibration& result);

}  // namespace paracal::detail

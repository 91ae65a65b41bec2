#include "paracal/printer/common_shift.hpp"

#include <cmath>

namespace paracal {

std::vector<std::string> CommonShift::likely_causes() const {
  constexpr double kProbe = 10.0;  // mm: no probe triggers further away
  if (!is_stated) return {};
  std::vector<std::string> causes{"the bed was moved, or another build plate lies on it",
                                  "an endstop switch was moved, or the homed height in the file is wrong"};
  const std::string trigger = "the trigger height of the probe is not stated";
  causes.insert(std::abs(value) <= kProbe ? causes.begin() : causes.end(), trigger);
  return causes;
}

double common_shift(const DeltaGeometry& saved, const DeltaGeometry& by) {
  const auto drops = drops_to(by, Eigen::Vector3d::Zero());
  const auto believed = drops ? nozzle(saved, *drops) : std::nullopt;
  return believed ? believed->z() : NAN;
}

DeltaGeometry with_bed_higher(const DeltaGeometry& geometry, double shift) {
  DeltaNumbers numbers = numbers_of(geometry);
  numbers.segment<3>(DeltaNumber::endstop).array() -= shift;
  if (geometry.actuator == Actuator::revolute) numbers(DeltaNumber::shoulder) -= shift;
  return with_numbers(geometry, numbers);
}

DeltaReadings without_shift(DeltaReadings readings, double shift) {
  for (BedReading& one : readings.heights) one.height += shift;
  return readings;
}

}  // namespace paracal

#pragma once

#include <optional>
#include <string>

#include "measuring.hpp"
#include "paracal/calibration/validation.hpp"

namespace paracal::app {

/// What commands that judge a calibration by measurements ask for.
struct ValidatingOptions {
  MeasuringOptions measuring;
  std::string calibration;
  std::optional<double> limit_mm, limit_aligned_mm, limit_deg;

  ValidationOptions options() const;
};

/// --calibration, the measuring options and the limits.
/// @returns --measurements, which is required unless its taker says otherwise.
CLI::Option* add_validating_options(CLI::App& command, ValidatingOptions& options);

}  // namespace paracal::app

#pragma once

#include <string>

#include "paracal/tolerance/failure.hpp"

namespace paracal::app {

/// The yield in percent and its defects per million, each with its interval, and where they come from.
std::string yield_text(const FailureShare& failures, const MonteCarlo& drawn, double confidence);

/// A line: the share of machines that break one limit of several.
std::string failure_line(const FailureShare& failures);

}  // namespace paracal::app

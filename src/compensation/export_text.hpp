#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/compensation/export.hpp"
#include "paracal/compensation/self_test.hpp"
#include "recording.hpp"

// What exports of every language share: templates, and what stands at their head.

namespace paracal::compensation_detail {

using Values = std::vector<std::pair<std::string_view, std::string>>;

/// A template of src/compensation/templates with every $KEY$ replaced by its value.
std::string filled_template(std::string_view name, const Values& values);

/// What the head of every export says.
Values head(const Robot& robot, const ExportOrigin& origin);

/// A machine as exports need it.
struct ExportedMachine {
  CompensatorParameters<double> parameters;
  std::vector<SelfTestCase> cases;
  RecordedMachine recorded;

  ExportedMachine(const Robot& robot, const SourceErrors& errors);
};

/// What one compensation computes, as a sentence.
std::string operations(const ExportedMachine& machine);
/// The same of one on limbs with one rod.
std::string operations(const Procedure& joints, Actuator actuator);

/// A number with a decimal point, the fewest digits that give it back.
std::string decimal(double value);

}  // namespace paracal::compensation_detail

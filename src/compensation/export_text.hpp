#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/compensation/export.hpp"
#include "paracal/compensation/self_test.hpp"
#include "paracal/mechanism/coordinates.hpp"
#include "recording.hpp"
#include "variants.hpp"

// What exports of every language share: templates, and what stands at their head.

namespace paracal::compensation_detail {

using Values = std::vector<std::pair<std::string_view, std::string>>;

/// A template of src/compensation/templates with every $KEY$ replaced by its value.
std::string filled_template(std::string_view name, const Values& values);

/// What the head of every export says.
Values head(const Robot& robot, const ExportOrigin& origin);

/// A machine as exports need it.
struct ExportedMachine {
  Machine machine;
  ExportVariant variant;
  CommandCurves curves;
  std::vector<SelfTestCase> cases;
  RecordedMachine recorded;
  ParameterSet set;
  std::vector<std::size_t> places;  ///< in pose[6] of what can be commanded
  double worst;                     ///< error of the variant over the workspace, mm

  /// @throws InvalidArgument unless has_compensator(); Unreachable when the centre of the workspace is out of reach.
  ExportedMachine(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                  const DriveCurves& drives);

  bool searches() const { return recorded.state_size > 0; }
  bool is_even() const { return are_even(curves); }
  /// Where the curves of uneven drives begin among the numbers.
  std::size_t drives_at() const { return recorded.numbers.size(); }
};

/// What the head says of a machine and its compensator.
void add_head(const Robot& robot, const ExportedMachine& exported, Values& values);

/// A commanded coordinate as inputs and pins call it: "x_mm", "tilt_y_rad"; "phi_rad" of a slide.
std::string coordinate_name(const Machine& machine, std::size_t place);

/// A number with a decimal point, the fewest digits that give it back.
std::string decimal(double value);

}  // namespace paracal::compensation_detail

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>
#include <vector>

#include "embedded.hpp"
#include "paracal/compensation/export.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/self_test.hpp"
#include "paracal/version.hpp"

namespace paracal {

std::string harmless(std::string text) {
  const auto is_harmful = [](unsigned char c) {
    return std::isprint(c) == 0 || c == '"' || c == '\\' || c == '*' || c == '?' || c == '$';
  };
  std::ranges::replace_if(text, is_harmful, '_');
  return text;
}

namespace {

std::string braced(const auto& numbers) { return fmt::format("{{{}}}", fmt::join(numbers, ", ")); }

std::string limb_constants(const CompensatorParameters<double>& parameters) {
  std::string text;
  for (std::size_t i = 0; i < parameters.limb_count; ++i) {
    const CompensatorLimb<double>& limb = parameters.identified[i];
    text += fmt::format(
        "    {{{},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {},\n     {}, {}, {}}},\n",
        braced(limb.base), braced(limb.radial), braced(limb.normal), braced(limb.axis), braced(limb.plate),
        braced(limb.slide), braced(limb.elbow_half), braced(limb.plate_half), braced(limb.rod), limb.arm,
        limb.joint_offset);
  }
  return text;
}

std::string test_vector(const std::vector<SelfTestCase>& cases) {
  std::string text;
  for (const auto& [pose, joints] : cases) {
    const Eigen::Vector3d& r = pose.position;
    text += fmt::format("    {{{}, {}}},\n", braced(std::array{r.x(), r.y(), r.z(), pose.rotation}), braced(joints));
  }
  return text;
}

std::string_view export_template(std::string_view name) {
  const auto files = detail::export_templates();
  const auto found = std::ranges::find(files, name, &detail::EmbeddedFile::name);
  if (found == files.end()) throw std::logic_error(fmt::format("no template {} is built in", name));
  return found->text;
}

using Values = std::vector<std::pair<std::string_view, std::string>>;

/// What the head of every export says.
Values head(const Robot& robot, const ExportOrigin& origin) {
  const bool on_rails = robot.actuator() == Actuator::linear;
  return {{"PROGRAM", fmt::format("paracal {}", version())},
          {"ROBOT", harmless(robot.name())},
          {"CALIBRATION", harmless(origin.calibration)},
          {"SHA256", origin.sha256},
          {"DATE", origin.date},
          {"LIMBS", std::to_string(robot.limb_count())},
          {"JOINT_UNIT", on_rails ? "mm" : "rad"},
          {"SHOWN_JOINT_UNIT", on_rails ? "mm" : "deg"},
          {"JOINT_TOLERANCE", on_rails ? "1e-9" : "1.7e-11"}};
}

/// The text with every $KEY$ replaced by its value.
std::string filled(std::string_view text, const Values& values) {
  std::string result;
  for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$')) {
    const std::size_t end = text.find('$', at + 1);
    const std::string_view key = text.substr(at + 1, end - at - 1);
    result += text.substr(0, at);
    result += std::ranges::find(values, key, &Values::value_type::first)->second;
    text.remove_prefix(end + 1);
  }
  return result.append(text);
}

}  // namespace

std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  const CompensatorParameters<double> parameters = compensator_parameters(robot, errors);
  const std::vector<SelfTestCase> cases = self_test(robot, parameters);
  Values values = head(robot, origin);
  const bool on_rails = robot.actuator() == Actuator::linear;
  values.emplace_back("ON_RAILS", on_rails ? "1" : "0");
  values.emplace_back("STEP_TOLERANCE", on_rails ? "1e-8" : "1e-10");
  values.emplace_back("TILTS_PLATE", std::to_string(parameters.tilts_plate));
  values.emplace_back("LIMB_CONSTANTS", limb_constants(parameters));
  values.emplace_back("TESTS", std::to_string(cases.size()));
  values.emplace_back("TEST_VECTOR", test_vector(cases));
  return filled(export_template("compensator_c99.h"), values);
}

std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin) {
  Values values = head(robot, origin);
  values.emplace_back("LAST_JOINT", std::to_string(robot.limb_count() - 1));
  values.emplace_back("C99", c99_header(robot, errors, origin));
  return filled(export_template("paracal_kins.comp"), values);
}

}  // namespace paracal

#include "export_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "embedded.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/version.hpp"

namespace paracal {

std::string harmless(std::string text) {
  const auto is_harmful = [](unsigned char c) {
    return std::isprint(c) == 0 || c == '"' || c == '\\' || c == '*' || c == '?' || c == '$';
  };
  std::ranges::replace_if(text, is_harmful, '_');
  return text;
}

namespace compensation_detail {
namespace {

std::string_view export_template(std::string_view name) {
  const auto files = detail::export_templates();
  const auto found = std::ranges::find(files, name, &detail::EmbeddedFile::name);
  if (found == files.end()) throw std::logic_error(fmt::format("no template {} is built in", name));
  return found->text;
}

/// What `times` runs do, turns by their series included.
void add(OperationCount& sum, const Procedure& procedure, const RecordedMachine& recorded, std::size_t times) {
  const auto add_one = [&](const OperationCount& one, std::size_t count) {
    sum.additions += count * one.additions;
    sum.multiplications += count * one.multiplications;
    sum.divisions += count * one.divisions;
    sum.square_roots += count * one.square_roots;
    sum.functions += count * one.functions;
  };
  const OperationCount one = procedure.count();
  add_one(one, times);
  add_one(recorded.turn_cosine.count(), times * one.turns / 2);
  add_one(recorded.turn_sine.count(), times * one.turns / 2);
}

std::string brief(const OperationCount& count, std::string_view functions) {
  return fmt::format("{} additions, {} multiplications, {} divisions, {} square roots, {} {}", count.additions,
                     count.multiplications, count.divisions, count.square_roots, count.functions, functions);
}

}  // namespace

std::string filled_template(std::string_view name, const Values& values) {
  std::string_view text = export_template(name);
  std::string result;
  for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$')) {
    const std::size_t end = text.find('$', at + 1);
    const std::string_view key = text.substr(at + 1, end - at - 1);
    result += text.substr(0, at);
    const auto value = std::ranges::find(values, key, &Values::value_type::first);
    if (value == values.end()) throw std::logic_error(fmt::format("template {}: nothing is known for {}", name, key));
    result += value->second;
    text.remove_prefix(end + 1);
  }
  return result.append(text);
}

namespace {

/// Further lines of a comment, each behind what begins its lines.
std::string remarks(const ExportOrigin& origin, std::string_view begin) {
  std::string text;
  for (const std::string& one : origin.remarks) text.append("\n").append(begin).append(harmless(one));
  return text;
}

}  // namespace

Values head(const Robot& robot, const ExportOrigin& origin) {
  const bool in_mm = joint_unit(robot.actuator()) == Unit::mm;
  return {{"PROGRAM", fmt::format("paracal {}", version())},
          {"ROBOT", harmless(robot.name())},
          {"CALIBRATION", harmless(origin.calibration)},
          {"SHA256", origin.sha256},
          {"DATE", origin.date},
          {"C_REMARKS", remarks(origin, " *   ")},
          {"ST_REMARKS", remarks(origin, "   ")},
          {"HAL_REMARKS", remarks(origin, "#   ")},
          {"PLAIN_REMARKS", remarks(origin, "")},
          {"LIMBS", std::to_string(robot.limb_count())},
          {"LAST_JOINT", std::to_string(robot.limb_count() - 1)},
          {"JOINT_UNIT", in_mm ? "mm" : "rad"},
          {"SHOWN_JOINT_UNIT", in_mm ? "mm" : "deg"},
          {"JOINT_TOLERANCE", in_mm ? "1.0E-9" : "1.7E-11"},
          {"SERIES_REACH", decimal(kSeriesReach)},
          {"MOST_STEPS", std::to_string(kMostSteps)},
          {"SETTLED", decimal(kSettled<double>)}};
}

ExportedMachine::ExportedMachine(const Robot& robot, const SourceErrors& errors)
    : parameters(compensator_parameters(robot, errors)),
      cases(self_test(robot, parameters)),
      recorded(record(parameters)) {}

std::string operations(const ExportedMachine& machine) {
  const RecordedMachine& recorded = machine.recorded;
  OperationCount count;
  add(count, recorded.level, recorded, 1);
  if (machine.parameters.tilts_plate == 0) return brief(count, "arctangents") + " per call";
  add(count, recorded.answer, recorded, 1);
  add(count, recorded.step, recorded, 4);
  return fmt::format("{} per call with four steps, the usual number", brief(count, "arctangents"));
}

std::string operations(const Procedure& joints, Actuator actuator) {
  return brief(joints.count(), swings_arm(actuator) ? "sines, cosines and arctangents" : "sines and cosines") +
         " per call";
}

std::string decimal(double value) {
  std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), ".0");
  std::ranges::replace(text, 'e', 'E');
  return text;
}

}  // namespace compensation_detail
}  // namespace paracal

#include "filtered_program.hpp"

#include <cstdlib>
#include <sstream>

namespace paracal::test {

std::vector<std::string> Filtered::lines() const { return lines_in(text); }

std::int64_t Filtered::passed(std::string_view reason) const {
  std::int64_t count = 0;
  for (const io::PassedThrough& one : summary.passed) {
    if (one.reason.find(reason) != std::string_view::npos) count += one.count;
  }
  return count;
}

std::vector<std::string> lines_in(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Filtered filtered_gcode(const std::string& text, const TargetCorrection& correction, const io::GcodeOptions& options) {
  std::istringstream stream(text);
  Filtered result;
  const io::TextSink sink = [&result](std::string_view piece) { result.text += piece; };
  result.summary = io::filter_gcode({"part.ngc", stream}, sink, correction, options);
  return result;
}

Filtered filtered_table(const std::string& text, const TargetCorrection& correction) {
  std::istringstream stream(text);
  Filtered result;
  const io::TextSink sink = [&result](std::string_view piece) { result.text += piece; };
  result.summary = io::filter_pose_table({"targets.csv", stream}, sink, correction);
  return result;
}

std::optional<double> word(std::string_view line, char letter) {
  const std::size_t at = line.find(letter);
  return at == std::string_view::npos ? std::nullopt : std::optional(std::strtod(line.data() + at + 1, nullptr));
}

}  // namespace paracal::test

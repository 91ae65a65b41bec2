#include "export_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <optional>

#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/spool.hpp"
#include "paracal/io/target_filter.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::app {
namespace {

void require_finite(const char* option, const std::vector<double>& numbers) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) throw WrongUsage(fmt::format("{}: expected finite numbers, got {}", option, number));
  }
}

io::GcodeFrame frame_of(const FilterOptions& options, const Robot& robot) {
  require_finite("--origin", options.origin);
  require_finite("--start", options.start);
  io::GcodeFrame frame{.origin = robot.controller_origin()};
  if (const auto& r = options.origin; !r.empty()) frame.origin = {r[0], r[1], r[2]};
  if (const auto& r = options.start; !r.empty()) {
    frame.start = Pose{{r[0], r[1], r[2]}, r.size() > 3 ? to_radians(r[3]) : 0.0};
  }
  return frame;
}

/// What the controller must be told for some poses, to try the chain of program, post-processor and controller.
struct TargetTest {
  SelfTestCase wanted;
  Pose target;
};

std::vector<TargetTest> target_tests(const TargetCorrection& correction) {
  std::vector<TargetTest> tests;
  for (const SelfTestCase& wanted : self_test(correction.robot(), correction.compensator().parameters())) {
    if (const std::optional<Pose> target = correction.target(wanted.pose)) tests.push_back({wanted, *target});
  }
  return tests;
}

io::Json tests_json(const std::vector<TargetTest>& tests, Actuator actuator) {
  io::Json json = io::Json::array();
  for (const auto& [wanted, target] : tests) {
    io::Json one = io::to_json(wanted, actuator);
    one["target"] = io::to_json(target);
    json.push_back(one);
  }
  return json;
}

std::vector<std::string> header_lines(const Robot& robot, const ExportOrigin& origin,
                                      const std::vector<TargetTest>& tests) {
  std::vector<std::string> lines{
      fmt::format("corrected targets by paracal {}: do not correct again", version()),
      fmt::format("robot {}", harmless(robot.name())),
      fmt::format("calibration {}", harmless(origin.calibration)),
      fmt::format("SHA-256 {}", origin.sha256),
      fmt::format("date {}", origin.date),
      "self-test in mm and deg, robot frame: x y z phi wanted = told to the controller",
  };
  const auto text = [](const Pose& pose) {
    const Eigen::Vector3d& r = pose.position;
    return fmt::format("{:.4f} {:.4f} {:.4f} {:.5f}", r.x(), r.y(), r.z(), to_degrees(pose.rotation));
  };
  for (const auto& [wanted, target] : tests) lines.push_back(text(wanted.pose) + " = " + text(target));
  return lines;
}

/// Puts comment lines before the first line; behind a byte-order mark or a line of G-code that only holds %.
class HeaderSink {
 public:
  HeaderSink(io::TextSink out, std::string_view comment, std::vector<std::string> lines)
      : out_(std::move(out)), comment_(comment), lines_(std::move(lines)) {}

  void operator()(std::string_view text) {
    if (!lines_.empty()) {
      const std::size_t first_end = std::min(text.find('\n'), text.size());
      const std::string_view line_end = text.substr(0, first_end).ends_with('\r') ? "\r\n" : "\n";
      const std::size_t kept = text.starts_with(io::kByteOrderMark) ? io::kByteOrderMark.size()
                               : text.starts_with('%')              ? std::min(first_end + 1, text.size())
                                                                    : 0;
      out_(text.substr(0, kept));
      text.remove_prefix(kept);
      for (const std::string& line : lines_) out_(fmt::format("{} {}{}", comment_, line, line_end));
      lines_.clear();
    }
    out_(text);
  }

 private:
  io::TextSink out_;
  std::string_view comment_;
  std::vector<std::string> lines_;
};

std::string summary_text(const std::string& name, const io::FilterSummary& summary) {
  std::string text = fmt::format("{}: {} lines, {} targets corrected\n", name, summary.lines, summary.corrected);
  for (const io::PassedThrough& one : summary.passed) {
    text += fmt::format("  passed through: {} ({} times, first in line {})\n", one.reason, one.count, one.first_line);
  }
  return text;
}

/// A program of which some targets are corrected and others between them are not is worse than either: where one meets
/// the other the plate jumps by the correction.
/// @throws InputFileError with the first line that cannot be corrected.
void require_whole(const std::string& name, const io::FilterSummary& summary) {
  if (summary.whole()) return;
  std::vector<io::PassedThrough> between = summary.passed;
  std::erase_if(between, [](const io::PassedThrough& one) { return one.between == 0; });
  std::ranges::sort(between, {}, &io::PassedThrough::first_between);
  std::string others;
  for (std::size_t k = 1; k < between.size(); ++k) {
    others += fmt::format("; line {}: {} ({} times)", between[k].first_between, between[k].reason, between[k].between);
  }
  const io::PassedThrough& first = between.front();
  const auto line = static_cast<int>(std::min<std::int64_t>(first.first_between, std::numeric_limits<int>::max()));
  throw InputFileError(name, line,
                       fmt::format("expected targets that can all be corrected, got {} ({} times) between targets that "
                                   "can{}; nothing was written; --partial corrects {} targets and leaves these",
                                   first.reason, first.between, others, summary.corrected));
}

}  // namespace

void filter_file(const std::string& target, const FilterOptions& options, const Robot& robot,
                 const SourceErrors& errors, const ExportOrigin& origin, Session& session) {
  if (session.json() && session.out().empty()) {
    throw WrongUsage("expected --out FILE with --json: standard output has room for one of both");
  }
  const bool is_gcode = target == "gcode";
  if (!is_gcode && !(options.origin.empty() && options.start.empty())) {
    throw WrongUsage("--origin and --start: expected with --target gcode alone");
  }
  const io::GcodeFrame frame = frame_of(options, robot);
  const TargetCorrection correction(robot, errors);
  const std::vector<TargetTest> tests = target_tests(correction);

  const bool is_standard_input = options.input.empty() || options.input == "-";
  std::ios::sync_with_stdio(false);  // else std::cin takes a read error for the end
  std::ifstream file;
  if (!is_standard_input) file = io::open_file(options.input);
  const io::TextStream in{is_standard_input ? "standard input" : options.input,
                          is_standard_input ? std::cin : static_cast<std::istream&>(file)};
  io::Spool spool;
  io::TextSink sink = [&spool](std::string_view text) { spool.write(text); };
  if (options.partial) sink = session.result_sink();
  if (options.header) sink = HeaderSink(sink, is_gcode ? ";" : "#", header_lines(robot, origin, tests));

  const io::FilterSummary summary = is_gcode ? io::filter_gcode(in, sink, correction, frame, session.threads())
                                             : io::filter_pose_table(in, sink, correction, session.threads());
  if (!options.partial) {
    require_whole(in.name, summary);
    spool.read(session.result_sink());
  }
  if (session.json()) {
    io::Json json{{"target", target}, {"input", in.name}};
    json.update(io::to_json(robot, origin));
    json.update(io::to_json(summary));
    json["origin_mm"] = {frame.origin.x(), frame.origin.y(), frame.origin.z()};
    json["self_test"] = tests_json(tests, robot.actuator());
    print_summary(json_text(json));
  } else {
    session.say_when_done(summary_text(in.name, summary));
  }
  if (!summary.complete()) session.exit_code = kVerdictIsNo;
}

}  // namespace paracal::app

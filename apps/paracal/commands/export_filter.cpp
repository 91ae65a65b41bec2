#include "export_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/spool.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::app {
namespace {

void require_finite(const char* option, const std::vector<double>& numbers) {
  for (const double number : numbers) {
    if (!std::isfinite(number)) throw WrongUsage(fmt::format("{}: expected finite numbers, got {}", option, number));
  }
}

/// Of --start: x, y, z and phi, or the tilts of the plate.
Pose start_pose(const std::vector<double>& numbers, const Robot& robot) {
  const bool tilts = robot.commands_tilt();
  if (numbers.size() != 3 && numbers.size() != (tilts ? 6 : 4)) {
    throw WrongUsage(fmt::format("--start: expected X,Y,Z or X,Y,Z,{} for {}, got {} numbers", tilts ? "A,B,C" : "PHI",
                                 robot.name(), numbers.size()));
  }
  Pose start{{numbers[0], numbers[1], numbers[2]}};
  if (numbers.size() == 4) start.rotation = to_radians(numbers[3]);
  if (numbers.size() == 6) start.tilt = {to_radians(numbers[3]), to_radians(numbers[4]), to_radians(numbers[5])};
  return start;
}

io::GcodeOptions gcode_options(const FilterOptions& options, const Robot& robot) {
  require_finite("--origin", options.origin);
  require_finite("--start", options.start);
  io::GcodeOptions gcode{.origin = robot.controller_origin()};
  if (const auto& r = options.origin; !r.empty()) gcode.origin = {r[0], r[1], r[2]};
  if (!options.start.empty()) gcode.start = start_pose(options.start, robot);
  if (options.chord_mm) gcode.chord = *options.chord_mm;
  gcode.harmless = options.harmless;
  if (!options.harmless_words.empty()) {
    for (std::string& word : io::read_harmless_words(io::read_file(options.harmless_words))) {
      gcode.harmless.push_back(std::move(word));
    }
  }
  gcode.dialect = options.dialect.value_or(io::GcodeDialect::any);
  if (!options.work_offsets.empty()) gcode.offsets = io::read_work_offsets(io::read_file(options.work_offsets));
  if (!options.tools.empty()) gcode.tools = io::read_tool_table(io::read_file(options.tools));
  return gcode;
}

/// @throws WrongUsage for options that contradict each other.
void check_options(const FilterOptions& options, bool is_gcode, const Session& session) {
  if (options.check && (options.partial || options.header || options.in_place)) {
    throw WrongUsage("--check: expected without --partial, --header and --in-place: it writes no text");
  }
  if (options.in_place && (options.input.empty() || options.input == "-" || !session.out().empty())) {
    throw WrongUsage("--in-place: expected with --input FILE and without --out");
  }
  if (options.chord_mm && !(*options.chord_mm > 0.0 && std::isfinite(*options.chord_mm))) {
    throw WrongUsage(fmt::format("--chord-mm: expected a length above 0, got {}", *options.chord_mm));
  }
  if (session.json() && session.out().empty() && !options.check && !options.in_place) {
    throw WrongUsage("expected --out FILE with --json: standard output cannot hold both");
  }
  if (!is_gcode && !options.is_of_tables()) {
    throw WrongUsage(
        "--origin, --start, --chord-mm, --dialect, --work-offsets, --tools, --harmless and --harmless-words: expected "
        "only with --target gcode");
  }
}

/// What the controller must be told for some poses, to try the chain of program, post-processor and controller.
struct TargetTest {
  SelfTestCase wanted;
  Pose target;
};

std::vector<TargetTest> target_tests(const TargetCorrection& correction) {
  std::vector<TargetTest> tests;
  for (const SelfTestCase& wanted : self_test(correction.robot(), correction.machine())) {
    if (const std::optional<Pose> target = correction.target(wanted.pose)) tests.push_back({wanted, *target});
  }
  return tests;
}

io::Json tests_json(const std::vector<TargetTest>& tests, const Robot& robot) {
  return io::json_array(tests, [&](const TargetTest& test) {
    io::Json json = io::to_json(test.wanted, robot.actuator(), robot.commands_tilt());
    json["target"] = io::to_json(test.target, robot.commands_tilt());
    return json;
  });
}

/// phi, or the tilts of a plate that tilts, rad.
std::vector<double> turns_of(const Pose& pose, bool tilts) {
  return tilts ? std::vector{pose.tilt.x(), pose.tilt.y(), pose.tilt.z()} : std::vector{pose.rotation};
}

std::vector<std::string> header_lines(const Robot& robot, const ExportOrigin& origin,
                                      const std::vector<TargetTest>& tests) {
  std::vector<std::string> lines{
      fmt::format("targets corrected by paracal {}: do not correct again", version()),
      fmt::format("robot {}", harmless(robot.name())),
      fmt::format("calibration {}", harmless(origin.calibration)),
      fmt::format("SHA-256 {}", origin.sha256),
      fmt::format("date {}", origin.date),
      fmt::format("self-test in mm and deg, robot frame: x y z {} commanded = sent to the controller",
                  robot.commands_tilt() ? "tilt_x tilt_y tilt_z" : "phi"),
  };
  const auto text = [&](const Pose& pose) {
    const Eigen::Vector3d& r = pose.position;
    std::string numbers = fmt::format("{:.4f} {:.4f} {:.4f}", r.x(), r.y(), r.z());
    for (const double turn : turns_of(pose, robot.commands_tilt())) numbers += fmt::format(" {:.5f}", to_degrees(turn));
    return numbers;
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

io::Json passed_json(const io::PassedThrough& one) {
  return {{"reason", one.reason}, {"count", one.count}, {"first_line", one.first_line}, {"between", one.between}};
}

io::Json target_json(const io::CorrectedTarget& one, bool tilts) {
  return {{"line", one.line},
          {"wanted", io::to_json(one.wanted, tilts)},
          {"target", io::to_json(one.target, tilts)},
          {"distance_mm", one.distance()}};
}

io::Json summary_json(const io::FilterSummary& summary, const Robot& robot) {
  const auto farthest_json = [&](const io::CorrectedTarget& one) { return target_json(one, robot.commands_tilt()); };
  return {{"lines", summary.lines},
          {"corrected", summary.corrected},
          {"lines_added", summary.added},
          {"passed", io::json_array(summary.passed, passed_json)},
          {"outside_workspace", {{"count", summary.outside}, {"first_line", summary.first_outside}}},
          {"farthest", io::json_array(summary.farthest, farthest_json)},
          {"joints_over_limit", {{"count", summary.over_limit}, {"first_line", summary.first_over_limit}}},
          {"assumed", summary.assumed}};
}

/// Of a program that is corrected in parts all the same.
std::string parts_text(const io::FilterSummary& summary) {
  std::int64_t count = 0, first = std::numeric_limits<std::int64_t>::max();
  for (const io::PassedThrough& one : summary.passed) {
    count += one.between;
    if (one.between > 0) first = std::min(first, one.first_between);
  }
  if (count == 0) return {};
  return fmt::format(
      "  partly corrected: {} working lines, the first in line {}, are unchanged; there the machine moves without "
      "correction\n",
      count, first);
}

std::string summary_text(const std::string& name, const io::FilterSummary& summary) {
  std::string text = fmt::format("{}: {} lines, {} targets corrected\n", name, summary.lines, summary.corrected);
  if (summary.added > 0) {
    text += fmt::format("  {} lines added for arcs, divided lines and feeds\n", summary.added);
  }
  for (const std::string& one : summary.assumed) text += fmt::format("  assumed: {}\n", one);
  if (summary.outside > 0) {
    text += fmt::format("  {} targets outside the workspace, first in line {}: check --origin\n", summary.outside,
                        summary.first_outside);
  }
  if (summary.over_limit > 0) {
    text += fmt::format("  warning: {} blocks exceed a limit of [joints], first in line {}: lower F there\n",
                        summary.over_limit, summary.first_over_limit);
  }
  for (const io::PassedThrough& one : summary.passed) {
    text += fmt::format("  unchanged: {} ({} times, first in line {})\n", one.reason, one.count, one.first_line);
  }
  return text;
}

std::string farthest_text(const io::FilterSummary& summary, bool tilts) {
  std::string text = "largest corrections, robot frame, mm and deg:\n    line";
  for (const char* sent : {"", "sent "}) {
    for (const char* name : {"x", "y", "z"}) text += fmt::format(" {:>10}", std::string(sent) + name);
    for (const char* name : tilts ? std::vector{"A", "B", "C"} : std::vector{"phi"}) {
      text += fmt::format(" {:>9}", std::string(sent) + name);
    }
  }
  text += "    moved\n";
  for (const io::CorrectedTarget& one : summary.farthest) {
    text += fmt::format("{:>8}", one.line);
    for (const Pose& pose : {one.wanted, one.target}) {
      for (const double place : pose.position) text += fmt::format(" {:>10.4f}", place);
      for (const double turn : turns_of(pose, tilts)) text += fmt::format(" {:>9.4f}", to_degrees(turn));
    }
    text += fmt::format(" {:>8.4f}\n", one.distance());
  }
  return text;
}

/// A program of which some targets are corrected and others are not is worse than either: where one meets the other the
/// plate jumps by the correction. One without any would be handed out as it came.
bool is_refused(const io::FilterSummary& summary) {
  return !summary.whole() || (summary.corrected == 0 && !summary.complete());
}

/// @throws InputFileError with the first line that cannot be corrected.
void require_whole(const std::string& name, const io::FilterSummary& summary) {
  if (!is_refused(summary)) return;
  const bool is_between = !summary.whole() && summary.corrected > 0;
  std::vector<io::PassedThrough> hindrances = summary.passed;
  if (is_between) std::erase_if(hindrances, [](const io::PassedThrough& one) { return one.between == 0; });
  const auto count = [&](const io::PassedThrough& one) { return is_between ? one.between : one.count; };
  const auto line = [&](const io::PassedThrough& one) { return is_between ? one.first_between : one.first_line; };
  std::ranges::sort(hindrances, {}, line);
  std::string others;
  for (std::size_t k = 1; k < hindrances.size(); ++k) {
    others += fmt::format("; line {}: {} ({} times)", line(hindrances[k]), hindrances[k].reason, count(hindrances[k]));
  }
  const io::PassedThrough& first = hindrances.front();
  const auto first_line = static_cast<int>(std::min<std::int64_t>(line(first), std::numeric_limits<int>::max()));
  throw InputFileError(
      name, first_line,
      fmt::format("expected targets that can all be corrected, got {} ({} times){}{}; nothing was written; --partial "
                  "corrects {} targets and leaves the others unchanged",
                  first.reason, count(first), is_between ? " between corrected targets" : "", others,
                  summary.corrected));
}

std::string checked_text(const std::string& name, const io::FilterSummary& summary, const Robot& robot) {
  std::string text = summary_text(name, summary);
  if (is_refused(summary)) {
    text += "without --partial this file is refused, because not every working target can be corrected\n";
  }
  return summary.farthest.empty() ? text : text + farthest_text(summary, robot.commands_tilt());
}

}  // namespace

void filter_file(const std::string& target, const FilterOptions& options, const TargetCorrection& correction,
                 const ExportOrigin& origin, Session& session) {
  const Robot& robot = correction.robot();
  const bool is_gcode = target == "gcode";
  check_options(options, is_gcode, session);
  io::GcodeOptions gcode = gcode_options(options, robot);
  gcode.threads = session.threads();
  const std::vector<TargetTest> tests = target_tests(correction);

  const bool is_standard_input = options.input.empty() || options.input == "-";
  std::ios::sync_with_stdio(false);  // else std::cin takes a read error for the end
  std::unique_ptr<std::istream> file;
  if (!is_standard_input) file = io::open_file(options.input);
  const io::TextStream in{is_standard_input ? "standard input" : options.input, is_standard_input ? std::cin : *file};
  io::Spool spool;
  io::TextSink sink = [&spool](std::string_view text) { spool.write(text); };
  const std::string read_hash = options.in_place ? io::sha256_of_file(options.input) : "";
  const auto result_sink = [&] {
    if (!options.in_place) return session.result_sink();
    return session.outputs.store.begin(options.input, {.sha256 = read_hash});
  };
  if (options.partial) sink = result_sink();
  if (options.check) sink = [](std::string_view) {};
  if (options.header) sink = HeaderSink(sink, is_gcode ? ";" : "#", header_lines(robot, origin, tests));

  const io::FilterSummary summary = is_gcode ? io::filter_gcode(in, sink, correction, gcode)
                                             : io::filter_pose_table(in, sink, correction, session.threads());
  if (!options.partial && !options.check) {
    require_whole(in.name, summary);
    spool.read(result_sink());
  }
  io::Json json{{"target", target}, {"input", in.name}};
  json.update(io::to_json(robot, origin));
  json.update(summary_json(summary, robot));
  json["refused"] = is_refused(summary);
  json["origin_mm"] = {gcode.origin.x(), gcode.origin.y(), gcode.origin.z()};
  json["self_test"] = tests_json(tests, robot);
  if (options.check) {
    session.json() ? session.print_json(json) : session.print(checked_text(in.name, summary, robot));
  } else if (session.json()) {
    session.print_summary(json_text(json));
  } else {
    session.say_when_done(summary_text(in.name, summary) + parts_text(summary));
  }
  // A slicer takes anything but 0 for a failure.
  const bool is_done = summary.complete() || (options.in_place && summary.whole());
  if (!is_done) session.exit_code = kVerdictIsNo;
}

}  // namespace paracal::app

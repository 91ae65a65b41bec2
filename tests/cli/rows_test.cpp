// Tables of any length through inverse, forward and compensate: row by row, in memory that does not grow, to the same
// result as in one piece, or to none.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "json_checks.hpp"
#include "support/places.hpp"

namespace paracal::test::rows_test {
namespace {

using nlohmann::json, nlohmann::ordered_json;
using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::StartsWith;

/// Points on a spiral that every machine reaches.
std::string path(int rows) {
  std::string text = "x_mm,y_mm,z_mm,phi_deg\n";
  for (int k = 0; k < rows; ++k) {
    const double angle = 1e-3 * k, radius = 300.0 * k / rows;
    fmt::format_to(std::back_inserter(text), "{:.12f},{:.12f},{:.12f},{:.9f}\n", radius * std::cos(angle),
                   radius * std::sin(angle), -900.0 + 50.0 * std::sin(0.1 * angle), 60.0 * std::cos(angle));
  }
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

const std::string kInverse = "inverse --poses poses.csv", kForward = "forward --joints joints.csv",
                  kCompensate = "compensate --calibration calibration.json --poses poses.csv";

/// A calibration that states its covariance, and tables longer than what is read, held in memory or printed at once.
class Rows : public testing::Test {
 protected:
  static constexpr int kRows = 20'000;

  void SetUp() override {
    folder.write("poses.csv", path(kRows));
    folder.make({"poses --stage fine --out plan.csv",
                 "simulate --poses plan.csv --noise-mm 0.01 --frame random --out points.csv",
                 "calibrate --measurements points.csv --out calibration.json", kInverse + " --out joints.csv"});
  }

  std::string done(const std::string& command) const {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    EXPECT_THAT(result.err, IsEmpty()) << command;
    return result.out;
  }

  /// A file as it is, with another text for one of its lines, from 1.
  std::string with_line(const std::string& name, std::size_t number, const std::string& text) const {
    std::string all;
    std::size_t count = 0;
    for (const std::string& line : lines_of(folder.read(name))) all += (++count == number ? text : line) + "\n";
    return all;
  }

  const TemporaryFolder folder;
};

/// One object, as its writer in one piece writes it; and the same rows, line by line.
TEST_F(Rows, JsonLinesAreTheRowsOfTheObject) {
  const ordered_json inverse = ordered_json::parse(done(kInverse + " --json"));
  EXPECT_TRUE(done(kInverse + " --json") == inverse.dump(2) + "\n");
  const std::vector<std::string> joints = lines_of(done(kInverse + " --json-lines"));
  ASSERT_EQ(joints.size(), kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    const json row = json::parse(joints[k]),
               expected{{"name", inverse["names"][k]}, {"joints_deg", inverse["joints_deg"][k]}};
    ASSERT_EQ(row, expected) << k;
  }
  const ordered_json forward = ordered_json::parse(done(kForward + " --json"));
  EXPECT_TRUE(done(kForward + " --json") == forward.dump(2) + "\n");
  std::string poses;
  for (const ordered_json& pose : forward["poses"]) poses += pose.dump() + "\n";
  EXPECT_TRUE(done(kForward + " --json-lines") == poses);
}

TEST_F(Rows, JsonLinesOfCompensateAreTheRowsOfTheObject) {
  const std::string text = done(kCompensate + " --json");
  const ordered_json object = ordered_json::parse(text);
  EXPECT_TRUE(text == object.dump(2) + "\n");
  EXPECT_EQ(object["way"], "exact");
  const std::vector<std::string> lines = lines_of(done(kCompensate + " --json-lines"));
  ASSERT_EQ(lines.size(), kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    const json row = json::parse(lines[k]), expected{{"name", object["names"][k]},
                                                     {"joints_deg", object["joints_deg"][k]},
                                                     {"target", object["targets"][k]},
                                                     {"remaining_tilt", object["remaining_tilt"][k]},
                                                     {"uncertainty", object["uncertainty"][k]}};
    ASSERT_EQ(row, expected) << k;
    ASSERT_TRUE(row["uncertainty"].is_object());
  }
}

/// The table says what the object says, and its first line is of all rows.
TEST_F(Rows, TablesSayTheSame) {
  const json object = json::parse(done(kCompensate + " --json"));
  for (const char* const options : {"", " --targets"}) {
    const std::string table = done(kCompensate + options);
    EXPECT_THAT(
        table, AllOf(StartsWith("# largest U (k = 2, 95 %) of these poses in the robot's frame: x "),
                     HasSubstr(*options == '\0' ? "\npose,q1_deg,q2_deg,q3_deg,q4_deg\n1,"
                                                : "\npose,x_mm,y_mm,z_mm,phi_deg,U_x_mm,U_y_mm,U_z_mm,U_phi_deg\n1,")));
    const std::vector<std::string> lines = lines_of(table);
    const std::size_t above = *options == '\0' ? 6 : 2;  // what joints depend on, U and the header
    ASSERT_EQ(lines.size(), kRows + above);
    for (std::size_t k = 0; k < kRows; ++k) {
      const json &joints = object["joints_deg"][k], &target = object["targets"][k];
      const auto [a, b, c, d] = *options == '\0'
                                    ? std::array{joints[0], joints[1], joints[2], joints[3]}
                                    : std::array{target["x_mm"], target["y_mm"], target["z_mm"], target["phi_deg"]};
      std::string expected =
          fmt::format("{},{},{},{},{}", k + 1, a.get<double>(), b.get<double>(), c.get<double>(), d.get<double>());
      if (*options != '\0') {
        const json& U = object["uncertainty"][k];
        for (const json& one : U["U_mm"]) expected += fmt::format(",{:.3g}", one.get<double>());
        expected += fmt::format(",{:.3g}", U["U_deg"].get<double>());
      }
      ASSERT_EQ(lines[k + above], expected);
    }
    double largest = 0.0;
    for (const json& one : object["uncertainty"]) largest = std::max(largest, one["U_mm"][0].get<double>());
    EXPECT_THAT(lines[0], HasSubstr(fmt::format("robot's frame: x {:.2g},", largest)));
    ASSERT_EQ(folder.run(kCompensate + options + " --out out.csv").exit_code, kDone);
    EXPECT_TRUE(folder.read("out.csv") == table);
  }
}

TEST_F(Rows, OneOfBothKindsOfJson) {
  const ProgramResult result = folder.run(kInverse + " --json --json-lines");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--json-lines"), HasSubstr("--json")));
}

/// An error far behind what was written already.
TEST_F(Rows, ALateErrorLeavesNoOutput) {
  const std::size_t late = kRows - 1;
  folder.write("text.csv", with_line("poses.csv", late, "1,2,low,0"));
  folder.write("far.csv", with_line("poses.csv", late, "1,2,-9000,0"));
  folder.write("joints_text.csv", with_line("joints.csv", late, "x,1,2,3,four"));
  folder.write("robot.csv", with_line("poses.csv", late, "# robot: rotary_delta"));
  folder.write("long.csv", with_line("poses.csv", late, std::string(70'000, '1')));
  folder.write("out", "earlier");
  const auto before = folder.names();
  const std::string of_calibration = "compensate --calibration calibration.json --poses ";
  const std::vector<std::string> kinds{"", " --json", " --json-lines"};
  std::size_t next = 0;  // each of them in turn, all with every_machine()
  for (const auto& [command, exit_code, message] : std::vector<std::tuple<std::string, int, std::string>>{
           {"inverse --poses text.csv", kBadInputFile, fmt::format("text.csv:{}: ", late)},
           {of_calibration + "text.csv", kBadInputFile, fmt::format("text.csv:{}: ", late)},
           {"forward --joints joints_text.csv", kBadInputFile, fmt::format("joints_text.csv:{}: ", late)},
           {"inverse --poses far.csv", kMathematicsSaysNo, fmt::format("pose {} at (1, 2, -9000) mm", late - 1)},
           {of_calibration + "far.csv", kMathematicsSaysNo, fmt::format("pose {} at (1, 2, -9000) mm", late - 1)},
           {"inverse --poses robot.csv", kBadInputFile,
            fmt::format("robot.csv:{}: expected the robot of --robot", late)},
           {of_calibration + "long.csv", kBadInputFile, fmt::format("long.csv:{}: expected lines of at most", late)}}) {
    const std::string& turn = kinds[next++ % kinds.size()];
    for (const std::string& kind : kinds) {
      if (!every_machine() && kind != turn) continue;
      const ProgramResult result = folder.run(command + kind + " --out out");
      EXPECT_EQ(result.exit_code, exit_code) << command << kind;
      EXPECT_THAT(result.err, HasSubstr(message)) << command << kind;
      EXPECT_THAT(result.out, IsEmpty()) << command << kind;
      EXPECT_EQ(folder.names(), before) << command << kind;
      EXPECT_EQ(folder.read("out"), "earlier") << command << kind;
    }
    // Standard output has nothing of what is one object, or begins with a line about all rows;
    EXPECT_THAT(folder.run(command + " --json").out, IsEmpty()) << command;
  }
  EXPECT_THAT(folder.run(of_calibration + "text.csv").out, IsEmpty());
  // of other tables, rows that came before.
  const std::string passed_on = folder.run("inverse --poses text.csv").out;
  EXPECT_GE(passed_on.size(), 1u << 20);
  EXPECT_TRUE(done(kInverse).starts_with(passed_on));
}

TEST_F(Rows, APipeIsReadAsItComes) {
  const Surroundings pipe{.folder = folder.path(), .launcher = {"/bin/sh", "-c", "cat poses.csv | \"$0\" \"$@\""}};
  for (const std::string& command : {kInverse, kCompensate + " --json", kCompensate + " --targets --json-lines"}) {
    std::string piped = command;
    piped.replace(piped.find("poses.csv"), 9, "/dev/stdin");
    EXPECT_TRUE(run_program(of_huang2016(piped), pipe).out == done(command)) << command;
  }
}

/// What waits for the last row and is too long for memory waits in the folder for temporary files.
TEST_F(Rows, WhatWaitsWantsTheTemporaryFolder) {
  const auto run = [&](const std::string& command) {
    return run_program(of_huang2016(command), {.folder = folder.path(), .environment = {"TMPDIR=/nowhere"}});
  };
  const auto before = folder.names();
  const ProgramResult refused = run(kCompensate + " --out out.csv");
  EXPECT_EQ(refused.exit_code, kWrongUsage);
  EXPECT_THAT(refused.err, HasSubstr("/nowhere: cannot be written: No such file or directory"));
  EXPECT_EQ(folder.names(), before);
  EXPECT_EQ(run(kInverse).exit_code, kDone);  // nothing waits
  folder.write("poses.csv", path(100));
  EXPECT_EQ(run(kCompensate + " --json").exit_code, kDone);
}

/// What all programs that were run have taken of the processor, s: it does not depend on who else is busy.
double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// 1 GiB in a line, or in a table that another command holds as a whole.
TEST_F(Rows, TooMuchIsRefusedAtOnce) {
  folder.write("huge.csv", "x_mm,y_mm,z_mm\n");
  std::filesystem::resize_file(folder.path() / "huge.csv", std::size_t{1} << 30);  // wants no room on the disk
  for (const std::string command : {"inverse --poses huge.csv", "forward --joints huge.csv",
                                    "compensate --calibration calibration.json --poses huge.csv --json",
                                    "simulate --poses huge.csv", "calibrate --measurements huge.csv"}) {
    const double before = processor_time();
    const ProgramResult result = folder.run(command);
    EXPECT_LT(processor_time() - before, 4.0) << command;  // 1.5 where it was measured
    EXPECT_EQ(result.exit_code, kBadInputFile) << command;
    EXPECT_THAT(result.err, testing::ContainsRegex("huge.csv(:2)?: expected .*at most (64 K|128 M)iB")) << command;
  }
}

/// Memory beyond that of a program that does nothing, MiB. In one piece these tables took 30 to 135.
TEST_F(Rows, MemoryDoesNotGrow) {
  constexpr double kMost = 16.0;
  const auto peak = [&](const std::string& command) {
    const std::string file = folder.path() / "peak";
    const ProgramResult result =
        run_program(of_huang2016(command), {.folder = folder.path(),
                                            .environment = {"ASAN_OPTIONS=quarantine_size_mb=1"},
                                            .launcher = {build_folder() / "tests/cli/paracal-peak-memory", file}});
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    return std::stod(read_text(file)) / 1024.0;
  };
  const double nothing = peak("robot --list");
  folder.write("poses.csv", path(50'000));
  ASSERT_EQ(folder.run(kInverse + " --out joints.csv").exit_code, kDone);
  for (const std::string& command : {kInverse, kInverse + " --json", kForward, kForward + " --json-lines", kCompensate,
                                     kCompensate + " --json", kCompensate + " --json-lines"}) {
    EXPECT_LT(peak(command + " --out out") - nothing, kMost) << command;
  }
}

}  // namespace
}  // namespace paracal::test::rows_test

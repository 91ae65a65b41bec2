// The same plan and the same readings as other programs write them: every command says the same of them.

#include <algorithm>

#include "json_checks.hpp"

namespace paracal::test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::Contains, testing::HasSubstr, testing::StartsWith;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines{""};
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  lines.pop_back();
  return lines;
}

std::string with_other(std::string text, char one, char other) {
  std::ranges::replace(text, one, other);
  return text;
}

/// A table, comments as they are, its lines rewritten.
template <typename Rewrite>
std::string rewritten(const std::string& table, const Rewrite& rewrite) {
  std::string text;
  for (const std::string& line : lines_of(table)) text += (line.starts_with('#') ? line + ";;" : rewrite(line)) + "\n";
  return text;
}

/// As a spreadsheet with a comma for decimals writes it: semicolons, CRLF, and separators behind the last column and
/// behind comments.
std::string of_spreadsheet(const std::string& table) {
  const auto rewrite = [](const std::string& line) { return with_other(with_other(line, ',', ';'), '.', ',') + ";\r"; };
  return rewritten(table, rewrite) + ";;;;;;;;;;\r\n";
}

std::string of_tabs(const std::string& table) {
  return rewritten(table, [](const std::string& line) { return with_other(line, ',', '\t'); });
}

/// Of text in ASCII.
std::string utf16(const std::string& text) {
  std::string bytes = "\xFF\xFE";
  for (const char c : text) bytes += std::string{c, '\0'};
  return bytes;
}

class Dialects : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(folder.run("poses --optimal 14 --candidates 200 --out plan.csv").exit_code, kDone);
    ASSERT_EQ(folder.run("simulate --poses plan.csv --noise-mm 0.01 --out points.csv").exit_code, kDone);
    plan = folder.read("plan.csv");
    points = folder.read("points.csv");
  }

  json json_of(const std::string& command) const {
    const ProgramResult result = folder.run(command + " --json");
    EXPECT_THAT(result.exit_code, testing::AnyOf(kDone, kVerdictIsNo)) << command << result.err;
    return result.out.empty() ? json() : json::parse(result.out);
  }

  TemporaryFolder folder;
  std::string plan, points;
};

TEST_F(Dialects, CalibrationsAreTheSame) {
  const json expected = json_of("calibrate --measurements points.csv").at("parameters");
  folder.write("sheet.csv", of_spreadsheet(points));
  folder.write("tabs.txt", of_tabs(points));
  folder.write("wide.csv", utf16(of_spreadsheet(points)));
  for (const std::string file : {"sheet.csv", "tabs.txt", "wide.csv"}) {
    EXPECT_EQ(json_of("calibrate --measurements " + file).at("parameters"), expected) << file;
  }
  EXPECT_EQ(json_of("calibrate --decimal-comma --measurements sheet.csv").at("parameters"), expected);
}

TEST_F(Dialects, PosesAndJointsAreTheSame) {
  const std::string joints = folder.run("inverse --poses plan.csv").out;
  folder.write("joints.csv", joints);
  folder.write("sheet.csv", utf16(of_spreadsheet(plan)));
  folder.write("joint_sheet.csv", of_spreadsheet(joints));
  folder.write("errors.toml", "[[limb]]\ntheta_offset_deg = 0.5\n[[limb]]\n[[limb]]\n[[limb]]\n");
  const std::vector<std::pair<std::string, std::string>> commands{
      {"inverse --poses ", "sheet.csv"},
      {"compensate --errors errors.toml --poses ", "sheet.csv"},
      {"identifiability --poses ", "sheet.csv"},
      {"simulate --poses ", "sheet.csv"},
      {"forward --joints ", "joint_sheet.csv"}};
  for (const auto& [command, file] : commands) {
    const ProgramResult expected = folder.run(command + (file == "sheet.csv" ? "plan.csv" : "joints.csv"));
    ASSERT_EQ(expected.exit_code, kDone) << command << expected.err;
    EXPECT_EQ(folder.run(command + file).out, expected.out) << command;
    EXPECT_EQ(folder.run(command + file + " --decimal-comma").out, expected.out) << command;
  }
}

/// In every command that reads tables.
TEST_F(Dialects, ExtraColumnsAreNamedAndIgnoredByRequest) {
  const auto with_operator = [](const std::string& line) { return line + (line.starts_with("pose") ? ",By" : ",NN"); };
  folder.write("more.csv", rewritten(plan, with_operator));
  folder.write("more_points.csv", rewritten(points, with_operator));
  folder.write("errors.toml", "[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n");
  for (const std::string command :
       {"inverse --poses more.csv", "compensate --errors errors.toml --poses more.csv", "simulate --poses more.csv",
        "identifiability --poses more.csv", "calibrate --measurements more_points.csv"}) {
    const ProgramResult refused = folder.run(command);
    EXPECT_EQ(refused.exit_code, kBadInputFile) << command;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("got \"By\""), HasSubstr("--ignore-columns \"By\""))) << command;
    EXPECT_NE(folder.run(command + " --ignore-columns By").exit_code, kBadInputFile) << command;
  }
  EXPECT_THAT(json_of("calibrate --measurements more_points.csv --ignore-columns By").at("notes"),
              Contains("columns passed over, as asked: By"));
}

}  // namespace
}  // namespace paracal::test

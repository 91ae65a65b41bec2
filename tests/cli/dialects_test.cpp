// The same plan and the same readings as other programs write them: every command says the same of them.

#include <algorithm>
#include <sstream>

#include "json_checks.hpp"

namespace paracal::test::dialects_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::Contains, testing::HasSubstr, testing::StartsWith;

/// The text between separators.
std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::istringstream in(text);
  std::vector<std::string> parts;
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

std::string with_other(std::string text, char one, char other) {
  std::ranges::replace(text, one, other);
  return text;
}

/// A table, comments as they are, its lines rewritten.
template <typename Rewrite>
std::string rewritten(const std::string& table, const Rewrite& rewrite) {
  std::string text;
  for (const std::string& line : parts_of(table, '\n'))
    text += (line.starts_with('#') ? line + ";;" : rewrite(line)) + "\n";
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
    folder.make({"poses --optimal 14 --candidates 200 --out plan.csv",
                 "simulate --poses plan.csv --noise-mm 0.01 --out points.csv"});
    plan = folder.read("plan.csv");
    points = folder.read("points.csv");
  }

  json json_of(const std::string& command) const {
    const ProgramResult result = folder.run(command + " --json");
    EXPECT_THAT(result.exit_code, testing::AnyOf(kDone, kVerdictIsNo)) << command << result.err;
    return result.out.empty() ? json() : json::parse(result.out);
  }

  /// "name x y z" of every reading, joined.
  template <typename Join>
  std::string exported(const Join& join) const {
    std::string text;
    for (const std::string& line : parts_of(points, '\n')) {
      if (line.starts_with('#') || line.starts_with("pose")) continue;
      const std::vector<std::string> fields = parts_of(line, ',');
      text += join(fields[0], fields[5], fields[6], fields[7]) + "\n";
    }
    return text;
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

TEST_F(Dialects, ExportsAreTheSame) {
  const json expected = json_of("calibrate --measurements points.csv").at("parameters");
  const auto same = [&](const std::string& text, const std::string& options) {
    folder.write("export.txt", text);
    const json got = json_of("calibrate --poses plan.csv --measurements export.txt" + options);
    EXPECT_EQ(got.at("parameters"), expected) << options << text.substr(0, 100);
    return got.at("notes").dump();
  };
  const auto by = [](const std::string& separator) {
    return [separator](const std::string& name, const std::string& x, const std::string& y, const std::string& z) {
      return name + separator + x + separator + y + separator + z;
    };
  };
  const std::string sheet = with_other(exported(by(";")), '.', ',');
  same("// by a program\n" + exported(by(" ")), " --columns spatialanalyzer --unit mm");
  EXPECT_THAT(same("Report;;;\nName;X [mm];Y [mm];Z [mm]\n" + sheet, ""), HasSubstr("header row in line 2"));
  same(utf16("Point;X [mm];Y [mm];Z [mm]\r\n" + sheet), "");
  const auto nameless = [](const auto&, const std::string& x, const std::string& y, const std::string& z) {
    return x + "\t" + y + "\t" + z;
  };
  EXPECT_THAT(same("x_mm\ty_mm\tz_mm\n" + exported(nameless), " --match order"),
              HasSubstr("14 points are assigned to the 14 poses"));
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
              Contains("columns ignored, as requested: By"));
}

TEST(DialectsOfPrinters, ReadingsTakeTheOptions) {
  const TemporaryFolder folder;
  folder.write("config.g", "M665 R120 L300 B100 H250\nM666 X0 Y0 Z0\n");
  std::string heights = "x_mm;y_mm;z_mm;height_mm;who\n";
  for (const std::string place : {"0;0", "80;0", "-80;0", "0;80", "0;-80", "50;50", "-50;50"}) {
    heights += place + ";0;1,125;NN\n";
  }
  folder.write("heights.csv", heights);
  const std::string command = "calibrate --printer config.g --firmware reprapfirmware --readings heights.csv";
  const ProgramResult unknown = folder.run(words(command)),
                      ambiguous = folder.run(words(command + " --ignore-columns who"));
  EXPECT_THAT(unknown.err, AllOf(StartsWith("paracal: heights.csv:1: "), HasSubstr("\"who\"")));
  EXPECT_THAT(ambiguous.err, AllOf(StartsWith("paracal: heights.csv:2: "), HasSubstr("1.125 or 1125?")));
  const ProgramResult read = folder.run(words(command + " --ignore-columns who --decimal-comma"));
  EXPECT_NE(read.exit_code, kBadInputFile) << read.err;
}

}  // namespace
}  // namespace paracal::test::dialects_test

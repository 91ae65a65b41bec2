#include "paracal/io/csv_stream.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <sstream>

#include "paracal/error.hpp"
#include "paracal/io/tables.hpp"

namespace paracal::io::csv_stream_test {
namespace {

using testing::HasSubstr, testing::StartsWith, testing::ThrowsMessage;

std::vector<Station> streamed_poses(const std::string& text, const std::optional<RobotStatement>& robot = {}) {
  std::istringstream in(text);
  CsvStream table({"p.csv", in});
  if (robot) table.expect(*robot);
  std::vector<Station> stations;
  read_poses(table, {}, [&](const Station& station) { stations.push_back(station); });
  return stations;
}

void refused(const std::string& text, const std::string& message, const std::optional<RobotStatement>& robot = {}) {
  EXPECT_THAT(([&] { (void)streamed_poses(text, robot); }), ThrowsMessage<InputFileError>(HasSubstr(message)));
}

/// More lines than are read at once.
std::string comments() {
  std::string text;
  for (int k = 0; k < 40'000; ++k) text += "# as long as a comment can be and is of use to people\n";
  return text;
}
constexpr int kComments = 40'000;

bool is_same(const Station& one, const Station& other) {
  return one.name == other.name && one.commanded.position == other.commanded.position &&
         one.commanded.rotation == other.commanded.rotation && one.believed == other.believed;
}

/// @returns nothing of what is refused.
template <typename Read>
std::optional<std::vector<Station>> read_by(const Read& read, const std::string& text) {
  try {
    return read(text);
  } catch (const InputFileError&) {
    return std::nullopt;
  }
}

TEST(CsvStream, GivesTheRowsOfTheTable) {
  const bool held = rc::check("streamed as in one piece", [] {
    const auto piece = rc::gen::weightedElement<std::string>({{20, "1,2,3\n"},
                                                              {20, "1,2,3\r\n"},
                                                              {20, "\n"},
                                                              {20, "# no row\n"},
                                                              {20, " -4, +5e1,\"6\" \n"},
                                                              {1, "7,8,nine\n"},
                                                              {1, "7,8\n"},
                                                              {1, "7,8,9"}});
    std::string text = *rc::gen::element<std::string>("", "\xEF\xBB\xBF", "# first\n\n");
    text += "x_mm,y_mm,z_mm\n";
    for (const std::string& line : *rc::gen::container<std::vector<std::string>>(piece)) text += line;
    const auto whole = read_by([](const std::string& all) { return read_poses({"p.csv", all}); }, text);
    const auto rows = read_by([](const std::string& all) { return streamed_poses(all); }, text);
    RC_ASSERT(whole.has_value() == rows.has_value());
    RC_ASSERT((!whole || std::ranges::equal(*whole, *rows, is_same)));  // its own || looks at both sides
  });
  EXPECT_TRUE(held);
}

TEST(CsvStream, JointsAndNamesGoWithTheirRows) {
  const std::string text = "pose,x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg\nA,0,0,-800,10,20,30\nB,0,0,-810,1,2,3\n";
  const auto whole = read_poses({"p.csv", text}), rows = streamed_poses(text);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(std::ranges::equal(whole, rows, is_same));
  std::istringstream in("q1_deg,q2_deg,q3_deg\n1,2,3\n4,5,6\n");
  CsvStream table({"j.csv", in});
  std::vector<std::string> names;
  read_joints(table, 3, [&](const NamedJoints& row) { names.push_back(row.name); });
  EXPECT_THAT(names, testing::ElementsAre("1", "2"));
}

TEST(CsvStream, ComplaintsNameTheLine) {
  const std::string far = comments();
  refused("", "p.csv: expected a header line, got no line");
  refused(far, "p.csv: expected a header line, got no line");
  refused("x_mm,y_mm,z_mm\n# none\n", "p.csv: expected at least one row");
  refused("x_mm,x_mm,z_mm\n", "p.csv:1: expected a header line with every column once");
  refused("x_mm,y_mm,w_mm\n1,2,3\n", "p.csv:1: expected only the columns");
  refused("x_mm,y_mm,z_mm\n" + far + "1,2,3\n1,2\n", fmt::format("p.csv:{}: expected 3 fields", kComments + 3));
  refused("x_mm,y_mm,z_mm\n1,2,3\n" + far + "1,low,3\n",
          fmt::format("p.csv:{}: expected a finite number in column y_mm", kComments + 3));
}

TEST(CsvStream, LinesHaveALength) {
  const std::string longest = "#" + std::string(64 * 1024 - 2, '-') + "\n", header = "x_mm,y_mm,z_mm\n";
  EXPECT_EQ(streamed_poses(header + longest + "1,2,3\n").size(), 1u);
  refused(header + "-" + longest + "1,2,3\n", "p.csv:2: expected lines of at most 64 KiB, got a longer one");
  refused(header + "1,2,3\n#" + longest, "p.csv:3: expected lines of at most 64 KiB");
  refused(header + "1,2," + std::string(3'000'000, '3'), "p.csv:2: expected lines of at most 64 KiB");
}

TEST(CsvStream, SaysItsRobotBeforeItsRows) {
  std::istringstream in("\xEF\xBB\xBF# robot: rotary_delta\nx_mm,y_mm,z_mm\n1,2,3\n");
  CsvStream table({"p.csv", in});
  const auto stated = table.robot();
  ASSERT_TRUE(stated);
  EXPECT_EQ(stated->robot.name(), "rotary_delta");
  EXPECT_EQ(stated->line, 1);
  ASSERT_NE(table.next(), nullptr);  // nothing is lost by looking
  EXPECT_EQ(table.next(), nullptr);
  std::istringstream silent("x_mm,y_mm,z_mm\n" + comments() + "# robot: rotary_delta\n1,2,3\n");
  EXPECT_FALSE(CsvStream({"p.csv", silent}).robot());
}

TEST(CsvStream, EveryRobotIsTheOneExpected) {
  RobotStatement delta = named_robot("rotary_delta");
  const std::string late = "x_mm,y_mm,z_mm\n1,2,3\n" + comments() + "# robot: huang2016\n4,5,6\n";
  refused(late, fmt::format("p.csv:{}: expected the robot of rotary_delta with name", kComments + 3), delta);
  EXPECT_EQ(streamed_poses(late, named_robot("huang2016")).size(), 2u);
  refused("# robot: rotary_delta\n" + late, fmt::format("p.csv:{}: expected the robot of p.csv", kComments + 4));
  refused("# robot: newton\n" + late, "p.csv:1: ");
}

/// Memory for names has an end; what was seen before it is seen again.
TEST(CsvStream, NamesOfTheFirstRowsComeOnce) {
  std::string text = "pose,x_mm,y_mm,z_mm\n";
  for (std::size_t k = 0; k < kNamesCompared; ++k) fmt::format_to(std::back_inserter(text), "P{},1,2,3\n", k);
  refused(text + "P7,1,2,3\n",
          fmt::format("p.csv:{}: expected every pose once, got \"P7\" again (first in line 9)", kNamesCompared + 2));
  refused(text + fmt::format("P{},1,2,3\n", kNamesCompared - 1), "expected every pose once");
  EXPECT_EQ(streamed_poses(text + "late,1,2,3\nlate,1,2,3\n").size(), kNamesCompared + 2);
  EXPECT_THAT(
      [&] {
        (void)read_poses({"p.csv", text + "late,1,2,3\nlate,1,2,3\n"});
      },
      ThrowsMessage<InputFileError>(HasSubstr("got \"late\" again")));
}

TEST(CsvStream, AStreamThatBreaksOffIsNoTable) {
  std::istringstream in("x_mm,y_mm,z_mm\n1,2,3\n");
  in.setstate(std::ios::badbit);
  CsvStream table({"p.csv", in});
  EXPECT_THAT([&] { (void)table.next(); }, ThrowsMessage<InputFileError>(StartsWith("p.csv: cannot be read")));
}

}  // namespace
}  // namespace paracal::io::csv_stream_test

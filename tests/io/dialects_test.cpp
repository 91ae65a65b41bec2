// Tables as other programs write them: one sample a dialect, and what may not be guessed.

#include <gmock/gmock.h>

#include <sstream>

#include "paracal/error.hpp"
#include "paracal/io/csv_stream.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/tables.hpp"

namespace paracal::io::dialects_test {
namespace {

using testing::AllOf, testing::ElementsAre, testing::HasSubstr, testing::Not, testing::StartsWith,
    testing::ThrowsMessage;

const std::string kCommas = "pose,x_mm,y_mm,z_mm\nP1,0.5,-12.25,-888.125\n\"a;b\",1.5,0,-900\n";

std::vector<Station> streamed(const std::string& text, const TableStyle& style = {}) {
  std::istringstream in(text);
  CsvStream table({"p.csv", in, style});
  std::vector<Station> stations;
  read_poses(table, {}, [&](const Station& station) { stations.push_back(station); });
  return stations;
}

/// Whole and row by row.
void reads_as_commas(const std::string& text, const TableStyle& style = {}) {
  const std::vector<Station> expected = read_poses({"p.csv", kCommas});
  for (const std::vector<Station>& got : {read_poses({"p.csv", text, style}), streamed(text, style)}) {
    ASSERT_EQ(got.size(), 2u) << text;
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(got[k].name, expected[k].name) << text;
      EXPECT_EQ(got[k].commanded.position, expected[k].commanded.position) << text;
    }
  }
}

void refused(const std::string& text, const std::string& message, const TableStyle& style = {}) {
  EXPECT_THAT(([&] { (void)read_poses({"p.csv", text, style}); }), ThrowsMessage<InputFileError>(HasSubstr(message)));
  EXPECT_THAT(([&] { (void)streamed(text, style); }), ThrowsMessage<InputFileError>(HasSubstr(message)));
}

TEST(Dialects, OneSampleEach) {
  reads_as_commas(kCommas);
  reads_as_commas("pose;x_mm;y_mm;z_mm\nP1;0.5;-12.25;-888.125\n\"a;b\";1.5;0;-900\n");
  reads_as_commas("pose\tx_mm\ty_mm\tz_mm\nP1\t0.5\t-12.25\t-888.125\na;b\t1.5\t0\t-900\n");
  reads_as_commas("pose;x_mm;y_mm;z_mm\r\nP1;0,5;-12,25;-888,125\r\n\"a;b\";1,5;0;-900\r\n");
  reads_as_commas("pose\tx_mm\ty_mm\tz_mm\nP1\t0,5\t-12,25\t-888,125\na;b\t1,5\t0\t-900\n");
  reads_as_commas("pose,x_mm,y_mm,z_mm\nP1,\"0,5\",\"-12,25\",\"-888,125\"\na;b,\"1,5\",0,-900\n");
  reads_as_commas("pose;x_mm;y_mm;z_mm;;\n;;;;;\nP1;0.5;-12.25;-888.125;;\n\"a;b\";1.5;0;-900;\n;;\n\n \t\n");
  reads_as_commas("\xEF\xBB\xBFpose;x_mm;y_mm;z_mm\nP1;0.5;-12.25;-888.125\n\"a;b\";1.5;0;-900\n");
  reads_as_commas("\t\t\t\npose\tx_mm\ty_mm\tz_mm\t\nP1\t0.5\t-12.25\t-888.125\t\na;b\t1.5\t0\t-900\t\n\t\t\t\t\n");
}

TEST(Dialects, SeparatorsAreOfOneKind) {
  refused("pose,x_mm;y_mm;z_mm\n",
          "p.csv:1: expected one kind of separator in the header line, got commas and semicolons");
  refused("pose\tx_mm,y_mm,z_mm\n", "got tabs and commas");
  refused("pose;x_mm;y_mm;z_mm\nP1,1,2,3\n", "p.csv:2: expected 4 fields as in the header, got 1");
  refused("pose;x_mm;y_mm;z_mm\nP1;1;2;3;4\n", "p.csv:2: expected 4 fields as in the header, got 5");
  refused("pose,x_mm,y_mm,z_mm\nP1,1,5,2,5,3,5\n",
          "got 7 (with decimal commas, separate fields by semicolons or tabs)");
  refused(",,,\n", "expected a header line, got no line");
  refused("x_mm,y_mm,z_mm\n,,\n", "expected at least one row below the header");
  refused("x_mm,,y_mm,z_mm\n1,2,3,4\n", "got \"\"");
}

/// Above or below: the whole table says it, or what of it is read at once.
TEST(Dialects, DecimalCommasAreCertainOrAskedFor) {
  const std::string header = "pose;x_mm;y_mm;z_mm\n", late = "P2;0,5;0;0\n", early = "P1;1,125;2;3\n";
  EXPECT_EQ(read_poses({"p.csv", header + early + late}).at(0).commanded.position.x(), 1.125);
  EXPECT_EQ(streamed(header + early + late).at(0).commanded.position.x(), 1.125);
  refused(header + early,
          "p.csv:2: expected a finite number in column x_mm, got \"1,125\" (1.125 or 1125? For decimal commas add "
          "--decimal-comma");
  refused(header + early + "P2;0.5;0;0\n", "got \"1,125\" (line 3 has a decimal point)");
  refused(header + late + "P1;1.5;2;3\n",
          "p.csv:3: expected a finite number in column x_mm, got \"1.5\" (line 2 has a decimal comma)");
  refused(header + late + "P1;1.234,5;2;3\n", "got \"1.234,5\"");
  refused(header + late + "P1;1,234,567;2;3\n", "got \"1,234,567\"");
  const TableStyle comma{.decimal_comma = true};
  EXPECT_EQ(read_poses({"p.csv", header + early, comma}).at(0).commanded.position.x(), 1.125);
  EXPECT_EQ(streamed(header + early, comma).at(0).commanded.position.x(), 1.125);
  refused(header + "P1;1.5;2;3\n", "(--decimal-comma is given)", comma);
  // Names say nothing of numbers, nor do comments and columns that are passed over.
  refused(header + "\"1,5\";1,125;2;3\n", "1.125 or 1125?");
  refused(header + "# 0;0,5;0;0\n" + early, "1.125 or 1125?");
  refused("pose;x_mm;y_mm;z_mm;RMS\nP1;1,125;2;3;0,5\n", "1.125 or 1125?", {.ignored_columns = {"RMS"}});
}

/// A stream looks as far as it has read; what it cannot know it does not guess.
TEST(Dialects, StreamsLookAheadOnce) {
  std::string far = "pose;x_mm;y_mm;z_mm\nP0;1,125;2;3\n";
  for (int k = 1; k < 40'000; ++k) far += "P" + std::to_string(k) + ";1;2;3\n";
  far += "late;0,5;2;3\n";
  EXPECT_EQ(read_poses({"p.csv", far}).at(0).commanded.position.x(), 1.125);
  EXPECT_THAT([&] { (void)streamed(far); }, ThrowsMessage<InputFileError>(HasSubstr("p.csv:2: ")));
}

TEST(Dialects, ColumnsAreIgnoredByRequestAlone) {
  const std::string text =
      "pose;x_mm;Operator;y_mm;z_mm;T \xB0"
      "C\nP1;1;NN;2;3;20,5\n";
  refused(text,
          "got \"Operator\", \"T \xC2\xB0"
          "C\" (to ignore these: --ignore-columns \"Operator,T \xC2\xB0"
          "C\")");
  const TableStyle style{.ignored_columns = {"Operator",
                                             "T \xC2\xB0"
                                             "C",
                                             "Humidity"}};
  EXPECT_EQ(read_poses({"p.csv", text, style}).at(0).commanded.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(streamed(text, style).at(0).commanded.position, Eigen::Vector3d(1, 2, 3));
  const TableStyle quoted{.ignored_columns = {"T, C"}};
  EXPECT_EQ(read_poses({"p.csv", "x_mm;\"T, C\";y_mm;z_mm\n1;20;2;3\n", quoted}).size(), 1u);
  // A known one is then as if it were not there, and one that comes twice does not matter.
  const std::string points = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm,sigma_mm,n,n\nP1,0,0,-888,1,2,3,0.5,a,b\n";
  const Measurements m = read_points({"m.csv", points, {.ignored_columns = {"sigma_mm", "n"}}});
  EXPECT_FALSE(m.series.at(0).readings.at(0).sigma);
  EXPECT_THAT(m.notes, ElementsAre("columns ignored, as requested: sigma_mm, n, n"));
  refused("x_mm,y_mm,z_mm\n1,2,3\n", "expected a column \"x_mm\", got y_mm, z_mm", {.ignored_columns = {"x_mm"}});
}

TEST(Dialects, MisspeltColumnsAreAnsweredWithWhatWasMeant) {
  refused("pose,x_mm,y_mm,z_m\nP1,1,2,3\n", "got \"z_m\" (did you mean z_mm?)");
  refused("pose,x_mm,y_mm,z_mm,x_cmd_m\nP1,1,2,3,4\n", "got \"x_cmd_m\" (did you mean x_cmd_mm?)");
  EXPECT_THAT(
      [] {
        (void)read_poses({"p.csv", "pose,x_mm,y_mm,z_mm,operator\nP1,1,2,3,NN\n"});
      },
      ThrowsMessage<InputFileError>(Not(HasSubstr("did you mean"))));
}

}  // namespace
}  // namespace paracal::io::dialects_test

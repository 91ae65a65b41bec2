#include "paracal/io/points.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <array>
#include <limits>
#include <string>

#include "paracal/error.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/units.hpp"

namespace paracal::io::points_test {
namespace {

using testing::AllOf, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::StartsWith,
    testing::ThrowsMessage;

const std::string kHeader = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm";

/// A point table without optional columns.
TextFile points(const std::string& rows) { return {"day 1/m.csv", kHeader + "\n" + rows}; }

/// A point table with more columns.
TextFile points(const std::string& columns, const std::string& rows) {
  return {"m.csv", kHeader + "," + columns + "\n" + rows};
}

void expect_refused(const TextFile& file, const std::string& start, const std::string& part = "",
                    std::size_t limb_count = 0) {
  EXPECT_THAT([&] { (void)read_points(file, limb_count); },
              ThrowsMessage<InputFileError>(AllOf(StartsWith(start), HasSubstr(part))));
}

bool same(const PointReading& a, const PointReading& b) {
  return a.station == b.station && a.point == b.point && a.second == b.second && a.rotation == b.rotation &&
         a.sigma == b.sigma && a.orientation == b.orientation && a.orientation_sigma == b.orientation_sigma;
}

bool same(const Station& a, const Station& b) {
  return a.name == b.name && a.commanded.position == b.commanded.position &&
         a.commanded.rotation == b.commanded.rotation && a.believed == b.believed;
}

void expect_same(const Measurements& a, const Measurements& b) {
  ASSERT_EQ(a.stations.size(), b.stations.size());
  for (std::size_t k = 0; k < a.stations.size(); ++k)
    EXPECT_TRUE(same(a.stations[k], b.stations[k])) << "station " << k;
  const auto &of_a = a.series.at(0).readings, &of_b = b.series.at(0).readings;
  ASSERT_EQ(of_a.size(), of_b.size());
  for (std::size_t k = 0; k < of_a.size(); ++k) EXPECT_TRUE(same(of_a[k], of_b[k])) << "reading " << k;
}

TEST(PointTable, IsOneSeriesNamedAfterItsFile) {
  const TextFile file = points("home,0,0,-888,0,1000.5,2,3\nfar,100,0,-888,90,1100,2,3\nhome,0,0,-888,0,1000.4,2,3\n");
  const Measurements m = read_points(file);
  ASSERT_EQ(m.stations.size(), 2u);
  EXPECT_EQ(m.stations[0].name, "home");
  EXPECT_EQ(m.stations[1].commanded.position, Eigen::Vector3d(100, 0, -888));
  EXPECT_EQ(m.stations[1].commanded.rotation, to_radians(90));
  EXPECT_FALSE(m.stations[0].believed);
  ASSERT_EQ(m.series.size(), 1u);
  EXPECT_EQ(m.series[0].name, "m.csv");
  ASSERT_EQ(m.series[0].readings.size(), 3u);
  EXPECT_EQ(m.series[0].readings[2].station, 0u);
  EXPECT_EQ(m.series[0].readings[2].point, Eigen::Vector3d(1000.4, 2, 3));
  EXPECT_FALSE(m.series[0].readings[0].second || m.series[0].readings[0].rotation || m.series[0].readings[0].sigma);
  ASSERT_EQ(m.files.size(), 1u);
  EXPECT_EQ(m.files[0].name, "day 1/m.csv");
  EXPECT_EQ(m.files[0].sha256, sha256(file.text));
  EXPECT_THAT(m.notes, IsEmpty());
}

TEST(PointTable, OptionalColumnsMayBeBlankInARow) {
  const Measurements m = read_points(points("repeat,phi_deg,x2_mm,y2_mm,z2_mm,sigma_mm,q1_deg,q2_deg,q3_deg",
                                            "A,0,0,-888,0,1,2,3,1,30,4,5,6,0.02,10,20,30\n"
                                            "A,0,0,-888,0,1,2,4,2,,,,,,10,20,30\n"));
  ASSERT_EQ(m.stations.size(), 1u);
  ASSERT_TRUE(m.stations[0].believed);
  EXPECT_EQ((*m.stations[0].believed)(2), to_radians(30));
  const auto& readings = m.series[0].readings;
  ASSERT_EQ(readings.size(), 2u);
  EXPECT_EQ(readings[0].rotation, to_radians(30));
  EXPECT_EQ(readings[0].second, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(readings[0].sigma, 0.02);
  EXPECT_FALSE(readings[1].rotation || readings[1].second || readings[1].sigma);
}

const char* const kPosesOfABody = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm,qw,qx,qy,qz,sigma_mm,sigma_deg\n";

TEST(PointTable, QuaternionsMakeItTheTableOfABody) {
  const std::string header = kPosesOfABody;
  const Measurements m = read_points({"m.csv", header + "A,0,0,-888,1,2,3,0.9998,0.01,-0.01,0.014,0.2,0.1\n"
                                                        "B,9,0,-888,4,5,6,1,0,0,0,,\n"});
  const std::vector<PointReading>& read = m.series.at(0).readings;
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(m.series[0].is_of_body());
  EXPECT_EQ(read[0].point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read[0].orientation->coeffs(), Eigen::Vector4d(0.01, -0.01, 0.014, 0.9998));  // as it was read
  EXPECT_EQ(read[0].orientation_sigma, to_radians(0.1));
  EXPECT_EQ(read[1].orientation->w(), 1.0);
  EXPECT_FALSE(read[1].orientation_sigma || read[1].sigma);
  EXPECT_THAT(m.notes, IsEmpty());
}

TEST(PointTable, ABodysPoseIsReadAsAWhole) {
  const std::string header = kPosesOfABody;
  const Measurements m = read_points({"m.csv", header + "A,0,0,-888,1,2,3,1,0,0,0,,\nB,9,0,-888,4,5,6,,,,,,\n"
                                                        "C,9,9,-888,,,,1,0,0,0,,\n"});
  EXPECT_EQ(m.stations.size(), 1u);
  EXPECT_THAT(m.notes, ElementsAre("line 3: pose B has no orientation: its point is ignored",
                                   "line 4: pose C has no point: its other readings are ignored"));
}

TEST(PointTable, WhatIsNoRotationIsRefused) {
  const auto refused = [](const std::string& header, const std::string& row, const std::string& message) {
    EXPECT_THAT(([&] {
                  (void)read_points({"m.csv", header + row});
                }),
                ThrowsMessage<InputFileError>(HasSubstr(message)));
  };
  const std::string header = kPosesOfABody;
  refused(header, "A,0,0,-888,1,2,3,1,0,0,0.1,,\n",
          "m.csv:2: expected a unit quaternion qw, qx, qy, qz, got length 1.00499");
  refused(header, "A,0,0,-888,1,2,3,0,0,0,0,,\n", "got length 0");
  refused(header, "A,0,0,-888,1,2,3,1,0,0,,,\n",
          "m.csv:2: expected qw, qx, qy, qz either all filled in or all blank, got 1 blank");
  refused(header, "A,0,0,-888,1,2,3,1,0,0,0,,0\n", "expected sigma_deg from 1e-05 to 1e+06");
  const std::string points = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm,";
  refused(points + "qw,qx,qy\n", "A,0,0,-888,1,2,3,1,0,0\n", "qz");
  refused(points + "sigma_deg\n", "A,0,0,-888,1,2,3,0.1\n", "sigma_deg");  // of what?
  refused(points + "qw,qx,qy,qz,x2_mm,y2_mm,z2_mm\n", "A,0,0,-888,1,2,3,1,0,0,0,1,2,3\n", "x2_mm");
}

/// q and -q are one orientation.
TEST(Merge, ACopiedPoseOfABodyCountsOnce) {
  const std::string header = kPosesOfABody;
  const Measurements one = read_points({"one.csv", header + "A,0,0,-888,1,2,3,0.8,0,0.6,0,,\n"
                                                            "B,9,0,-888,4,5,6,0,1,0,0,,\n"});
  const Measurements other = read_points({"other.csv", header + "A,0,0,-888,1,2,3,-0.8,0,-0.6,0,,\n"
                                                                "B,9,0,-888,4,5,6,0,-0.6,0.8,0,,\n"});
  const Measurements both = merge({one, other});
  ASSERT_EQ(both.series.size(), 2u);  // two frames
  EXPECT_EQ(both.series[0].readings.size(), 2u);
  EXPECT_EQ(both.series[1].readings.size(), 1u);
  EXPECT_THAT(both.notes, ElementsAre("other.csv, 1 of 2 readings repeat an earlier series and count once"));
}

TEST(PointTable, PosesOfABodyReadBack) {
  const std::string header = kPosesOfABody;
  const Measurements m = read_points({"m.csv", header + "A,0,0,-888,1,2,3,0.9998,0.01,-0.01,0.014,0.2,0.1\n"
                                                        "B,9,0,-888,4,5,6,-1,0,0,0,,0.3\n"});
  const std::string table = point_table(m);
  EXPECT_THAT(table, testing::StartsWith(
                         "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm,qw,qx,qy,qz,sigma_mm,sigma_deg\n"
                         "A,0,0,-888,0,1,2,3,0.9998,0.01,-0.01,0.014,0.2,0.1\n"));
  expect_same(read_points({"m.csv", table}), m);
}

TEST(PointTable, AMissingCommandedRotationIsZero) {
  const Measurements m = read_points({"m.csv", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\nA,0,0,-888,1,2,3\n"});
  EXPECT_EQ(m.stations[0].commanded.rotation, 0.0);
}

TEST(PointTable, ByteOrderMarkCommentsAndWindowsLineEnds) {
  const Measurements m =
      read_points({"m.csv", "\xEF\xBB\xBF# tracker\r\n" + kHeader + "\r\n\"P 1\",0,0,-888,0,1,2,3\r\n"});
  EXPECT_EQ(m.stations[0].name, "P 1");
  EXPECT_EQ(m.series[0].readings[0].point.z(), 3.0);
}

TEST(PointTable, MissingReadingsArePassedOverAndNamed) {
  const Measurements m = read_points(points(
      "phi_deg", "A,0,0,-888,0,1,2,3,\nB,9,0,-888,0,,,,\nC,8,0,-888,0,,,,45\nA,0,0,-888,0,,,,\nD,7,0,-888,0,4,5,6,\n"));
  ASSERT_EQ(m.stations.size(), 2u);
  EXPECT_EQ(m.stations[1].name, "D");
  ASSERT_EQ(m.series[0].readings.size(), 2u);
  EXPECT_EQ(m.series[0].readings[1].station, 1u);
  EXPECT_THAT(m.notes,
              ElementsAre("line 3: pose B has no point", "line 4: pose C has no point: its other readings are ignored",
                          "line 5: pose A has no point"));
}

TEST(PointTable, TheFirstPoseThatWasReadIsHome) {
  const Measurements m = read_points(points("A,0,0,-888,0,,,\nB,9,0,-888,0,4,5,6\n"));
  EXPECT_EQ(m.stations.at(0).name, "B");
  EXPECT_THAT(m.notes, ElementsAre("line 2: pose A has no point", "pose B is used as home, because A has no point"));
}

TEST(PointTable, AStationStaysWhereOneRowReadsIt) {
  const Measurements m = read_points(points("A,0,0,-888,0,,,\nB,9,0,-888,0,4,5,6\nA,0,0,-888,0,1,2,3\n"));
  ASSERT_EQ(m.stations.size(), 2u);
  EXPECT_EQ(m.stations[0].name, "A");
  EXPECT_EQ(m.series[0].readings[1].station, 0u);
  EXPECT_THAT(m.notes, ElementsAre("line 2: pose A has no point"));
}

TEST(PointTable, DoubledReadingsCountOnce) {
  const Measurements m =
      read_points(points("phi_deg", "A,0,0,-888,0,1,2,3,10\nA,0,0,-888,0,1,2,3,10\nA,0,0,-888,0,1,2,3,11\n"));
  ASSERT_EQ(m.series[0].readings.size(), 2u);
  EXPECT_THAT(m.notes, ElementsAre("line 3: pose A repeats the reading of line 2 and counts once",
                                   "line 4: pose A has exactly the same point as pose A in line 2: check both"));
}

TEST(PointTable, TwoPosesAtOnePointAreNoted) {
  const Measurements m = read_points(points("A,0,0,-888,0,1,2,3\nB,9,0,-888,0,1,2,3\n"));
  EXPECT_EQ(m.series[0].readings.size(), 2u);
  EXPECT_THAT(m.notes, ElementsAre("line 3: pose B has exactly the same point as pose A in line 2: check both"));
}

TEST(PointTable, RowsOfOnePoseMustAgree) {
  expect_refused(points("A,0,0,-888,0,1,2,3\nA,0,0,-888,90,1,2,4\n"),
                 "day 1/m.csv:3: expected pose A at (0, 0, -888) mm",
                 "0 deg as in line 2, got (0, 0, -888) mm and 90 deg");
  expect_refused(points("A,0,0,-888,0,1,2,3\nA,0,0,-889,0,,,\n"), "day 1/m.csv:3: expected pose A", "line 2");
  expect_refused(points("q1_deg,q2_deg,q3_deg", "A,0,0,-888,0,1,2,3,1,2,3\nA,0,0,-888,0,1,2,4,1,2,4\n"),
                 "m.csv:3: ", "expected pose A at (1, 2, 3) deg as in line 2, got (1, 2, 4) deg");
}

TEST(PointTable, PartlyBlankPointsAreRefused) {
  expect_refused(points("A,0,0,-888,0,1,,3\n"), "day 1/m.csv:2: expected x_mm, y_mm, z_mm either all", "got 1 blank");
  expect_refused(points("x2_mm,y2_mm,z2_mm", "A,0,0,-888,0,1,2,3,4,,\n"), "m.csv:2: expected x2_mm, y2_mm, z2_mm",
                 "got 2 blank");
  expect_refused(points("x2_mm,y2_mm", "A,0,0,-888,0,1,2,3,4,5\n"), "m.csv:1: expected a column \"z2_mm\"");
}

TEST(PointTable, NumbersThatMakeNoSenseAreRefused) {
  expect_refused(points("A,0,0,-888,0,1,two,3\n"), "day 1/m.csv:2: expected a finite number in column y_mm", "\"two\"");
  expect_refused(points("A,0,0,-888,0,1,2,inf\n"), "day 1/m.csv:2: expected a finite number in column z_mm", "\"inf\"");
  expect_refused(points("A,0,,-888,0,1,2,3\n"), "day 1/m.csv:2: expected a finite number in column y_cmd_mm");
  expect_refused(points("A,0,0,-888,,1,2,3\n"), "day 1/m.csv:2: expected a finite number in column phi_cmd_deg");
  expect_refused(points("sigma_mm", "A,0,0,-888,0,1,2,3,0\n"), "m.csv:2: expected sigma_mm from 1e-05 to 1e+06");
  expect_refused(points("sigma_mm", "A,0,0,-888,0,,,,-1\n"), "m.csv:2: expected sigma_mm from 1e-05 to 1e+06");
  expect_refused(points("phi_deg", "A,0,0,-888,0,1,2,3,x\n"), "m.csv:2: expected a finite number in column phi_deg");
  for (const char* repeat : {"0", "-1"}) {
    expect_refused(points("repeat", fmt::format("A,0,0,-888,0,1,2,3,{}\n", repeat)),
                   "m.csv:2: expected repeat from 1 to 1e+06, got", repeat);
  }
  expect_refused(points("repeat", "A,0,0,-888,0,1,2,3,1.5\n"),
                 "m.csv:2: expected a whole number from 1 in column repeat, got", "1.5");
}

TEST(PointTable, WrongColumnsAreRefused) {
  expect_refused({"m.csv", ""}, "m.csv: expected a header line");
  expect_refused({"m.csv", kHeader + "\n"}, "m.csv: expected at least one row");
  expect_refused(points("A,0,0,-888,0,,,\n"), "day 1/m.csv: expected at least one row with a point, got none");
  expect_refused(points("X_mm", "A,0,0,-888,0,1,2,3,4\n"), "m.csv:1: expected only the columns pose, x_cmd_mm",
                 "\"X_mm\"");
  expect_refused({"m.csv", "x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\n0,0,-888,1,2,3\n"},
                 "m.csv:1: expected a column \"pose\"");
  expect_refused({"m.csv", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm\nA,0,0,-888,1,2\n"},
                 "m.csv:1: expected a column \"z_mm\"");
  expect_refused({"m.csv", "pose,x_mm,y_mm,z_mm\nA,1,2,3\n"}, "m.csv:1: expected a column \"x_cmd_mm\"");
  expect_refused(points(",0,0,-888,0,1,2,3\n"), "day 1/m.csv:2: expected a name in column pose");
}

TEST(PointTable, JointColumnsAreThoseOfTheRobot) {
  const std::string three = "q1_deg,q2_deg,q3_deg", four = three + ",q4_deg";
  expect_refused(points(three, "A,0,0,-888,0,1,2,3,1,2,3\n"), "m.csv:1: expected a column \"q4_deg\"", "", 4);
  expect_refused(points(four, "A,0,0,-888,0,1,2,3,1,2,3,4\n"), "m.csv:1: expected only the columns", "\"q4_deg\"", 3);
  expect_refused(points(three, "A,0,0,-888,0,1,2,3,1,,3\n"), "m.csv:2: expected a finite number in column q2_deg");
  EXPECT_EQ(read_points(points(four, "A,0,0,-888,0,1,2,3,1,2,3,4\n"), 4).stations[0].believed->size(), 4);
}

TEST(PointTable, LargeFilesAreRead) {
  std::string rows;
  for (int k = 0; k < 200'000; ++k)
    fmt::format_to(std::back_inserter(rows), "P{},{},0,-888,0,0,{},0\n", k % 50'000, k % 50'000, k);
  const Measurements m = read_points(points(rows));
  EXPECT_EQ(m.stations.size(), 50'000u);
  EXPECT_EQ(m.series[0].readings.size(), 200'000u);
}

/// The worst case for the search of doubled readings: the same point everywhere.
TEST(PointTable, LargeFilesOfCopiesAreRead) {
  std::string rows;
  for (int k = 0; k < 200'000; ++k) fmt::format_to(std::back_inserter(rows), "P{},{},0,-888,0,0,0,0\n", k, k);
  EXPECT_EQ(read_points(points(rows)).notes.size(), 199'999u);
}

TEST(PointTable, AnyTextIsReadOrRefused) {
  const bool held = rc::check("no crash on any text", [](const std::string& text) {
    try {
      (void)read_points(points(text));
    } catch (const InputFileError&) {
    }
  });
  EXPECT_TRUE(held);
}

/// Fields that are each sensible alone, in every combination.
TEST(PointTable, AnyRowsAreReadOrRefused) {
  const bool held = rc::check("no crash on any rows", [] {
    const auto field = rc::gen::element<std::string>("", "1", "-888", "A", "1e400", "nan", "\"", "#", "0x1");
    const auto rows = *rc::gen::container<std::vector<std::vector<std::string>>>(
        rc::gen::container<std::vector<std::string>>(9, field));
    std::string text;
    for (const auto& row : rows) {
      for (const std::string& entry : row) text.append(&entry == &row.front() ? "" : ",").append(entry);
      text += '\n';
    }
    try {
      const Measurements m = read_points(points("sigma_mm", text));
      check(m, 0);
    } catch (const InputFileError&) {
    }
  });
  EXPECT_TRUE(held);
}

// ---- Writing

TEST(PointTable, OnlyTheColumnsThatAreNeededAreWritten) {
  const std::string text = kHeader + "\nA,0,0,-888,0,1,2,3\nB,0.1,0,-888,60,4,5,6\n";
  EXPECT_EQ(point_table(read_points({"m.csv", text})), text);
}

TEST(PointTable, RepeatsAreCounted) {
  const Measurements m = read_points(points("A,0,0,-888,0,1,2,3\nB,9,0,-888,0,1,5,3\nA,0,0,-888,0,1,2,4\n"));
  EXPECT_EQ(point_table(m), kHeader + ",repeat\nA,0,0,-888,0,1,2,3,1\nB,9,0,-888,0,1,5,3,1\nA,0,0,-888,0,1,2,4,2\n");
}

TEST(PointTable, EveryColumnReadsBack) {
  const std::string text = kHeader +
                           ",repeat,phi_deg,x2_mm,y2_mm,z2_mm,sigma_mm,q1_deg,q2_deg,q3_deg,q4_deg\n"
                           "A,0.1,0,-888.3,0,1,2,3,1,12.3,4,5,6,0.02,10.1,20.2,30.3,40.7\n"
                           "A,0.1,0,-888.3,0,1,2,3.5,2,,,,,,10.1,20.2,30.3,40.7\n"
                           "\"#1, \"\"b\"\"\",9,0,-888,-179.9,7,8,9,1,13.7,,,,0.03,-11.618,20.2,30.3,40.7\n";
  EXPECT_EQ(point_table(read_points({"m.csv", text}, 4)), text);
}

TEST(PointTable, HomeIsWrittenFirst) {
  const Measurements m = read_points(points("A,0,0,-888,0,,,\nB,9,0,-888,0,1,5,3\nA,0,0,-888,0,1,2,4\n"));
  const Measurements again = read_points({"m.csv", point_table(m)});
  EXPECT_EQ(again.stations[0].name, "A");
  EXPECT_EQ(again.series[0].readings[0].point.z(), 4.0);
}

/// Whatever is written, the same is read.
TEST(PointTable, WrittenTablesReadBack) {
  const bool held = rc::check("point tables read back", [] {
    const auto number = [] { return *rc::gen::inRange(-1'000'000'000, 1'000'000'000) * 1e-6 / 3.0; };
    const auto name =
        *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::elementOf(std::string(" aB\t7,\"#;"))));
    const bool rotation = *rc::gen::arbitrary<bool>(), second = *rc::gen::arbitrary<bool>();
    Measurements m{.series = {{"m", {}}}};
    for (std::size_t k = 0; k < 3; ++k) {
      m.stations.push_back({name + std::to_string(k) + name, {{number(), number(), number()}, to_radians(number())}});
      m.stations.back().believed = Joints::Constant(4, to_radians(number()));
      PointReading reading{.station = k, .point = {number(), number(), number() + static_cast<double>(k) * 1e4}};
      if (rotation) reading.rotation = to_radians(number());
      if (second && k != 1) reading.second = Eigen::Vector3d(number(), number(), number());
      if (k == 2) reading.sigma = 1.0 / 3.0;
      m.series[0].readings.push_back(reading);
    }
    const Measurements again = read_points({"m.csv", point_table(m)}, 4);
    RC_ASSERT(again.stations.size() == 3u);
    RC_ASSERT(again.notes.empty());
    for (std::size_t k = 0; k < 3; ++k) {
      RC_ASSERT(same(again.stations[k], m.stations[k]));
      RC_ASSERT(same(again.series[0].readings[k], m.series[0].readings[k]));
    }
  });
  EXPECT_TRUE(held);
}

TEST(PointTable, WhatCannotBeReadBackIsNotWritten) {
  const Measurements good = read_points(points("A,0,0,-888,0,1,2,3\nB,9,0,-888,0,4,5,6\n"));
  const auto refused = [](const Measurements& m, const std::string& part) {
    EXPECT_THAT([&] { (void)point_table(m); }, ThrowsMessage<InvalidArgument>(HasSubstr(part)));
  };
  refused({}, "expected one series of points, got 0");
  Measurements bad = good;
  bad.series.push_back(bad.series[0]);
  refused(bad, "got 2");
  bad = good;
  bad.series[0].readings.clear();
  refused(bad, "an empty one");
  bad = good;
  bad.stations[1].name = "A";
  refused(bad, "got \"A\" twice");
  bad.stations[1].name = "two\nlines";
  refused(bad, "station 2: expected a name in one line");
  bad.stations[1].name = "";
  refused(bad, "station 2: expected a name");
  bad = good;
  bad.stations[1].believed = Joints::Zero(4);
  refused(bad, "commanded joints of all 2 stations or of none, got those of 1");
  bad.stations[0].believed = Joints::Zero(3);
  refused(bad, "3 finite joint coordinates");
  bad = good;
  bad.series[0].readings[0].point.x() = std::numeric_limits<double>::infinity();
  refused(bad, "finite point");
  bad = good;
  bad.series[0].readings[0].station = 2;
  refused(bad, "a station of the list");
}

TEST(StationTable, ReadsBackAsPoses) {
  const std::vector<Station> stations{{"A", {{0.1, 0, -888}, to_radians(60)}}, {"B, 2", {{1.0 / 3.0, -5, -900}, -0.1}}};
  const std::string text = station_table(stations);
  EXPECT_THAT(text, StartsWith("pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg\nA,0.1,0,-888,60\n\"B, 2\","));
  const std::vector<Station> again = read_poses({"p.csv", text});
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[1].name, "B, 2");
  EXPECT_EQ(again[1].commanded.position, stations[1].commanded.position);
  EXPECT_NEAR(again[1].commanded.rotation, -0.1, 1e-15);
  EXPECT_THROW((void)station_table({stations[0], stations[0]}), InvalidArgument);
}

// ---- Merging

TextFile named(const std::string& name, const std::string& rows) { return {name, kHeader + "\n" + rows}; }

TEST(Merge, SharesStationsAndKeepsFrames) {
  const Measurements m = merge({read_points(named("d/a.csv", "H,0,0,-888,0,1,2,3\nA,9,0,-888,0,4,5,6\n")),
                                read_points(named("d/b.csv", "B,8,0,-888,0,7,8,9\nH,0,0,-888,0,11,12,13\n"))});
  ASSERT_EQ(m.stations.size(), 3u);
  EXPECT_EQ(m.stations[0].name, "H");
  EXPECT_EQ(m.stations[2].name, "B");
  ASSERT_EQ(m.series.size(), 2u);
  EXPECT_EQ(m.series[0].name, "a.csv");
  EXPECT_EQ(m.series[1].name, "b.csv");
  EXPECT_EQ(m.series[1].readings[0].station, 2u);
  EXPECT_EQ(m.series[1].readings[1].station, 0u);
  ASSERT_EQ(m.files.size(), 2u);
  EXPECT_EQ(m.files[1].name, "d/b.csv");
  EXPECT_THAT(m.notes, IsEmpty());
}

TEST(Merge, KeepsAnotherPoseOfTheSameNameApart) {
  const Measurements first = read_points(named("a.csv", "P1,0,0,-888,0,1,2,3\nP2,9,0,-888,0,4,5,6\n"));
  const Measurements second = read_points(named("b.csv", "P1,0,0,-888,0,1,2,4\nP2,7,0,-888,0,4,5,7\n"));
  Measurements third = read_points(named("c.csv", "P1,0,0,-888,0,1,2,5\n"));
  third.stations[0].believed = Joints::Zero(4);
  const Measurements again = read_points(named("d.csv", "P2,7,0,-888,0,14,5,7\n"));
  const Measurements m = merge({first, second, third, again});
  ASSERT_EQ(m.stations.size(), 4u);
  EXPECT_EQ(m.stations[2].name, "b.csv:P2");
  EXPECT_EQ(m.stations[3].name, "c.csv:P1");
  EXPECT_EQ(m.series[1].readings[0].station, 0u);
  EXPECT_EQ(m.series[1].readings[1].station, 2u);
  EXPECT_EQ(m.series[3].readings[0].station, 2u);
}

TEST(Merge, NotesNameTheirSeries) {
  const Measurements m = merge({read_points(named("a.csv", "A,0,0,-888,0,1,2,3\n")),
                                read_points(named("b.csv", "A,0,0,-888,0,4,5,6\nB,9,0,-888,0,,,\n"))});
  EXPECT_THAT(m.notes, ElementsAre("b.csv, line 3: pose B has no point"));
  const Measurements more = merge({m, read_points(named("c.csv", "C,0,0,-888,0,7,8,9\nB,9,0,-888,0,,,\n"))});
  EXPECT_THAT(more.notes, ElementsAre("b.csv, line 3: pose B has no point", "c.csv, line 3: pose B has no point"));
}

TEST(Merge, CopiedReadingsCountOnce) {
  const Measurements a = read_points(named("x/a.csv", "A,0,0,-888,0,1,2,3\nB,9,0,-888,0,4,5,6\n"));
  const Measurements b = read_points(named("y/a.csv", "A,0,0,-888,0,1,2,3\nB,9,0,-888,0,4,5,7\n"));
  const Measurements m = merge({a, b, a});
  ASSERT_EQ(m.series.size(), 2u);
  EXPECT_EQ(m.series[1].name, "a.csv (2)");
  EXPECT_EQ(m.series[1].readings.size(), 1u);
  EXPECT_EQ(m.files.size(), 2u);
  EXPECT_THAT(m.notes, ElementsAre("a.csv (2), 1 of 2 readings repeat an earlier series and count once",
                                   "a.csv (3), 2 of 2 readings repeat an earlier series and count once"));
}

TEST(Merge, DistancesFindTheirStations) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nA,0,0,-888\nB,100,0,-888\nC,50,0,-888\n"};
  const Measurements distances = read_distances({"d.csv", "from,to,distance_mm\nA,C,50\nB,C,49\n"}, poses);
  const Measurements m =
      merge({read_points(named("a.csv", "H,1,0,-888,0,1,2,3\nC,50,0,-888,0,4,5,6\nB,1,1,-888,0,7,8,9\n")), distances,
             distances});
  EXPECT_EQ(m.stations.size(), 5u);
  EXPECT_EQ(m.stations[4].name, "d.csv:B");
  EXPECT_EQ(m.distances[0].from, 3u);
  EXPECT_EQ(m.distances[0].to, 1u);
  EXPECT_EQ(m.distances[1].from, 4u);
  EXPECT_EQ(m.files.size(), 3u);
}

TEST(Merge, CopiedDistancesCountOnce) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nA,0,0,-888\nB,100,0,-888\nC,50,0,-888\n"};
  const Measurements distances = read_distances({"d.csv", "from,to,distance_mm\nA,C,50\nB,C,49\n"}, poses);
  const Measurements turned = read_distances({"e.csv", "from,to,distance_mm\nC,B,49\nA,B,101\nC,A,50.5\n"}, poses);
  const Measurements m = merge({distances, turned});
  ASSERT_EQ(m.distances.size(), 4u);
  EXPECT_EQ(m.distances[2].distance, 101.0);
  EXPECT_EQ(m.distances[3].distance, 50.5);
  EXPECT_THAT(m.notes, ElementsAre("e.csv, 1 of 3 readings repeat an earlier series and count once"));
}

TEST(Merge, ARotationReadBackwardsIsTheSameReading) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nA,0,0,-888\nB,100,0,-888\n"};
  const auto read = [&](const std::string& row) {
    return read_distances({"d.csv", "from,to,distance_mm,rotation_deg\n" + row + "\n"}, poses);
  };
  EXPECT_EQ(merge({read("A,B,101,2.5"), read("B,A,101,-2.5")}).distances.size(), 1u);
  EXPECT_EQ(merge({read("A,B,101,2.5"), read("B,A,101,2.5")}).distances.size(), 2u);
}

// Single heights agree by chance on a dial that shows a hundredth.
TEST(Merge, CopiedHeightsCountOnceAsAWhole) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nA,0,0,-888\nB,100,0,-888\nC,50,0,-888\nD,0,50,-888\n"};
  const auto read = [&](const std::string& name, const std::string& rows) {
    return read_lengths({name, "pose,height_mm\n" + rows}, poses);
  };
  const Measurements first = read("monday.csv", "A,0.01\nB,0.02\nC,0.02\nD,0.01\n");
  const Measurements copy = read("copy.csv", "C,0.02\nA,0.01\nD,0.01\nB,0.02\n");
  const Measurements other = read("tuesday.csv", "A,0.01\nB,0.02\nC,0.03\nD,0.01\n");
  const Measurements m = merge({first, copy, other});
  ASSERT_EQ(m.lengths.size(), 2u);
  EXPECT_EQ(m.lengths[0].name, "monday.csv");
  EXPECT_EQ(m.lengths[1].name, "tuesday.csv");
  EXPECT_EQ(m.lengths[1].readings.size(), 4u);
  EXPECT_THAT(m.notes, ElementsAre("copy.csv, 4 of 4 readings repeat an earlier series and count once"));
}

/// The same numbers on another instrument are no copy.
TEST(Merge, LengthsOfAnotherKindAreNoCopy) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nA,0,0,-888\nB,100,0,-888\n"};
  const Measurements heights = read_lengths({"h.csv", "pose,height_mm\nA,1\nB,2\nA,1.1\nB,2.1\n"}, poses);
  const Measurements bar = read_lengths({"b.csv", "pose,ball_bar_mm\nA,1\nB,2\nA,1.1\nB,2.1\n"}, poses);
  const Measurements m = merge({heights, bar, bar});
  ASSERT_EQ(m.lengths.size(), 2u);
  EXPECT_EQ(m.lengths[1].kind, LengthKind::ball_bar);
  EXPECT_THAT(m.notes, ElementsAre("b.csv (2), 4 of 4 readings repeat an earlier series and count once"));
}

TEST(Merge, OnePartStaysAsItIs) {
  const Measurements m = read_points(points("A,0,0,-888,0,1,2,3\nB,9,0,-888,0,,,\n"));
  const Measurements merged = merge({m});
  expect_same(m, merged);
  EXPECT_EQ(merged.notes, m.notes);
}

TEST(Merge, RefusesNothingAndNonsense) {
  EXPECT_THROW((void)merge({}), InvalidArgument);
  const Measurements good = read_points(points("A,0,0,-888,0,1,2,3\n"));
  Measurements bad = good;
  bad.series[0].readings[0].station = 7;
  EXPECT_THAT(
      [&] {
        (void)merge({good, bad});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("one of 1 stations, got one of station 8")));
}

// ---- Tracker exports

const std::vector<Station> kPoses{{"P1", {{0, 0, -888}}}, {"P2", {{100, 0, -888}}}, {"far left", {{0, 99, -888}}}};

Measurements exported(const std::string& text, const std::string& columns, const std::string& unit = "mm") {
  return read_tracker_export({"t/e.txt", text}, parse_column_map(columns, unit), kPoses);
}

void expect_refused(const std::string& text, const std::string& start, const std::string& part = "") {
  EXPECT_THAT([&] { (void)exported(text, "name=1,x=2,y=3,z=4"); },
              ThrowsMessage<InputFileError>(AllOf(StartsWith(start), HasSubstr(part))));
}

TEST(ColumnMap, SaysWhereAndInWhichUnit) {
  const ColumnMap map = parse_column_map("name=3, x=4,z=6,y=5,sigma=9", "inch");
  EXPECT_EQ(map.name, 3u);
  EXPECT_EQ(map.x, 4u);
  EXPECT_EQ(map.y, 5u);
  EXPECT_EQ(map.z, 6u);
  EXPECT_EQ(map.sigma, 9u);
  EXPECT_EQ(map.mm_per_unit, 25.4);
  EXPECT_FALSE(parse_column_map("name=3,x=4,y=5,z=6", "mm").sigma);
  EXPECT_EQ(parse_column_map("name=3,x=4,y=5,z=6", "m").mm_per_unit, 1000.0);
  EXPECT_EQ(parse_column_map("name=3,x=4,y=5,z=6", "um").mm_per_unit, 0.001);
}

TEST(ColumnMap, AnythingElseIsRefused) {
  const std::vector<std::array<std::string, 2>> cases{
      {"", "\"\" is unknown"},
      {"name=1,x=2,y=3", "z is missing"},
      {"x=2,y=3,z=4", "name is missing"},
      {"name=1,x=2,y=3,z=4,w=5", "\"w=5\" is unknown"},
      {"name=1,x=2,y=3,z=4,", "\"\" is unknown"},
      {"name,x=2,y=3,z=4", "\"name\" is unknown"},
      {"name=1=2,x=2,y=3,z=4", "\"name=1=2\" is unknown"},
      {"name=0,x=2,y=3,z=4", "\"0\" is not a column"},
      {"name=1.5,x=2,y=3,z=4", "\"1.5\" is not a column"},
      {"name=-1,x=2,y=3,z=4", "\"-1\" is not a column"},
      {"name=1e300,x=2,y=3,z=4", "\"1e300\" is not a column"},
      {"name=nan,x=2,y=3,z=4", "\"nan\" is not a column"},
      {"name=,x=2,y=3,z=4", "\"\" is not a column"},
      {"name=1,x=2,x=3,z=4", "x is given twice"},
      {"name=1,x=2,y=2,z=4", "column 2 is given twice"},
  };
  for (const auto& one : cases) {
    EXPECT_THAT([&] { (void)parse_column_map(one[0], "mm"); },
                ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("expected a list like name=3,x=4,y=5,z=6"),
                                                     HasSubstr("got \"" + one[0] + "\""), HasSubstr(one[1]))));
  }
  for (const std::string unit : {"", "MM", "feet", "mm "}) {
    EXPECT_THAT([&] { (void)parse_column_map("name=1,x=2,y=3,z=4", unit); },
                ThrowsMessage<InvalidArgument>("unit: expected mm, m, um or inch, got \"" + unit + "\""));
  }
  const auto with = [](const ColumnMap& map) { (void)read_tracker_export({"e.txt", "P1 1 2 3"}, map, kPoses); };
  EXPECT_THROW(with({}), InvalidArgument);
  EXPECT_THROW(with({.name = 1, .x = 2, .y = 3, .z = 4}), InvalidArgument);
  EXPECT_THROW(with({.name = 1, .x = 2, .y = 3, .z = 4, .sigma = 0, .mm_per_unit = 1.0 / 0.0}), InvalidArgument);
}

TEST(TrackerExport, SpatialAnalyzerStyle) {
  const Measurements m = exported(
      "\xEF\xBB\xBF// SpatialAnalyzer 2024\r\n// frame: instrument\xB0\r\n\r\n"
      "\"Set A\" Points P1   1.5  -2 3e2\r\n"
      "  // a comment further in\r\n# another\r\n"
      "\"Set A\" Points \"far left\" 4 5 6 \r\n"
      "\"Set A\" Points P1 1.6 -2 300\r\n"
      "\"Set A\" Points P2 7 8 9\r\n",
      "name=3,x=4,y=5,z=6");
  ASSERT_EQ(m.stations.size(), 3u);
  EXPECT_EQ(m.stations[1].name, "P2");
  ASSERT_EQ(m.series.size(), 1u);
  EXPECT_EQ(m.series[0].name, "e.txt");
  const auto& readings = m.series[0].readings;
  ASSERT_EQ(readings.size(), 4u);
  EXPECT_EQ(readings[0].point, Eigen::Vector3d(1.5, -2, 300));
  EXPECT_EQ(readings[1].station, 2u);
  EXPECT_EQ(readings[2].station, 0u);
  EXPECT_THAT(m.notes, IsEmpty());
  EXPECT_EQ(m.files.at(0).name, "t/e.txt");
}

TEST(TrackerExport, EverySeparator) {
  for (const std::string text :
       {"P1 1 2 3\nfar_left 4 5 6", "P1,1, 2,3\nfar left,4,5,6\n", "P1\t1\t2\t3\nfar left\t4\t5\t6",
        "P1;1;2;3\n far left ; 4 ; 5 ; 6\n", "\"P1\", 1, 2, 3\n\"far left\", 4, 5, 6"}) {
    const Measurements m = exported(text, "name=1,x=2,y=3,z=4");
    EXPECT_EQ(m.series[0].readings[0].point, Eigen::Vector3d(1, 2, 3)) << text;
  }
}

TEST(TrackerExport, SeparatorsAndQuotationMarksInNames) {
  const std::vector<Station> poses{{"a,b;c\td \"e\"", {{0, 0, -888}}}, {"", {}}};
  const ColumnMap map = parse_column_map("name=2,x=3,y=4,z=5", "mm");
  for (const std::string separator : {" ", ",", ";", "\t", " , "}) {
    std::string line = "\"\"~\"a,b;c\td \"\"e\"\"\"~1~2~3\n";
    for (std::size_t at = line.find('~'); at != std::string::npos; at = line.find('~')) line.replace(at, 1, separator);
    const Measurements m = read_tracker_export({"e.txt", line}, map, poses);
    EXPECT_EQ(m.series[0].readings.at(0).point, Eigen::Vector3d(1, 2, 3)) << line;
  }
}

TEST(TrackerExport, BlankColumnsCount) {
  EXPECT_EQ(exported("\t\tP1\t1\t2\t3\n", "name=3,x=4,y=5,z=6").series[0].readings[0].point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(exported(",,P1,1,2,3,\n", "name=3,x=4,y=5,z=6").series[0].readings[0].point, Eigen::Vector3d(1, 2, 3));
}

TEST(TrackerExport, UnitsBecomeMillimetres) {
  const Measurements m = exported("P1 1 -2 0.5 0.001\n", "name=1,x=2,y=3,z=4,sigma=5", "inch");
  EXPECT_EQ(m.series[0].readings[0].point, Eigen::Vector3d(25.4, -50.8, 12.7));
  EXPECT_EQ(m.series[0].readings[0].sigma, 0.0254);
  EXPECT_EQ(exported("P1 1 2 3\n", "name=1,x=2,y=3,z=4", "m").series[0].readings[0].point,
            Eigen::Vector3d(1000, 2000, 3000));
  EXPECT_EQ(exported("P1 1000 2000 3000\n", "name=1,x=2,y=3,z=4", "um").series[0].readings[0].point,
            Eigen::Vector3d(1, 2, 3));
}

TEST(TrackerExport, WhatIsNoPoseOrNotMeasuredIsNoted) {
  const Measurements m = exported("REF1 0 0 0\nP2 4 5 6\nP2 4 5 6\nP2 4 5 7\nfar_left 1 1 1\n", "name=1,x=2,y=3,z=4");
  ASSERT_EQ(m.stations.size(), 1u);
  EXPECT_EQ(m.stations[0].name, "P2");
  EXPECT_EQ(m.series[0].readings.size(), 2u);
  EXPECT_THAT(m.notes,
              ElementsAre("line 1: REF1 is not a pose and is ignored",
                          "line 3: pose P2 repeats the reading of line 2 and counts once",
                          "line 5: far_left is not a pose and is ignored", "pose P1 was not measured",
                          "pose far left was not measured", "pose P2 is used as home, because P1 has no point"));
}

TEST(TrackerExport, TwoPosesAtOnePointAreNoted) {
  const Measurements m = exported("P1 4 5 6\nP2 4 5 6\n", "name=1,x=2,y=3,z=4");
  EXPECT_EQ(m.series[0].readings.size(), 2u);
  EXPECT_THAT(m.notes, ElementsAre("line 2: pose P2 has exactly the same point as pose P1 in line 1: check both",
                                   "pose far left was not measured"));
}

TEST(TrackerExport, BrokenLinesAreRefused) {
  expect_refused("P1 1 2\n", "t/e.txt:1: expected at least 4 fields for name=1,x=2,y=3,z=4, got 3");
  expect_refused("// c\nP1 1 2 3\nP 2 1 2 3\n", "t/e.txt:3: expected 4 fields as in line 2, got 5", "quotation marks");
  expect_refused("P1 1 2 3\nName X Y Z\n", "t/e.txt:2: expected a finite number in column 2 (x), got \"X\"");
  expect_refused("REF 1 2 oops\nP1 1 2 3\n", "t/e.txt:1: expected a finite number in column 4 (z), got \"oops\"");
  expect_refused("P1 1 nan 3\n", "t/e.txt:1: expected a finite number in column 3 (y), got \"nan\"");
  expect_refused("P1;1,500;2;3\n",
                 "t/e.txt:1: expected a finite number in column 2 (x), got \"1,500\" (1.500 or 1500?");
  expect_refused("P1;1,5;2.5;3,5\n",
                 "t/e.txt:1: expected a finite number in column 3 (y), got \"2.5\" (line 1 has a decimal comma)");
  expect_refused("P1,1,,3\n", "t/e.txt:1: expected a finite number in column 3 (y), got \"\"");
  expect_refused(",1,2,3\n", "t/e.txt:1: expected a name in column 1, got none");
  expect_refused("\"P1 1 2 3\n", "t/e.txt:1: expected closed quotation marks");
  EXPECT_THAT([] { (void)exported("P1 1e308 2 3\n", "name=1,x=2,y=3,z=4", "m"); },
              ThrowsMessage<InputFileError>(HasSubstr("expected a finite number in column 2 (x), got \"1e308\"")));
  EXPECT_THAT([] { (void)exported("P1 1 2 3 0\n", "name=1,x=2,y=3,z=4,sigma=5"); },
              ThrowsMessage<InputFileError>(StartsWith("t/e.txt:1: expected column 5 (sigma) from 1e-05 to 1e+06")));
}

TEST(TrackerExport, FilesWithoutAPoseAreRefused) {
  expect_refused("", "t/e.txt: expected at least one line with a point, got none");
  expect_refused("// nothing\n\n", "t/e.txt: expected at least one line with a point, got none");
  expect_refused("p1 1 2 3\nREF 1 2 3\n",
                 "t/e.txt: expected a point named as one of the poses P1, P2, far left; got only p1, REF");
  std::string text;
  for (int k = 0; k < 12; ++k) text += fmt::format("R{} 1 2 3\n", k);
  expect_refused(text, "t/e.txt: ", "got only R0, R1, R2, R3, R4, R5, R6, R7, R8, R9 and 2 more");
}

TEST(TrackerExport, LargeFilesAreRead) {
  std::string text;
  for (int k = 0; k < 200'000; ++k) fmt::format_to(std::back_inserter(text), "set group P{} {} 0 0\n", k % 3, k);
  const Measurements m = exported(text, "name=3,x=4,y=5,z=6");
  EXPECT_EQ(m.series[0].readings.size() + m.notes.size(), 200'000u + 1u);
}

TEST(TrackerExport, AnyTextIsReadOrRefused) {
  const bool held = rc::check("no crash on any text", [] {
    const auto text =
        *rc::gen::container<std::string>(rc::gen::elementOf(std::string("P112 \t,;\"/#\n\r.-eE\xEF\xBB\xBF")));
    try {
      check(exported(text, "name=1,x=2,y=3,z=4"), 4);
    } catch (const InputFileError&) {
    }
  });
  EXPECT_TRUE(held);
}

TEST(TrackerExport, BecomesAPointTable) {
  const Measurements m = exported("P1 1 2 3\nP2 0.1 0.2 0.3\n", "name=1,x=2,y=3,z=4", "inch");
  expect_same(read_points({"m.csv", point_table(m)}), m);
}

}  // namespace
}  // namespace paracal::io::points_test

#include "paracal/io/tables.hpp"

#include <gmock/gmock.h>
#include <rapidcheck.h>

#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/io/points.hpp"
#include "paracal/units.hpp"

namespace paracal::io::tables_test {
namespace {

using testing::HasSubstr, testing::StartsWith, testing::ThrowsMessage;

TEST(PoseTable, BothHeadersAndDefaults) {
  const auto plain = read_poses({"p.csv", "x_mm,y_mm,z_mm\n1,2,-3\n+4,5e1,-6\n"});
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_EQ(plain[1].name, "2");
  EXPECT_EQ(plain[1].commanded.position, Eigen::Vector3d(4, 50, -6));
  EXPECT_EQ(plain[0].commanded.rotation, 0.0);
  const auto commanded =
      read_poses({"p.csv", "# note\npose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg\r\n\r\nA,1,2,-3,90\r\n"});
  EXPECT_EQ(commanded[0].name, "A");
  EXPECT_EQ(commanded[0].commanded.rotation, to_radians(90));
  EXPECT_FALSE(commanded[0].believed);
}

TEST(PoseTable, BelievedJointsAreRead) {
  const auto poses = read_poses({"p.csv", "x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg\n0,0,-800,10,20,30\n"});
  ASSERT_TRUE(poses[0].believed);
  EXPECT_EQ((*poses[0].believed)(2), to_radians(30));
}

TEST(PoseTable, ByteOrderMarkAndQuotesAreUnderstood) {
  const auto poses = read_poses({"p.csv", "\xEF\xBB\xBFpose,x_mm,y_mm,z_mm\n\"a, \"\"b\"\"\",1,2,3\n"});
  EXPECT_EQ(poses[0].name, "a, \"b\"");
}

TEST(DistanceTable, RefersToPosesByName) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nhome,0,0,-888\nfar,100,0,-888\n"};
  const Measurements m =
      read_distances({"d.csv", "from,to,distance_mm,rotation_deg,sigma_mm\nhome,far,99.5,,0.02\n"}, poses);
  ASSERT_EQ(m.distances.size(), 1u);
  EXPECT_EQ(m.distances[0].to, 1u);
  EXPECT_EQ(m.distances[0].distance_sigma, 0.02);
  EXPECT_FALSE(m.distances[0].rotation);
  EXPECT_EQ(m.files[0].name, "d.csv");
  EXPECT_THAT(
      [&] {
        read_distances({"d.csv", "from,to,distance_mm\nhome,fra,99.5\n"}, poses);
      },
      ThrowsMessage<InputFileError>(StartsWith("d.csv:2: expected a pose of p.csv in column to, got \"fra\"")));
  EXPECT_THAT(
      [&] {
        read_distances({"d.csv", "from,to,distance_mm\nhome,far,1\nfar,home,1\n"}, poses);
      },
      ThrowsMessage<InputFileError>(StartsWith("d.csv:3: expected every pair")));
}

TEST(HeightTable, ReadsRepeatsOfOnePlaneAndRefusesOtherPoses) {
  const TextFile poses{"p.csv",
                       "pose,x_mm,y_mm,z_mm,q1_mm,q2_mm,q3_mm\nhome,0,0,-500,-1,-2,-3\nfar,90,0,-500,-4,-5,-6\n"};
  const JointSpace rails{3, Actuator::linear};
  const Measurements m = read_lengths(
      {"d/bed.csv", "pose,height_mm,sigma_mm\nhome,0.1,\nfar,-0.2,0.01\nhome,0.12,\nfar,-0.21,\n"}, poses, rails);
  ASSERT_EQ(m.lengths.size(), 1u);
  EXPECT_EQ(m.lengths[0].name, "bed.csv");
  ASSERT_EQ(m.lengths[0].readings.size(), 4u);
  EXPECT_EQ(m.lengths[0].readings[1].length, -0.2);
  EXPECT_EQ(m.lengths[0].readings[1].sigma, 0.01);
  EXPECT_EQ(m.lengths[0].readings[2].station, 0u);
  EXPECT_EQ(m.stations[1].believed->z(), -6.0);
  const auto refused = [&](const std::string& text, const std::string& part) {
    EXPECT_THAT(
        [&] {
          (void)read_lengths({"bed.csv", text}, poses, rails);
        },
        testing::ThrowsMessage<InputFileError>(testing::HasSubstr(part)));
  };
  refused("pose,height_mm\nnear,1\n", "bed.csv:2: expected a pose of p.csv in column pose, got \"near\"");
  refused("pose,height_mm\nhome,high\n", "bed.csv:2: ");
  refused("pose,height_mm\nhome,1\nfar,2\nhome,1\n", "bed.csv:2: expected at least 4 readings of one setup");
  refused("pose,height_mm\n", "expected at least one row");
  // Joints of arms are no joints of rails.
  EXPECT_THROW((void)read_lengths({"bed.csv", "pose,height_mm\nhome,1\n"}, poses, {3}), InputFileError);
}

/// Each table is known by its column; what it says of its set-up makes a series.
TEST(LengthTable, IsKnownByItsColumn) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nhome,0,0,-500\nfar,90,0,-500\n"};
  EXPECT_EQ(length_kind_in("pose,height_mm"), LengthKind::height);
  EXPECT_EQ(length_kind_in("pose,ball_bar_mm,sigma_mm"), LengthKind::ball_bar);
  EXPECT_EQ(length_kind_in("pose,dial_mm,direction_x,direction_y,direction_z"), LengthKind::dial);
  EXPECT_FALSE(length_kind_in("from,to,distance_mm"));
  const Measurements bar =
      read_lengths({"bar.csv", "pose,ball_bar_mm\nhome,300.5\nfar,310\nhome,300.6\nfar,310.1\n"}, poses);
  ASSERT_EQ(bar.lengths.size(), 1u);
  EXPECT_EQ(bar.lengths[0].kind, LengthKind::ball_bar);
  EXPECT_FALSE(bar.lengths[0].at);
  EXPECT_EQ(bar.lengths[0].readings[0].length, 300.5);
  const Measurements dials = read_lengths(
      {"d.csv",
       "pose,dial_mm,direction_x,direction_y,direction_z\nhome,0,0,0,1\nfar,-1.5,0,0,1\nfar,2,1,0,0\nhome,1,1,0,0\n"},
      poses);
  ASSERT_EQ(dials.lengths.size(), 2u);
  EXPECT_EQ(dials.lengths[0].name, "d.csv");
  EXPECT_EQ(dials.lengths[0].readings.size(), 2u);
  EXPECT_EQ(dials.lengths[1].name, "d.csv (1, 0, 0)");
  EXPECT_EQ(*dials.lengths[1].at, Eigen::Vector3d(1.0, 0.0, 0.0));
  const auto refused = [&](const std::string& text, const std::string& part) {
    EXPECT_THAT(
        [&] {
          (void)read_lengths({"l.csv", text}, poses);
        },
        ThrowsMessage<InputFileError>(testing::HasSubstr(part)));
  };
  refused("pose,ball_bar_mm\nhome,0\n",
          "l.csv:2: expected ball_bar_mm above 0 and up to 1e+06 mm (ten times the reach of the robot), got 0");
  refused("pose,ball_bar_mm,centre_x_mm\nhome,1,2\n", "centre_y_mm");
  refused("pose,dial_mm\nhome,1\n", "direction_x");
  refused("pose,dial_mm,direction_x,direction_y,direction_z\nhome,1,0,0,0\n",
          "l.csv:2: expected the direction that it measures, got 0, 0, 0");
  refused("pose,height_mm,direction_x\nhome,1,0\n", "direction_x");
  refused("pose,length_mm\nhome,1\n", "height_mm");
}

/// What is written is read again, whatever the kind.
TEST(LengthTable, IsReadBack) {
  const TextFile poses{"p.csv", "pose,x_mm,y_mm,z_mm\nhome,0,0,-500\nfar,90,0,-500\n"};
  for (const LengthWords& kind : length_kinds()) {
    Measurements written{.stations = read_poses(poses),
                         .lengths = {{"l.csv", kind.kind, {{0, 1.25}, {1, 0.1, 0.02}, {0, 1.5}, {1, 0.2}}}}};
    if (!kind.at_columns.front().empty()) written.lengths[0].at = Eigen::Vector3d(0.1, -2.5, 3.0);
    const LengthSeries read = read_lengths({"l.csv", length_table(written)}, poses).lengths.at(0);
    EXPECT_EQ(read.kind, kind.kind);
    EXPECT_EQ(read.at, written.lengths[0].at) << kind.name;
    ASSERT_EQ(read.readings.size(), 4u);
    EXPECT_EQ(read.readings[0].length, 1.25);
    EXPECT_EQ(read.readings[1].length, 0.1);
    EXPECT_FALSE(read.readings[0].sigma);
    EXPECT_EQ(read.readings[1].sigma, 0.02);
  }
}

TEST(Csv, LinesCountCommentsAndBlanks) {
  EXPECT_THAT(
      [] {
        read_poses({"p.csv", "# a\n\nx_mm,y_mm,z_mm\n# b\n1,2,3\n\n1,two,3\n"});
      },
      ThrowsMessage<InputFileError>(StartsWith("p.csv:7: expected a finite number in column y_mm, got \"two\"")));
}

/// Whatever joints and names are written, the same are read.
TEST(JointTable, WrittenTablesReadBack) {
  const bool held = rc::check("joint tables read back", [] {
    const auto name =
        *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::elementOf(std::string("aB 7,\"#;<>'\\"))));
    RC_PRE(name.front() != ' ' && name.back() != ' ');
    const auto micro_degrees = *rc::gen::container<std::vector<int>>(4, rc::gen::arbitrary<int>());
    Joints joints(4);
    for (int i = 0; i < 4; ++i) joints(i) = to_radians(micro_degrees[static_cast<std::size_t>(i)] * 1e-6);
    const auto again = read_joints({"j.csv", joint_table_header(4) + joint_table_row({name, joints})}, 4);
    RC_ASSERT(again.size() == 1u);
    RC_ASSERT(again[0].name == name);
    RC_ASSERT((again[0].joints - joints).cwiseAbs().maxCoeff() <= 1e-15 * joints.cwiseAbs().maxCoeff());
  });
  EXPECT_TRUE(held);
}

/// A spreadsheet computes what begins with these, and a name may be a command.
TEST(JointTable, NamesAreNoFormulas) {
  struct Name {
    std::string name, cell;
  };
  const std::vector<Name> names{{"=1+1", "'=1+1"}, {"+x", "'+x"}, {"-cmd", "'-cmd"}, {"@SUM", "'@SUM"}, {"'=x", "''=x"},
                                {"-", "'-"},       {"'a", "'a"},  {"-5", "-5"},      {"+1e3", "+1e3"},  {"a=b", "a=b"}};
  std::string text = joint_table_header(3);
  for (const Name& one : names) text += joint_table_row({one.name, Joints::Constant(3, 0.5), {}});
  const std::vector<NamedJoints> rows = read_joints({"j.csv", text}, 3);
  ASSERT_EQ(rows.size(), names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    EXPECT_THAT(text, HasSubstr("\n" + names[k].cell + ","));
    EXPECT_EQ(rows[k].name, names[k].name);
  }
}

/// Random text never does worse than a complaint.
TEST(Csv, AnyTextIsReadOrRefused) {
  const bool held = rc::check("no crash on any text", [](const std::string& text) {
    try {
      (void)read_poses({"fuzz.csv", "x_mm,y_mm,z_mm\n" + text});
    } catch (const InputFileError&) {
    }
  });
  EXPECT_TRUE(held);
}

}  // namespace
}  // namespace paracal::io::tables_test

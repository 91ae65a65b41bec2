// Where an instrument's export holds what is needed, and how its points find their poses.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "paracal/error.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/io/points.hpp"

namespace paracal::io::export_columns_test {
namespace {

using testing::AllOf, testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not,
    testing::ThrowsMessage;

const std::vector<Station> kPoses{{"P1", {{0, 0, -888}}}, {"P2", {{100, 0, -888}}}};

struct Said {
  std::string columns = {}, unit = {};
  bool by_order = false;
  TableStyle style = {};
};

Measurements exported(const std::string& text, const Said& said = {}) {
  const TextFile file{"e.txt", text, said.style};
  return read_tracker_export(file, find_columns(file, said.columns, said.unit, said.by_order), kPoses);
}

/// The points of P1 and P2.
std::vector<Eigen::Vector3d> points(const std::string& text, const Said& said = {}) {
  const Measurements m = exported(text, said);
  std::vector<Eigen::Vector3d> points;
  for (const PointReading& reading : m.series.at(0).readings) {
    EXPECT_EQ(m.stations.at(reading.station).name, kPoses.at(points.size()).name);
    points.push_back(reading.point);
  }
  return points;
}

const Eigen::Vector3d kFirst(1031.5, -20.25, -88.125), kSecond(931.75, -20.5, -88);

void reads(const std::string& text, const Said& said = {}) {
  EXPECT_THAT(points(text, said), ElementsAre(kFirst, kSecond)) << text;
}

template <typename Complaint = InputFileError>
void refused(const std::string& text, const std::string& message, const Said& said = {}) {
  EXPECT_THAT([&] { (void)exported(text, said); }, ThrowsMessage<Complaint>(HasSubstr(message)));
}

TEST(ExportColumns, HeaderRowsSayWhereAndInWhichUnit) {
  reads("Target,X [mm],Y [mm],Z [mm]\nP1,1031.5,-20.25,-88.125\nP2,931.75,-20.5,-88\n");
  reads("Point Name;x_mm;y_mm;z_mm\nP1;1031,5;-20,25;-88,125\nP2;931,75;-20,5;-88\n");
  reads("label\tX (m)\tY (m)\tZ (m)\nP1\t1.0315\t-0.02025\t-0.088125\nP2\t0.93175\t-0.0205\t-0.088\n");
  reads("NAME Z_m Y_m X_m\nP1 -0.088125 -0.02025 1.0315\nP2 -0.088 -0.0205 0.93175\n");
  reads("pose,x_\xC2\xB5m,y_\xC2\xB5m,z_\xC2\xB5m\nP1,1031500,-20250,-88125\nP2,931750,-20500,-88000\n");
  reads("Name,X,Y,Z\nP1,1.0315,-0.02025,-0.088125\nP2,0.93175,-0.0205,-0.088\n", {.unit = "m"});
  reads("Name,X m,Y m,Z m\nP1,1.0315,-0.02025,-0.088125\nP2,0.93175,-0.0205,-0.088\n", {.unit = "m"});
  EXPECT_EQ(points("name,x [in],y [in],z [in],sigma [in]\nP1,1,2,3,0.5\n").at(0),
            Eigen::Vector3d(25.4, 2 * 25.4, 3 * 25.4));
  EXPECT_EQ(exported("name,x_mm,y_mm,z_mm,sigma_mm\nP1,1,2,3,0.5\n").series.at(0).readings.at(0).sigma, 0.5);
}

TEST(ExportColumns, WhatStandsAboveAndBesideIsNoted) {
  const Measurements m = exported(
      "// a program\nReport of Monday;;;;;\nOperator;N. N.;;;;\n\n"
      "Group;Target;X [mm];Y [mm];Z [mm];RMS\nA;P1;1;2;3;0,01\nA;P2;4;5;6;0,02\n");
  EXPECT_THAT(m.notes, ElementsAre("columns taken from the header row in line 5: Target, X [mm], Y [mm], Z [mm] "
                                   "(unit 1 mm); ignored: Group, RMS; the lines above it are ignored"));
  EXPECT_THAT(exported("name,x_m,y_m,z_m\nP1,1,2,3\nP2,4,5,6\n").notes,
              ElementsAre("columns taken from the header row in line 1: name, x_m, y_m, z_m (unit 1000 mm)"));
}

TEST(ExportColumns, AreSaidByHeadings) {
  const std::string text =
      "Name;Nominal X;Measured X [mm];Measured Y [mm];Measured Z [mm];Feature\n"
      "P1;0;1031.5;-20.25;-88.125;a\nP2;0;931.75;-20.5;-88;b\n";
  reads(text, {.columns = "name=Name,x=Measured X,y=measured y,z=Measured Z", .unit = "mm"});
  reads(text, {.columns = "x=Measured X,y=Measured Y,z=Measured Z [mm]"});
  refused(text, "expected a header row", {.columns = "x=Measured X,y=Measured Y,z=Measured W"});
  refused<InvalidArgument>(text, "either all numbers or all headings", {.columns = "name=1,x=Measured X,y=4,z=5"});
}

TEST(ExportColumns, MeasuredColumnsAreRecognised) {
  const std::string points = "P1,0,0,-888,1031.5,-20.25,-88.125\nP2,100,0,-888,931.75,-20.5,-88\n";
  for (const char* header :
       {"Point Name,Nominal X,Nominal Y,Nominal Z,Measured X [mm],Measured Y [mm],Measured Z [mm]",
        "Target,Nom X (mm),Nom Y (mm),Nom Z (mm),Meas X (mm),Meas Y (mm),Meas Z (mm)",
        "Name,X Nominal,Y Nominal,Z Nominal,X Actual (mm),Y Actual (mm),Z Actual (mm)",
        "point_name,x_nom_mm,y_nom_mm,z_nom_mm,x_meas_mm,y_meas_mm,z_meas_mm",
        "Target Name,Design X,Design Y,Design Z,X (Measured) [millimeters],Y (Measured) [millimeters],"
        "Z (Measured) [millimeters]",
        "Name,Reference X [m],Reference Y [m],Reference Z [m],Act. X(mm),Act. Y(mm),Act. Z(mm)",
        "Name,Dev X [mm],Dev Y [mm],Dev Z [mm],X [mm],Y [mm],Z [mm]"}) {
    reads(std::string(header) + "\n" + points);
  }
  EXPECT_THAT(exported("Name,Nominal X,Nominal Y,Nominal Z,Actual X [mm],Actual Y [mm],Actual Z [mm]\n" + points).notes,
              Contains(HasSubstr("Name, Actual X [mm], Actual Y [mm], Actual Z [mm] (unit 1 mm); ignored: Nominal X, "
                                 "Nominal Y, Nominal Z")));
  refused("Name,Nominal X [mm],Nominal Y [mm],Nominal Z [mm]\nP1,1,2,3\n",
          "expected a header row that names x, y and z");
  refused("Name,X [cm],Y [cm],Z [cm]\nP1,1,2,3\n", "expected a header row that names x, y and z");
}

/// An angle, a second point or an offset is not passed over unasked.
TEST(ExportColumns, OthersThatCouldChangeTheResultAreRefused) {
  const std::string points = "P1,1031.5,-20.25,-88.125,1,2,3\nP2,931.75,-20.5,-88,1,2,3\n",
                    head = "name,x_mm,y_mm,z_mm,";
  for (const char* others :
       {"rx_deg,ry_deg,rz_deg", "Rx [deg],Ry [deg],Rz [deg]", "Roll,Pitch,Yaw", "x2_mm,y2_mm,z2_mm", "A,B,C",
        "Offset,Radius,Probe", "phi_deg,u,v", "sigma_x,sigma_y,sigma_z"}) {
    const std::string first = std::string(others).substr(0, std::string(others).find(','));
    refused(head + others + "\n" + points, "e.txt:1: expected no column beside name, x, y, z and sigma");
    refused(head + others + "\n" + points, "\"" + first + "\"");
    TableStyle style;
    for (std::size_t k = 0, end = 0; end != std::string::npos; k = end + 1) {
      end = std::string(others).find(',', k);
      style.ignored_columns.push_back(std::string(others).substr(k, end - k));
    }
    reads(head + others + "\n" + points, {.style = style});
    style.ignored_columns.pop_back();
    refused(head + others + "\n" + points, "--ignore-columns", {.style = style});
  }
  for (const char* others : {"Date,Comment,Deviation", "Nominal X,Nominal Y,Nominal Z", "dX,dY,dZ", "No,RMS,Time",
                             "Dev 3D,Tol,Temperature"}) {
    EXPECT_THAT(exported(head + others + "\n" + points).notes, ElementsAre(HasSubstr("; ignored: ")));
  }
  reads(head + "Operator\nP1,1031.5,-20.25,-88.125,N. N.\nP2,931.75,-20.5,-88,\n");  // words change nothing
}

TEST(ExportColumns, AmbiguousHeaderRowsSayWhichColumnsToGive) {
  const std::string points = "P1,0,0,-888,1031.5,-20.25,-88.125\nP2,100,0,-888,931.75,-20.5,-88\n";
  const std::string two_kinds = "Name,X,Y,Z,Measured X,Measured Y,Measured Z\n" + points;
  refused(two_kinds,
          "e.txt:1: expected one column of x in the header row, got \"X\" (column 2) and \"Measured X\" (column 5); "
          "choose with --columns, e.g. --columns 'name=Name,x=Measured X,y=Measured Y,z=Measured Z'");
  reads(two_kinds, {.columns = "name=Name,x=Measured X,y=Measured Y,z=Measured Z", .unit = "mm"});
  const std::string same_words = "Point,X [mm],Y [mm],Z [mm],X [mm],Y [mm],Z [mm]\n" + points;
  refused(same_words,
          "got \"X [mm]\" (column 2) and \"X [mm]\" (column 5); choose with --columns, e.g. --columns "
          "name=1,x=2,y=3,z=4 --unit mm");
  reads(same_words, {.columns = "name=1,x=5,y=6,z=7", .unit = "mm"});
  refused("Name,Measured X,Actual X,Y,Z\nP1,1,1,2,3\n", "got \"Measured X\" (column 2) and \"Actual X\" (column 3)",
          {.unit = "mm"});
}

TEST(ExportColumns, HeaderRowsThatDoNotSayItAreRefused) {
  refused("Name,X,Y,Z\nP1,1,2,3\n",
          "e.txt:1: expected a unit in the header row, as in \"X [mm]\", a line \"Units: mm\" above it, or --unit");
  refused("Name,X [mm],Y [mm],Z\nP1,1,2,3\n",
          "e.txt:1: expected the same unit for \"X [mm]\" and \"Z\", got two units");
  refused("Name,X [mm],Y [mm],Z [mm]\nP1,1,2,3\n", "e.txt:1: expected --unit as in the header row (1 mm), got 25.4 mm",
          {.unit = "inch"});
  refused(
      "Name,Target,X_mm,Y_mm,Z_mm\nP1,1,1,2,3\n",
      "expected one column of name in the header row, got \"Name\" (column 1) and \"Target\" (column 2); choose with "
      "--columns, e.g. --columns 'name=Name,x=X_mm,y=Y_mm,z=Z_mm'");
  refused(
      "X_mm,Y_mm,Z_mm\n1,2,3\n",
      "expected one column of name in the header row, got none; choose it with --columns, or take the points in the "
      "order of the poses with --match order");
  refused("Name,X_mm,X_mm,Y_mm,Z_mm\nP1,1,1,2,3\n",
          "expected one column of x in the header row, got \"X_mm\" (column 2) and \"X_mm\" (column 3)");
  refused("// Name X Y Z\nP1 1 2 3\n",
          "e.txt: expected a header row that names x, y and z, or from, to and distance_mm, got none", {.unit = "mm"});
  refused<InvalidArgument>("P1 1 2 3\n", "unit: expected mm, m, um or inch, got none",
                           {.columns = "name=1,x=2,y=3,z=4"});
  refused<InvalidArgument>("P1 1 2 3\n", "unit: expected mm, m, um or inch, got \"foot\"",
                           {.columns = "name=1,x=2,y=3,z=4", .unit = "foot"});
}

TEST(ExportColumns, OfSpatialAnalyzer) {
  const Said said{.columns = std::string(kSpatialAnalyzer), .unit = "m"};
  reads(
      "// frame: instrument\n\"Set A\" Points P1 1.0315 -0.02025 -0.088125\n\"Set A\" Points P2 0.93175 -0.0205 "
      "-0.088\n",
      said);
  reads("Points,P1,1.0315,-0.02025,-0.088125\nPoints,P2,0.93175,-0.0205,-0.088\n", said);
  reads("P1 1.0315 -0.02025 -0.088125\nP2 0.93175 -0.0205 -0.088\n", said);
  refused("1.0315 -0.02025 -0.088125\n", "e.txt:1: expected [[collection] group] target x y z, got 3 fields", said);
  refused("A Points P1 1 2 3 0.01\n", "got 7 fields: choose columns with --columns", said);
  refused("A P1 1 2 3\nA Points P1 1 2 3\n", "e.txt:2: expected 5 fields as in line 1, got 6", said);
  refused("// nothing\n", "expected at least one line with a point", said);
  refused<InvalidArgument>("P1 1 2 3\n", "unit:", {.columns = std::string(kSpatialAnalyzer)});
}

/// With numbers first lines are passed over where they can be no point; a point with a fault is none of them.
TEST(ExportColumns, FirstLinesWithoutCoordinatesArePassedOver) {
  const Said said{.columns = "name=1,x=2,y=3,z=4", .unit = "mm"};
  const Measurements m = exported("Report\nNo. 7, of Monday\nName;X;Y;Z\nP1;1;2;3\nP2;4;5;6\n", said);
  EXPECT_EQ(m.series.at(0).readings.size(), 2u);
  EXPECT_THAT(m.notes, ElementsAre("lines up to 3 have no coordinates and are ignored"));
  refused("P1;1;oops;3\nP2;4;5;6\n", "e.txt:1: expected a finite number in column 3 (y), got \"oops\"", said);
  refused("P1;;;\nP2;4;5;6\n", "e.txt:1: expected", said);
  refused("Name;X;Y;Z\n", "expected at least one line with a point", said);
}

TEST(ExportColumns, SeparatorsBehindTheLastColumnDoNotCount) {
  reads("P1;1031,5;-20,25;-88,125;;\nP2;931,75;-20,5;-88;\n", {.columns = "name=1,x=2,y=3,z=4", .unit = "mm"});
  refused("P1;1;2;3;a;\nP2;4;5;6\n", "e.txt:2: expected 5 fields", {.columns = "name=1,x=2,y=3,z=4", .unit = "mm"});
}

TEST(ExportColumns, DecimalCommas) {
  const Said said{.columns = "name=1,x=2,y=3,z=4", .unit = "mm"};
  reads("P1;1031,5;-20,25;-88,125\nP2;931,75;-20,5;-88\n", said);
  Said asked = said;
  asked.style.decimal_comma = true;
  reads("P1 1031,5 -20,25 -88,125\nP2 931,75 -20,5 -88\n", asked);  // then commas do not separate
  EXPECT_EQ(points("P1;1,125;2;3\nP2;4;5;6\n", asked).at(0).x(), 1.125);
  refused("P1;1,125;2;3\nP2;4;5;6\n",
          "e.txt:1: expected a finite number in column 2 (x), got \"1,125\" (1.125 or 1125?", said);
}

TEST(ExportColumns, PointsAreMatchedByOrderWhereThatIsAsked) {
  const Said said{.by_order = true};
  reads("X_mm;Y_mm;Z_mm\n1031.5;-20.25;-88.125\n931.75;-20.5;-88\n", said);
  reads("No;Name;X_mm;Y_mm;Z_mm\n1;m7;1031.5;-20.25;-88.125\n2;m7;931.75;-20.5;-88\n", said);
  reads("1031.5 -20.25 -88.125\n931.75 -20.5 -88\n", {.columns = "x=1,y=2,z=3", .unit = "mm", .by_order = true});
  EXPECT_THAT(exported("X_mm;Y_mm;Z_mm\n1;2;3\n4;5;6\n", said).notes,
              Contains("2 points are assigned to the 2 poses in order; their names are ignored"));
  const std::string counts =
      "e.txt: expected 2 points in the order of the 2 poses, or 4, 6, ... for several passes over them, got ";
  const std::string todo = "; add or remove points, or match by name";
  refused("X_mm;Y_mm;Z_mm\n1;2;3\n", counts + "1" + todo, said);
  refused("X_mm;Y_mm;Z_mm\n1;2;3\n4;5;6\n7;8;9\n", counts + "3" + todo, said);
  refused("Name;X_mm;Y_mm;Z_mm\nm1;1;2;3\nm2;4;5;6\n", "got only m1, m2: rename them, or assign them in order");
}

TEST(ExportColumns, SeveralPassesByOrderAreRepeats) {
  const Said said{.by_order = true};
  const Measurements m = exported("X_mm;Y_mm;Z_mm\n1;2;3\n40;50;60\n1.1;2;3\n40.1;50;60\n1.2;2;3\n40.2;50;60\n", said);
  EXPECT_THAT(m.notes,
              Contains("6 points are assigned to 3 passes over the 2 poses in order; their names are ignored"));
  ASSERT_EQ(m.stations.size(), 2u);
  std::vector<std::pair<std::string, double>> read;
  for (const PointReading& one : m.series.at(0).readings) {
    read.emplace_back(m.stations[one.station].name, one.point.x());
  }
  using Read = std::pair<std::string, double>;
  EXPECT_THAT(read, ElementsAre(Read("P1", 1), Read("P2", 40), Read("P1", 1.1), Read("P2", 40.1), Read("P1", 1.2),
                                Read("P2", 40.2)));
  refused(
      "X_mm;Y_mm;Z_mm\n1;2;3\n1.1;2;3\n40;50;60\n40.1;50;60\n",
      "e.txt:3: expected 2 passes over the 2 poses, one after the other, got the repeats of each pose together; sort "
      "the points by pass",
      said);
  refused("X_mm;Y_mm;Z_mm\n1;2;3\n4;5;6\n1;2;3\n4;5;6\n7;8;9\n", "got 5; add or remove points", said);
}

TEST(ExportColumns, BytesOfLatin1AreReadWithANote) {
  const Measurements m = exported(
      "Gr\xF6\xDF"
      "e;Name;X_mm;Y_mm;Z_mm\n\xE4;P1;1;2;3\n\xE4;P\xE4;4;5;6\n");
  EXPECT_THAT(m.notes,
              AllOf(Contains(HasSubstr("; ignored: Gr\xC3\xB6\xC3\x9F"
                                       "e")),
                    Contains(HasSubstr("line 2: bytes")), Contains("line 3: P\xC3\xA4 is not a pose and is ignored")));
}

TEST(ExportColumns, FilesAreKnownForExports) {
  const auto kind = [](const std::string& text, bool has_poses) { return kind_of_table({"e", text}, has_poses); };
  using enum TableKind;
  EXPECT_EQ(kind("// by a program\nP1 1 2 3\n", true), exported);
  EXPECT_EQ(kind("Report\nTarget;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n", true), exported);
  EXPECT_EQ(kind("Target;X [mm];Y [mm];Z [mm]\nP1;1;2;3\n", false), exported);
  EXPECT_EQ(kind("pose,x_mm,y_mm,z_mm\nP1,1,2,3\n", true), exported);
  EXPECT_EQ(kind("pose,x_mm,y_mm,z_mm\nP1,1,2,3\n", false), points);  // which says what is missing
  EXPECT_EQ(kind("pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\n", true), points);
  EXPECT_EQ(kind("pose,x_mm,y_mm,z_mm,qw,qx,qy,qz\n", true), exported);
  EXPECT_EQ(kind("pose,x_cmd_mm,x_mm,y_mm,z_mm,qw,qx,qy,qz\n", true), points);
  EXPECT_EQ(kind("from;to;distance_mm\n", true), distances);
  EXPECT_EQ(kind("pose\theight_mm\n", true), lengths);
}

}  // namespace
}  // namespace paracal::io::export_columns_test

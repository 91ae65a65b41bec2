// Exports in the forms of instruments' and inspection programs' own: each is read without an option.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "paracal/error.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/units.hpp"

namespace paracal::io::vendor_exports_test {
namespace {

using testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::ThrowsMessage;

const TextFile kPoses{"p.csv", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm\nP1,0,0,-888\nP2,100,0,-888\n"};

Measurements read(const std::string& text) { return read_measurements({{"e.txt", text}}, {kPoses}); }

const Eigen::Vector3d kFirst(1031.5, -20.25, -88.125), kSecond(931.75, -20.5, -88);

void reads(const std::string& text) {
  const Measurements m = read(text);
  std::vector<Eigen::Vector3d> points;
  for (const PointReading& reading : m.series.at(0).readings) points.push_back(reading.point);
  EXPECT_THAT(points, ElementsAre(kFirst, kSecond)) << text;
}

void refused(const std::string& text, const std::string& message) {
  EXPECT_THAT([&] { (void)read(text); }, ThrowsMessage<InputFileError>(HasSubstr(message))) << text;
}

TEST(VendorExports, NamesInColumnsOfOtherHeadings) {
  for (const char* name : {"Object", "Object Name", "Point ID", "PointID", "Feature", "Feature Name", "Feature ID",
                           "Target ID", "Punktname", "Bezeichnung", "Merkmal", "ID", "Nr"}) {
    reads(std::string(name) + ";X [mm];Y [mm];Z [mm]\nP1;1031.5;-20.25;-88.125\nP2;931.75;-20.5;-88\n");
  }
  // The likeliest word counts.
  reads("No,Label,Feature,X (mm),Y (mm),Z (mm)\n1,P1,a,1031.5,-20.25,-88.125\n2,P2,a,931.75,-20.5,-88\n");
  reads("ID,Object,X (mm),Y (mm),Z (mm)\n1,P1,1031.5,-20.25,-88.125\n2,P2,931.75,-20.5,-88\n");
  refused("Object,Feature,X_mm,Y_mm,Z_mm\nP1,a,1,2,3\n", "got \"Object\" (column 1) and \"Feature\" (column 2)");
}

TEST(VendorExports, UnitsBesideTheHeadings) {
  const std::string points = "P1\t1031.5\t-20.25\t-88.125\nP2\t931.75\t-20.5\t-88\n", head = "Feature\tX\tY\tZ\n";
  for (const char* above : {"Units: Millimeters", "Length Unit: mm\tAngle Unit: deg", "// units mm", "\"Units\",\"mm\"",
                            "Einheit;mm", "Unit\xE9s: mm", "# Length Units,Millimeters"}) {
    reads(std::string("A program\n") + above + "\n\n" + head + points);
  }
  reads("A program\n" + head + "\t[mm]\t[mm]\t[mm]\n" + points);
  reads("Name\tX-Wert\tY-Wert\tZ-Wert\tEinheit\nP1\t1031.5\t-20.25\t-88.125\tmm\nP2\t931.75\t-20.5\t-88\tmm\n");
  EXPECT_THAT(read("Units: Inches\n" + head + points).notes, Contains(HasSubstr("(unit 25.4 mm, stated in line 1)")));
  for (const char* above : {"Angle Unit: deg", "Unit M12", "Units: furlong", "All values in mm", "mm"}) {
    refused(above + ("\n" + head) + points, "expected a unit in the header row");
  }
  refused("Units: mm\nUnits: inch\n" + head + points, "e.txt:2: expected one unit of length above the points");
  refused("Name\tX\tY\tZ\tUnit\nP1\t1\t2\t3\tmm\nP2\t4\t5\t6\tinch\n",
          "e.txt:3: expected the unit of line 2 in column");
}

/// Rulers, titles, time stamps, what the instrument computed besides, and the letters of Latin-1.
TEST(VendorExports, WhatStandsAroundThePoints) {
  reads(
      "Name      X(mm)     Y(mm)     Z(mm)\n-----------------------\nP1   1031.5 -20.25 -88.125\nP2  931.75 -20.5 "
      "-88\n");
  reads(
      "Me\xDFprotokoll M\xFCller\nGer\xE4t: Tracker; Temperatur: 20,1 \xB0"
      "C\nPunktname;X [mm];Y [mm];Z [mm];Datum;Uhrzeit;Pr\xFC"
      "fer\nP1;1031,5;-20,25;-88,125;29.11.2026;10:00:32;M\xFCller\nP2;931,75;-20,5;-88,0;29.11.2026;10:01:32;"
      "M\xFCller\n");
  reads(
      "Nom du point;X mesur\xE9 (mm);Y mesur\xE9 (mm);Z mesur\xE9 (mm);\xC9"
      "cart\nP1;1031,5;-20,25;-88,125;0,1\nP2;931,75;-20,5;-88,0;0,1\n");
  reads(
      "Target ID,X(mm),Y(mm),Z(mm),Azimuth (deg),Elevation (deg),Range (mm),SNR (dB),Timestamp\n"
      "P1,1031.5,-20.25,-88.125,1,2,1035.5,45,2026-11-29T10:00:32Z\nP2,931.75,-20.5,-88,1,2,936.1,45,2026-11-29T10:"
      "01Z\n");
}

/// Names in Latin-1 match names in UTF-8.
TEST(VendorExports, LettersOfNames) {
  const TextFile poses{"p.csv",
                       "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm\nPr\xC3\xBC"
                       "f 1,0,0,-888\n"};
  const TextFile table{"e.txt",
                       "Name;X [\xB5m];Y [\xB5m];Z [\xB5m]\nPr\xFC"
                       "f 1;1031500;-20250;-88125\n"};
  const Measurements m = read_measurements({table}, {poses});
  EXPECT_EQ(m.series.at(0).readings.at(0).point, kFirst);
}

TEST(VendorExports, SpatialAnalyzerWithTimeStamps) {
  const std::string head =
      "// SpatialAnalyzer 2023.1\n// Units: Millimeters\n//Collection, Group, Target, X, Y, Z, Time\n";
  reads(head +
        "A, Home, P1, 1031.5, -20.25, -88.125, 11/29/2026 10:15:32 AM\n"
        "A, Home, P2, 931.75, -20.5, -88, 11/29/2026 10:16:32 AM\n");
  reads(head +
        "\"A\" \"Home\" \"P1\" 1031.5 -20.25 -88.125 2026-11-29 10:15:32\n"
        "\"A\" \"Home\" \"P2\" 931.75 -20.5 -88 2026-11-29 10:16:32\n");
  reads(head + "A::Home::P1 1031.5 -20.25 -88.125\nA::Home::P2 931.75 -20.5 -88\n");
  refused(head + "A, Home, P1, 1, 2, 3, 0.01\n", "expected [[collection] group] target x y z, got 7 fields");
  EXPECT_THAT(read(head + "P1 1 2 3\nP2 4 5 6\n").notes, Contains("the unit, 1 mm, is stated in line 2"));
}

/// Inspection programs write one line per coordinate.
TEST(VendorExports, OneLinePerCoordinate) {
  reads(
      "Units: "
      "mm\nObject,Control,Nom,Meas,Dev\nP1,X,1032,1031.5,-0.5\nP1,Y,-20,-20.25,0\nP1,Z,-88,-88.125,0\nP1,3D,0,1,1\n"
      "P2,Z,-88,-88,0\nP2,Y,-20,-20.5,0\nP2,X,930,931.75,0\n");
  reads(
      "planid\tid\ttype\tactual\tnominal\tunit\nD\tP1.X\txValue\t1031.5\t1\tmm\nD\tP1.Y\tyValue\t-20.25\t1\tmm\n"
      "D\tP1.Z\tzValue\t-88.125\t1\tmm\nD\tP2.X\txValue\t931.75\t1\tmm\nD\tP2.Y\tyValue\t-20.5\t1\tmm\nD\tP2."
      "Z\tzValue\t-88\t1\tmm\n");
  reads(
      "Feature ID;Axis;Nominal;Measured "
      "[mm]\nP1;X;1;1031,5\n;Y;1;-20,25\n;Z;1;-88,125\nP2;X;1;931,75\n;Y;1;-20,5\n;Z;1;-88,0\n");
  const std::string head = "Feature ID,Axis,Measured [mm]\nP1,X,1\nP1,Y,2\nP1,Z,3\n";
  refused(head + "P2,X,4\nP2,Y,5\n", "e.txt:5: expected x, y and z of point P2, got no z");
  refused(head + "P2,X,4\nP2,Y,many\nP2,Z,6\n", "e.txt:5: expected a finite number in column 3 (y), got \"many\"");
  refused("Feature ID,Axis,Nominal\nP1,X,1\nP1,Y,2\nP1,Z,3\n", "expected a header row that names x, y and z");
}

/// Instrument = rotation * body, as a quaternion or as a product that a comment states.
TEST(VendorExports, OrientationsOfABody) {
  const Quaternion turned(std::cos(0.5), 0, 0, std::sin(0.5));  // 1 rad about z
  const auto orientation = [](const std::string& head, const std::string& numbers) {
    return read(head + "\nP1;1;2;3;" + numbers + "\nP2;4;5;6;" + numbers + "\n")
        .series.at(0)
        .readings.at(0)
        .orientation;
  };
  for (const char* head :
       {"Name;X [mm];Y [mm];Z [mm];qw;qx;qy;qz", "Name;X [mm];Y [mm];Z [mm];q0;q1;q2;q3",
        "Name;Position X (mm);Position Y (mm);Position Z (mm);Rotation W;Rotation X;Rotation Y;Rotation Z"}) {
    ASSERT_TRUE(orientation(head, "0.8775825618903728;0;0;0.479425538604203")) << head;
    EXPECT_LT(orientation(head, "0.8775825618903728;0;0;0.479425538604203")->angularDistance(turned), 1e-12);
  }
  const auto matrix = [&](const std::string& comment, const std::string& columns, const std::string& numbers) {
    return orientation(comment + "\nName;X [mm];Y [mm];Z [mm];" + columns, numbers)->toRotationMatrix();
  };
  const auto about = [](double deg, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(to_radians(deg), axis).toRotationMatrix();
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const auto is = [](const Eigen::Matrix3d& one, const Eigen::Matrix3d& other) { return (one - other).norm() < 1e-12; };
  EXPECT_TRUE(
      is(matrix("# angles: Rz Ry Rx", "rx_deg;ry_deg;rz_deg", "10;20;30"), about(30, z) * about(20, y) * about(10, x)));
  EXPECT_TRUE(is(matrix("// Angles: R = Rx * Ry * Rz", "Rx [deg];Ry [deg];Rz [deg]", "10;20;30"),
                 about(10, x) * about(20, y) * about(30, z)));
  EXPECT_TRUE(is(matrix("# angles: Rz(a) Ry(b) Rx(c)", "A [deg];B [deg];C [deg]", "10;20;30"),
                 about(10, z) * about(20, y) * about(30, x)));
  EXPECT_TRUE(is(matrix("# angles: Rz(o) Ry(a) Rz(t)", "O (deg);A (deg);T (deg)", "10;20;30"),
                 about(10, z) * about(20, y) * about(30, z)));
  EXPECT_TRUE(is(matrix("# angles: Rx Ry Rz", "rx_rad;ry_rad;rz_rad", "0.1;0;0"), about(to_degrees(0.1), x)));

  const std::string points = "\nP1;1;2;3;10;20;30\n", head = "Name;X [mm];Y [mm];Z [mm];";
  refused(head + "rx_deg;ry_deg;rz_deg" + points, "with a comment \"# angles: Rz Ry Rx\"");
  refused("# angles: Euler\n" + head + "rx_deg;ry_deg;rz_deg" + points,
          "e.txt:1: expected a product of three rotations");
  refused("# angles: Rz Rz Rx\n" + head + "rx_deg;ry_deg;rz_deg" + points, "got \"rz rz rx\"");
  refused("# angles: Rz Ry Rx\n" + head + "rx;ry;rz" + points,
          "e.txt:2: expected one column \"rz [deg]\", rz_deg or rz_rad");
  refused("# angles: Rz Ry Rx\n" + head + "rx_deg;ry_deg;rz_deg\nP1;1;2;3;10;;30\n",
          "in column 6 (orientation), got \"\"");
  refused(head + "qw;qx;qy;qz\nP1;1;2;3;1;1;0;0\n", "expected a unit quaternion, got length 1.41421");
}

/// A file of no known form is not said to be one of distances.
TEST(VendorExports, ForeignHeadersAreNoDistances) {
  refused("Station;Easting;Northing;Height\nP1;1;2;3\n",
          "expected a header row that names x, y and z, or from, to and distance_mm");
  EXPECT_EQ(kind_of_table({"e", "from,to,distance\nP1,P2,3\n"}, true), TableKind::distances);
}

}  // namespace
}  // namespace paracal::io::vendor_exports_test

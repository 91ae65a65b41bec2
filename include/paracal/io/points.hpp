#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"

namespace paracal::io {

/// Point table (CSV): pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm and optional repeat, phi_deg,
/// x2_mm,y2_mm,z2_mm, sigma_mm, q1_deg... or q1_mm... With qw,qx,qy,qz and optional sigma_deg the points are those of a
/// body on the plate, without a second point. It becomes one series, named after the file. A missing
/// column phi_cmd_deg is 0. Rows of the same pose are repeats of one station. Blank and repeated values are ignored,
/// with a note:
///
///   x_mm, y_mm, z_mm blank       no reading; a station without any is omitted
///   phi_deg or x2_mm... blank    not measured there
///   qw, qx, qy, qz blank         no reading, because the point alone does not determine the plate
///   the same numbers again       one reading if the pose is the same, else two; a note in both cases
///
/// @param joints  joint columns, if present, must be these.
/// @throws InputFileError for anything else, such as two rows of one pose with different commands, a partly blank
/// point, or a quaternion that is not a rotation.
Measurements read_points(const TextFile& file, const JointSpace& joints = {});

/// Several measurements as one, each series in its own frame. Stations with equal name, commanded pose and commanded
/// joints are one station. A later station with an equal name only becomes "series:name". The first home
/// stays first. Readings that repeat an earlier series exactly count once, with a note.
/// @throws InvalidArgument for no measurements, or a reading without a station.
Measurements merge(std::vector<Measurements> parts);

/// Where an export states the orientation of a body, instrument = rotation * body.
struct OrientationColumns {
  std::vector<std::size_t> columns = {};  ///< from 1: qw, qx, qy, qz; or three angles
  std::array<int, 3> axes{};              ///< angles: R is the product of rotations about them (0 to 2: x to z)
  std::array<double, 3> rad_per_unit{};   ///< of the angles
};

/// Columns of an instrument export. Columns count from 1; 0 is none.
struct ColumnMap {
  std::size_t name = 0;
  std::size_t x = 0, y = 0, z = 0;
  std::optional<std::size_t> sigma = {};  ///< standard deviation of each coordinate, in the unit of the coordinates
  std::optional<OrientationColumns> orientation = {};
  double mm_per_unit = 0.0;
  int data_after = 0;             ///< line of a header row: lines up to it are not points
  bool by_order = false;          ///< points are in the order of the poses, once or in several passes
  bool is_by_coordinate = false;  ///< one line per coordinate, three per point; the columns are those of the points
  std::vector<std::string> notes = {};  ///< how the columns were found
};

/// @param columns  e.g. "name=3,x=4,y=5,z=6" or "name=1,x=2,y=3,z=4,sigma=5".
/// @param unit     "mm", "m", "um" or "inch".
/// @throws InvalidArgument for anything else.
ColumnMap parse_column_map(std::string_view columns, std::string_view unit);

/// `columns` for "[collection, group,] target, x, y, z[, time stamp]": points exported by SpatialAnalyzer without a
/// header row.
inline constexpr std::string_view kSpatialAnalyzer = "spatialanalyzer";

/// Finds the columns of a file: by numbers, or by the headings of a header row. That is the first line that names x, y
/// and z ("X", "x_mm", "Y [mm]", "Measured Z (inch)"; upper or lower case). Without one, a header row with a name and a
/// measured value counts if the lines below it have one coordinate each. Comments that name SpatialAnalyzer stand for
/// kSpatialAnalyzer.
/// @param columns   as for parse_column_map; the same with headings, "name=Target,x=Measured X"; kSpatialAnalyzer; or
///                  empty: the headings x, y, z and a name (name, point, target, object, feature, point id, ...).
/// @param unit      as for parse_column_map; empty if the file states it: in the headings, in a row below or in a line
///                  above them, or in a column of units.
/// @param by_order  points need no names.
/// @throws InvalidArgument for other columns or units. InputFileError for a missing header row, or one that names a
/// column twice, states several units or another one than `unit`.
ColumnMap find_columns(const TextFile& file, std::string_view columns, std::string_view unit, bool by_order = false);

/// Whether a line names x, y and z.
bool has_export_header(const TextFile& file);

/// Points that an instrument exported as text, one per line. Lines that begin with // or # are comments. First lines
/// without coordinates are ignored, with a note. Fields are separated by tabs,
/// semicolons, commas or blanks: by the first of these in a line outside quotation marks. Every line has the same
/// number of fields, so a name with a blank cannot shift the columns unnoticed. Decimals: see DecimalSign.
///
/// Points belong to the poses by order if requested (then there are as many), else by name. Names that are not a pose
/// (reference points) and poses without a point are noted. A repeated name is a repeat; with equal numbers it is one
/// reading, with a note.
/// @param poses  the first is home, if it was measured.
/// @throws InputFileError for a line without the columns or without finite numbers in them, for a point far from the
/// others, or when no name is a pose.
/// @throws InvalidArgument when `columns` is incomplete.
Measurements read_tracker_export(const TextFile& file, const ColumnMap& columns, const std::vector<Station>& poses,
                                 const JointSpace& joints = {});

/// One series of points as CSV for read_points(), with the optional columns that are needed. Numbers from a file are
/// read back unchanged. Readings that are equal to the last bit, such as those of a simulated machine without noise,
/// then count once.
/// @throws InvalidArgument unless there is exactly one series with readings; if commanded joints are stated for some
/// stations only; and for numbers and names that would not be read back.
std::string point_table(const Measurements& measurements, Actuator actuator = Actuator::revolute);

/// The distances as CSV for read_distances(), the lengths of one setup as CSV for read_lengths().
/// @throws InvalidArgument for names that would not be read back, and for more or fewer setups of lengths than one.
std::string distance_table(const Measurements& measurements);
std::string length_table(const Measurements& measurements);

/// The commanded poses as CSV for read_poses().
/// @throws InvalidArgument for names that would not be read back.
std::string station_table(const std::vector<Station>& stations);

}  // namespace paracal::io

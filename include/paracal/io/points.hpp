#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"

namespace paracal::io {

/// Point table (CSV): pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm and optional repeat, phi_deg,
/// x2_mm,y2_mm,z2_mm, sigma_mm, q1_deg... or q1_mm... With qw,qx,qy,qz and optional sigma_deg the points are those of a
/// body that stands on the plate, and have no second point. It becomes one series, named after the file. A missing
/// column phi_cmd_deg is 0. Rows of the same pose are repeats of one station. What was not read is passed over and
/// noted:
///
///   x_mm, y_mm, z_mm blank       no reading; a station without any is left out
///   phi_deg or x2_mm... blank    not read there
///   qw, qx, qy, qz blank         no reading, for a body's point alone says nothing of the plate
///   the same numbers again       one reading where the pose is the same, two where it is another; a note either way
///
/// @param joints  where joint columns stand, they must be these.
/// @throws InputFileError for anything else, as two rows of one pose that are commanded differently, a point that is
/// blank in part, or a quaternion that is no rotation's.
Measurements read_points(const TextFile& file, const JointSpace& joints = {});

/// Several measurements as one, each series in its own frame. A station that has the name, commanded pose and believed
/// joints of an earlier one is the same station; one that has the name alone becomes "series:name". The first home
/// stays first. Readings that stand in an earlier series too, number by number, are counted once, with a note.
/// @throws InvalidArgument for no measurements, or a reading of no station.
Measurements merge(std::vector<Measurements> parts);

/// Where the lines of an instrument's export hold what is needed. Columns count from 1; 0 is none.
struct ColumnMap {
  std::size_t name = 0;
  std::size_t x = 0, y = 0, z = 0;
  std::optional<std::size_t> sigma = {};  ///< standard deviation of each coordinate, in the unit of the coordinates
  double mm_per_unit = 0.0;
  int data_after = 0;                   ///< line of a header row: what stands down to there is no point
  bool by_order = false;                ///< points are in the order of the poses, once or in several passes
  std::vector<std::string> notes = {};  ///< how this was found
};

/// @param columns  e.g. "name=3,x=4,y=5,z=6" or "name=1,x=2,y=3,z=4,sigma=5".
/// @param unit     "mm", "m", "um" or "inch".
/// @throws InvalidArgument for anything else.
ColumnMap parse_column_map(std::string_view columns, std::string_view unit);

/// What `columns` may say for "[collection, group,] target, x, y, z": points as SpatialAnalyzer exports them, without a
/// header row.
inline constexpr std::string_view kSpatialAnalyzer = "spatialanalyzer";

/// Where a file holds what is needed: by numbers, or by the headings of a header row, which is the first line that
/// names x, y and z ("X", "x_mm", "Y [mm]", "Measured Z (inch)"; letters of either case).
/// @param columns   as of parse_column_map; the same with headings, "name=Target,x=Measured X"; kSpatialAnalyzer; or
///                  empty: the headings x, y, z and one of name, point, point name, target, label, pose.
/// @param unit      as of parse_column_map; empty where the header row states it.
/// @param by_order  points need no names.
/// @throws InvalidArgument for other columns or units, InputFileError for a header row that is missing, names a column
/// twice, states several units or another than `unit`.
ColumnMap find_columns(const TextFile& file, std::string_view columns, std::string_view unit, bool by_order = false);

/// Whether some line names x, y and z.
bool has_export_header(const TextFile& file);

/// Points that an instrument exported as text, one a line; lines that begin with // or # are comments, and first lines
/// without a number where coordinates are to stand are passed over, with a note. Fields are separated by tabs,
/// semicolons, commas or blanks: by the first of these that a line holds outside quotation marks. Every line has the
/// same number of fields, so that a name with a blank cannot shift the columns unseen. Decimals as DecimalSign tells.
///
/// Points are matched to the poses by order where that is asked for: one pass over all poses, or several, which are
/// repeats. Else by name. Names that are no pose (reference points) and poses that were not measured are noted. The
/// same name again is a repeat; with the same numbers again, one reading and a note.
/// @param poses  the first is home, if it was measured.
/// @throws InputFileError for a line without the columns, with anything but finite numbers in them or with a point that
/// is not among the others, or when no name is a pose.
/// @throws InvalidArgument when `columns` is incomplete.
Measurements read_tracker_export(const TextFile& file, const ColumnMap& columns, const std::vector<Station>& poses,
                                 const JointSpace& joints = {});

/// One series of points as the CSV that read_points() takes, with those optional columns that some reading needs. All
/// numbers that came from a file are read back as they were; only readings that are the same to the last bit, as those
/// of a virtual machine without noise, are then counted once.
/// @throws InvalidArgument when there is not exactly one series with readings, when stations' believed joints are
/// stated in part, or for numbers and names that would not be read back.
std::string point_table(const Measurements& measurements, Actuator actuator = Actuator::revolute);

/// The distances as the CSV that read_distances() takes, the lengths of one set-up as that of read_lengths().
/// @throws InvalidArgument for names that would not be read back, and for more or fewer set-ups of lengths than one.
std::string distance_table(const Measurements& measurements);
std::string length_table(const Measurements& measurements);

/// The commanded poses as the CSV that read_poses() takes.
/// @throws InvalidArgument for names that would not be read back.
std::string station_table(const std::vector<Station>& stations);

}  // namespace paracal::io

// Tables of poses, points, joints, distances and heights, instruments' exports, printers' readings, and the line that
// names a robot. A choice of '0' to ':' says which.

#include <sstream>

#include "fuzzing.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/printer_tables.hpp"
#include "paracal/io/robot_statement.hpp"
#include "paracal/io/tables.hpp"

namespace paracal::fuzz {
namespace {

const io::TextFile kPoses{"poses.csv",
                          "pose,x_mm,y_mm,z_mm,phi_deg\nP1,0,0,-888,0\nP2,500,0,-888,0\nP3,0,500,-888,0\n"};

void read_export(const io::TextFile& file, const std::string& columns, const std::string& unit) {
  (void)io::read_tracker_export(file, io::find_columns(file, columns, unit), io::read_poses(kPoses));
}

/// Bytes as they come from a file, UTF-16, too.
void read_rows(const std::string& bytes) {
  std::istringstream in(bytes);
  io::CsvStream table({"table.csv", in, {.decimal_comma = false, .ignored_columns = {"remark"}}});
  io::read_poses(table, {}, [](const Station&) {});
}

void read(const Input& input) {
  const io::TextFile file{"table.csv", input.text};
  switch ((input.choice - '0') % 11) {
    case 0:
      return (void)io::read_poses(file);
    case 1:
      return (void)io::read_points(file);
    case 2:
      return (void)io::read_joints(file, JointSpace(4));
    case 3:
      return (void)io::read_distances(file, kPoses);
    case 4:
      return (void)io::read_lengths(file, kPoses);
    case 5:
      return read_export(file, "name=1,x=2,y=3,z=4", "mm");
    case 6:
      return (void)io::read_printer_table(file, {});
    case 7:
      return (void)io::robot_of_table(file);
    case 8:
      return read_export(file, "", "");
    case 9:
      return read_export(file, std::string(io::kSpatialAnalyzer), "m");
    default:
      return read_rows(input.text);
  }
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return paracal::fuzz::run(data, size, paracal::fuzz::read);
}

// One table of everything a user can get wrong, and what the program must do about it: the exit code of the contract,
// a message that says where and what, nothing on standard output, no file left behind, no earlier result lost. The rows
// of the commands that plan, simulate, calibrate from points and validate are in broken_measurements_test.cpp.

#include "broken_input.hpp"

namespace paracal::test::broken_input_test {
namespace {

using testing::HasSubstr, testing::IsEmpty;

// Unbroken files. Lines are counted from the first key, so line numbers below can be checked against these texts.

const std::string kRobot = R"(name = "test"                                # line 1
[geometry]
base_radius_mm = 200
plate_radius_mm = 75
arm_mm = 375                                 # line 5
rod_mm = 950
parallelogram_width_mm = 100
limb_azimuth_deg = [-45, 45, 135, 225]
actuator = "revolute"
[plate]                                      # line 10
slide_axis = [0, -1, 0]
slide_sign = [1, 1, -1, -1]
pinion_radius_mm = 12
[workspace]
radius_mm = 500                              # line 15
height_mm = 250
top_z_mm = -763
rotation_deg = [-180, 180]
[tolerances]
theta_offset_deg = 1.5                       # line 20
e_mm = 1.5
distribution = "normal"
others = "generous"
)";

const std::string kRigidRobot = R"(name = "rigid"                               # line 1
[geometry]
base_radius_mm = 200
plate_radius_mm = 60
arm_mm = 400                                 # line 5
rod_mm = 950
parallelogram_width_mm = 100
limb_azimuth_deg = [0, 120, 240]
actuator = "revolute"
[workspace]                                  # line 10
radius_mm = 500
height_mm = 250
top_z_mm = -800
rotation_deg = [0, 0]
)";

const std::string kErrors = R"([[limb]]                                     # line 1
theta_offset_deg = 0.1
[[limb]]
e_mm = [0.1, 0.2, 0.3]
[[limb]]                                     # line 5
[[limb]]
alpha2_deg = 0.01
)";

const std::string kPoses =
    "# a comment in line 1\n"
    "pose,x_mm,y_mm,z_mm,phi_deg\n"
    "home,0,0,-888,0\n"
    "right,400,0,-888,0\n"
    "left,-400,0,-888,0\n";

const std::string kJoints =
    "pose,q1_deg,q2_deg,q3_deg,q4_deg\n"
    "a,-11,-12,-13,-12\n"
    "b,0,0,0,0\n";

const std::string kDistances =
    "from,to,distance_mm,sigma_mm\n"
    "home,right,399.5,0.05\n"
    "home,left,399.6,0.05\n";

const std::string kCalibration = R"({"format": "paracal calibration 1",
"accepted": true,
"robot": {"name": "huang2016",
  "geometry": {"base_radius_mm": 200, "plate_radius_mm": 75, "arm_mm": 375, "rod_mm": 950,
    "parallelogram_width_mm": 100, "limb_azimuth_deg": [-45, 45, 135, 225], "actuator": "revolute"},
  "plate": {"slide_axis": [0, -1, 0], "slide_sign": [1, 1, -1, -1], "pinion_radius_mm": 12}},
"parameters": [
  {"name": "theta_offset", "limb": 1, "value": 0.1, "unit": "deg"},
  {"name": "e_x", "limb": 4, "value": 0.2, "unit": "mm"}
]})";

const std::string kInverse = "inverse --poses poses.csv";
const std::string kForward = "forward --joints joints.csv";
const std::string kCalibrate = "calibrate --measurements distances.csv --poses poses.csv";

/// A robot file with one thing changed, and the message about it.
BrokenInput robot(std::string name, const std::string& old, const std::string& by, std::vector<std::string> message) {
  return {std::move(name),
          {{"robot.toml", replaced(kRobot, old, by)}},
          "robot --robot robot.toml",
          kBadInputFile,
          std::move(message)};
}

BrokenInput rigid_robot(std::string name, const std::string& old, const std::string& by,
                        std::vector<std::string> message) {
  return {std::move(name),
          {{"robot.toml", replaced(kRigidRobot, old, by)}},
          "robot --robot robot.toml",
          kBadInputFile,
          std::move(message)};
}

BrokenInput errors(std::string name, std::string text, std::vector<std::string> message) {
  return {std::move(name),
          {{"errors.toml", std::move(text)}, {"joints.csv", kJoints}},
          kForward + " --errors errors.toml",
          kBadInputFile,
          std::move(message)};
}

BrokenInput poses(std::string name, std::string text, std::vector<std::string> message) {
  return {std::move(name), {{"poses.csv", std::move(text)}}, kInverse, kBadInputFile, std::move(message)};
}

BrokenInput joints(std::string name, std::string text, std::vector<std::string> message) {
  return {std::move(name), {{"joints.csv", std::move(text)}}, kForward, kBadInputFile, std::move(message)};
}

BrokenInput distances(std::string name, std::string text, std::vector<std::string> message) {
  return {std::move(name),
          {{"distances.csv", std::move(text)}, {"poses.csv", kPoses}},
          kCalibrate,
          kBadInputFile,
          std::move(message)};
}

BrokenInput calibration(std::string name, std::string text, std::vector<std::string> message) {
  return {std::move(name),
          {{"calibration.json", std::move(text)}, {"poses.csv", kPoses}},
          kInverse + " --errors calibration.json",
          kBadInputFile,
          std::move(message)};
}

BrokenInput unreachable(std::string name, std::vector<NamedText> files, std::string command,
                        std::vector<std::string> message) {
  return {std::move(name), std::move(files), std::move(command), kMathematicsSaysNo, std::move(message)};
}

BrokenInput usage(std::string name, std::string command, std::vector<std::string> message) {
  return {std::move(name),
          {{"distances.csv", kDistances}, {"poses.csv", kPoses}, {"joints.csv", kJoints}},
          std::move(command),
          kWrongUsage,
          std::move(message)};
}

const std::vector<BrokenInput> kRobotFiles{
    robot("toml_syntax", "arm_mm = 375", "arm_mm = = 375", {"robot.toml:5: ", "expected TOML"}),
    robot("toml_open_text", "\"test\"", "\"test", {"robot.toml:1: ", "expected TOML"}),
    robot("key_twice", "rod_mm = 950", "arm_mm = 950", {"robot.toml:6: ", "arm_mm"}),
    robot("no_name", "name = \"test\"", "", {"robot.toml:", "expected name"}),
    robot("name_empty", "\"test\"", "\"\"", {"robot.toml:1: ", "name", "empty"}),
    robot("name_is_a_number", "\"test\"", "7", {"robot.toml:1: expected a text for name, got a number"}),
    robot("no_arm", "arm_mm = 375", "", {"robot.toml:2: ", "expected geometry.arm_mm", "got nothing"}),
    robot("no_geometry", "[geometry]", "[geometrie]", {"robot.toml:", "expected geometry"}),
    robot("geometry_is_a_number", "[geometry]", "geometry = 3\n[other]", {"robot.toml:2: ", "table for geometry"}),
    robot("no_workspace", "[workspace]", "[room]", {"robot.toml:", "expected workspace"}),
    robot("unknown_key", "rod_mm = 950", "rod_mm = 950\nrod_length = 3", {"robot.toml:7: ", "geometry.rod_length"}),
    robot("unknown_table", "[tolerances]", "[toleranzen]", {"robot.toml:19: ", "toleranzen", "tolerances"}),
    robot("arm_text", "arm_mm = 375", "arm_mm = \"375\"",
          {"robot.toml:5: expected a number for geometry.arm_mm, got a text"}),
    robot("arm_nan", "arm_mm = 375", "arm_mm = nan", {"robot.toml:5: ", "geometry.arm_mm", "nan"}),
    robot("arm_infinite", "arm_mm = 375", "arm_mm = inf", {"robot.toml:5: ", "geometry.arm_mm", "inf"}),
    robot("arm_negative", "arm_mm = 375", "arm_mm = -375",
          {"robot.toml:5: ", "geometry.arm_mm", "above 0 mm", "-375 mm"}),
    robot("rod_zero", "rod_mm = 950", "rod_mm = 0", {"robot.toml:6: ", "geometry.rod_mm", "above 0 mm", "got 0 mm"}),
    robot("width_of_another_robot", "parallelogram_width_mm = 100", "parallelogram_width_mm = 1e6",
          {"robot.toml:7: geometry.parallelogram_width_mm: expected a length", "compared with the other dimensions",
           "1e+06"}),
    robot("base_radius_next_to_nothing", "base_radius_mm = 200", "base_radius_mm = 1e-9",
          {"robot.toml:3: geometry.base_radius_mm: expected a length", "got 1e-09"}),
    robot("pinion_of_another_robot", "pinion_radius_mm = 12", "pinion_radius_mm = 1e308",
          {"robot.toml:13: plate.pinion_radius_mm: expected a length", "got 1e+308"}),
    robot("azimuth_beyond_turns", "[-45, 45, 135, 225]", "[-45, 45, 135, 1e8]",
          {"robot.toml:8: expected geometry.limb_azimuth_deg from -36000 to 36000 deg", "1e+08"}),
    robot("azimuth_is_a_number", "[-45, 45, 135, 225]", "45", {"robot.toml:8: expected an array of numbers"}),
    robot("azimuth_text", "[-45, 45, 135, 225]", "[-45, 45, \"x\", 225]",
          {"robot.toml:8: expected a number", "a text"}),
    robot("two_limbs_at_one_azimuth", "[-45, 45, 135, 225]", "[-45, 45, 135, 315]",
          {"robot.toml:8: ", "limbs 1 and 4", "315", "deg"}),
    robot("three_limbs_with_slide", "[-45, 45, 135, 225]", "[0, 120, 240]",
          {"robot.toml:8: ", "expected 4 limbs", "got 3"}),
    robot("five_limbs", "[-45, 45, 135, 225]", "[0, 72, 144, 216, 288]",
          {"robot.toml:8: ", "expected 4 limbs", "got 5"}),
    robot("no_limbs", "[-45, 45, 135, 225]", "[]", {"robot.toml:8: ", "expected 4 limbs", "got 0"}),
    robot("unknown_actuator", "\"revolute\"", "\"steam\"", {"robot.toml:9: ", "revolute", "steam"}),
    robot("slide_axis_zero", "[0, -1, 0]", "[0, 0, 0]", {"robot.toml:11: ", "slide_axis", "direction"}),
    robot("slide_axis_of_two", "[0, -1, 0]", "[0, -1]",
          {"robot.toml:11: expected 3 numbers for plate.slide_axis, got 2"}),
    robot("slide_sign_zero", "[1, 1, -1, -1]", "[1, 0, -1, -1]", {"robot.toml:12: ", "slide_sign", "+1 or -1, got 0"}),
    robot("slide_signs_equal", "[1, 1, -1, -1]", "[1, 1, 1, 1]", {"robot.toml:12: ", "slide_sign", "both signs"}),
    robot("slide_sign_missing", "[1, 1, -1, -1]", "[1, 1, -1]",
          {"robot.toml:12: ", "slide_sign", "one sign per limb (4), got 3"}),
    robot("pinion_negative", "pinion_radius_mm = 12", "pinion_radius_mm = -12",
          {"robot.toml:13: ", "pinion_radius_mm"}),
    robot("workspace_radius_negative", "radius_mm = 500", "radius_mm = -500",
          {"robot.toml:15: ", "workspace.radius_mm"}),
    robot("workspace_out_of_reach", "radius_mm = 500", "radius_mm = 900",
          {"robot.toml:14: ", "cannot reach", "rod_mm is 950"}),
    robot("workspace_above_base", "top_z_mm = -763", "top_z_mm = 763",
          {"robot.toml:17: ", "top_z_mm", "< 0 mm", "763 mm"}),
    robot("rotation_reversed", "[-180, 180]", "[180, -180]", {"robot.toml:18: ", "[smallest, largest]", "[180, -180]"}),
    robot("rotation_of_three", "[-180, 180]", "[-180, 0, 180]",
          {"robot.toml:18: ", "[smallest, largest]", "3 numbers"}),
    robot("tolerance_negative", "theta_offset_deg = 1.5", "theta_offset_deg = -1.5",
          {"robot.toml:20: ", "theta_offset_deg", "-1.5"}),
    robot("tolerance_e_negative", "e_mm = 1.5", "e_mm = -1.5", {"robot.toml:21: ", "e_mm", "-1.5"}),
    robot("tolerance_e_of_three", "e_mm = 1.5", "e_mm = [1, 1, 1]",
          {"robot.toml:21: ", "a number for tolerances.e_mm"}),
    robot("tolerance_unknown_key", "e_mm = 1.5", "e_x_mm = 1.5", {"robot.toml:21: ", "tolerances.e_x_mm"}),
    robot("unknown_distribution", "\"normal\"", "\"cauchy\"",
          {"robot.toml:22: ", "\"normal\" or \"uniform\"", "cauchy"}),
    rigid_robot("rigid_plate_that_rotates", "[0, 0]", "[-90, 90]",
                {"robot.toml:14: ", "a plate without a slide", "[-90, 90]"}),
    rigid_robot("rigid_plate_on_four_limbs", "[0, 120, 240]", "[0, 90, 180, 270]",
                {"robot.toml:8: ", "expected 3 limbs"}),
    {"robot_file_missing", {}, "robot --robot none.toml", kBadInputFile, {"none.toml: ", "No such file"}},
    {"robot_file_empty",
     {{"robot.toml", ""}},
     "robot --robot robot.toml",
     kBadInputFile,
     {"robot.toml:", "expected name"}},
    {"robot_file_is_a_folder", {}, "robot --robot ./", kBadInputFile, {"expected a file, got a folder"}},
    {"robot_file_not_utf8",
     {{"robot.toml", replaced(kRobot, "test", "t\xE9st")}},
     "robot --robot robot.toml",
     kBadInputFile,
     {"robot.toml:1: ", "expected TOML"}},
};

const std::vector<BrokenInput> kSourceErrorFiles{
    errors("toml_syntax", replaced(kErrors, "= 0.01", "0.01"), {"errors.toml:7: ", "expected TOML"}),
    errors("limb_missing", replaced(kErrors, "[[limb]]\nalpha2_deg = 0.01\n", ""),
           {"errors.toml:", "expected 4 [[limb]]", "got 3"}),
    errors("limb_too_many", kErrors + "[[limb]]\n", {"errors.toml:", "expected 4 [[limb]]", "got 5"}),
    errors("no_limbs", "# nothing\n", {"errors.toml:", "[[limb]]", "got nothing"}),
    errors("limb_is_a_table", "[limb]\ntheta_offset_deg = 1\n",
           {"errors.toml:1: expected [[limb]] tables, got a table"}),
    errors("limb_is_an_array", "limb = [1, 2, 3, 4]\n", {"errors.toml:1: expected [[limb]] tables, got an array"}),
    errors("unknown_key", replaced(kErrors, "alpha2_deg", "alpha_2"),
           {"errors.toml:7: ", "alpha2_deg", "limb 4.alpha_2"}),
    errors("unit_forgotten", replaced(kErrors, "theta_offset_deg", "theta_offset"),
           {"errors.toml:2: ", "theta_offset_deg", "limb 1.theta_offset"}),
    errors("unknown_table", kErrors + "[legs]\n", {"errors.toml:8: ", "limb", "legs"}),
    errors("e_of_two", replaced(kErrors, "[0.1, 0.2, 0.3]", "[0.1, 0.2]"),
           {"errors.toml:4: expected 3 numbers for limb 2.e_mm, got 2"}),
    errors("e_is_a_number", replaced(kErrors, "[0.1, 0.2, 0.3]", "0.1"),
           {"errors.toml:4: expected an array of numbers for limb 2.e_mm"}),
    errors("text_for_number", replaced(kErrors, "0.01", "\"small\""),
           {"errors.toml:7: ", "limb 4.alpha2_deg, got a text"}),
    errors("nan", replaced(kErrors, "0.01", "nan"), {"errors.toml:7: ", "limb 4.alpha2_deg", "nan"}),
    {"file_missing",
     {{"joints.csv", kJoints}},
     kForward + " --errors none.toml",
     kBadInputFile,
     {"none.toml: ", "No such file"}},
    {"of_another_robot",
     {{"errors.toml", kErrors}, {"joints.csv", kJoints}},
     kForward + " --errors errors.toml --robot rotary_delta",
     kBadInputFile,
     {"errors.toml:", "expected 3 [[limb]]", "got 4"}},
};

const std::vector<BrokenInput> kTables{
    {"poses_missing", {}, kInverse, kBadInputFile, {"poses.csv: ", "No such file"}},
    {"poses_are_a_folder", {}, "inverse --poses .", kBadInputFile, {"expected a file, got a folder"}},
    poses("poses_empty", "", {"poses.csv: ", "expected a header line"}),
    poses("poses_only_comments", "# a\n# b\n\n", {"poses.csv: ", "expected a header line"}),
    poses("poses_header_only", "x_mm,y_mm,z_mm,phi_deg\n", {"poses.csv: ", "at least one row"}),
    poses("column_missing", replaced(kPoses, "z_mm", "residual_mm"), {"poses.csv:2: ", "\"z_mm\""}),
    poses("column_unknown", replaced(kPoses, "phi_deg", "angle"), {"poses.csv:2: ", "\"angle\""}),
    poses("column_twice", replaced(kPoses, "y_mm", "x_mm"), {"poses.csv:2: ", "\"x_mm\" twice"}),
    poses("header_of_both_kinds", replaced(kPoses, "x_mm", "x_cmd_mm"), {"poses.csv:2: ", "y_cmd_mm"}),
    poses("no_header", "home,0,0,-888,0\nright,400,0,-888,0\n", {"poses.csv:1: ", "header"}),
    poses("fields_too_few", replaced(kPoses, "400,0,-888,0\nleft", "400,0,-888\nleft"),
          {"poses.csv:4: expected 5 fields", "got 4"}),
    poses("fields_too_many", replaced(kPoses, "left,", "left,1,"), {"poses.csv:5: expected 5 fields", "got 6"}),
    poses("decimal_commas", replaced(kPoses, "-400", "-400,5"), {"poses.csv:5: expected 5 fields"}),
    poses("semicolons_and_commas", "pose;x_mm,y_mm;z_mm\nhome;0;0;-888\n", {"poses.csv:1: ", "semicolons and commas"}),
    poses("text_for_number", replaced(kPoses, "right,400", "right,far"),
          {"poses.csv:4: ", "finite number in column x_mm", "\"far\""}),
    poses("number_with_unit", replaced(kPoses, "right,400", "right,400mm"),
          {"poses.csv:4: ", "column x_mm", "\"400mm\""}),
    poses("number_missing", replaced(kPoses, "right,400", "right,"), {"poses.csv:4: ", "column x_mm", "\"\""}),
    poses("number_with_two_signs", replaced(kPoses, "right,400", "right,+-400"),
          {"poses.csv:4: ", "column x_mm", "\"+-400\""}),
    poses("number_too_large", replaced(kPoses, "right,400", "right,1e999"),
          {"poses.csv:4: ", "column x_mm", "\"1e999\""}),
    poses("nan", replaced(kPoses, "right,400", "right,nan"), {"poses.csv:4: ", "column x_mm", "\"nan\""}),
    poses("place_beyond_the_robot", replaced(kPoses, "right,400", "right,1e8"),
          {"poses.csv:4: expected x_mm from -16000 to 16000 mm (ten times the reach of the robot), got 1e+08"}),
    poses("turns_beyond_counting", replaced(kPoses, "right,400,0,-888,0", "right,400,0,-888,1e8"),
          {"poses.csv:4: expected phi_deg from -36000 to 36000 deg (a hundred turns), got 1e+08"}),
    poses("infinite", replaced(kPoses, "right,400", "right,-inf"), {"poses.csv:4: ", "column x_mm", "\"-inf\""}),
    poses("quotation_mark_open", replaced(kPoses, "right", "\"right"), {"poses.csv:4: ", "quotation mark"}),
    poses("pose_twice", replaced(kPoses, "left", "home"), {"poses.csv:5: ", "\"home\"", "line 3"}),
    poses("pose_without_name", replaced(kPoses, "left", ""), {"poses.csv:5: ", "name"}),
    {"joints_missing", {}, kForward, kBadInputFile, {"joints.csv: ", "No such file"}},
    joints("joints_header_only", "q1_deg,q2_deg,q3_deg,q4_deg\n", {"joints.csv: ", "at least one row"}),
    joints("joints_too_few", "q1_deg,q2_deg,q3_deg\n1,2,3\n", {"joints.csv:1: ", "\"q4_deg\""}),
    joints("joints_unknown_column", replaced(kJoints, "q4_deg", "q4_rad"), {"joints.csv:1: ", "\"q4_rad\""}),
    joints("joints_beyond_turns", replaced(kJoints, "-13", "1e8"),
           {"joints.csv:2: expected q3_deg from -36000 to 36000 deg", "1e+08"}),
    joints("joints_text_for_number", replaced(kJoints, "-13", "minus"),
           {"joints.csv:2: ", "column q3_deg", "\"minus\""}),
    {"joints_too_many",
     {{"joints.csv", kJoints}},
     kForward + " --robot rotary_delta",
     kBadInputFile,
     {"joints.csv:1: ", "\"q4_deg\""}},
    {"distances_missing", {{"poses.csv", kPoses}}, kCalibrate, kBadInputFile, {"distances.csv: ", "No such file"}},
    {"distances_without_poses_file",
     {{"distances.csv", kDistances}},
     kCalibrate,
     kBadInputFile,
     {"poses.csv: ", "No such file"}},
    distances("distances_header_only", "from,to,distance_mm\n", {"distances.csv: ", "at least one row"}),
    distances("distances_column_missing", replaced(kDistances, "distance_mm", "rotation_deg"),
              {"distances.csv:1: ", "\"distance_mm\""}),
    distances("distances_unknown_column", replaced(kDistances, "sigma_mm", "sigma"),
              {"distances.csv:1: ", "\"sigma\""}),
    distances("distance_to_unknown_pose", replaced(kDistances, "left", "lefd"),
              {"distances.csv:3: ", "poses.csv", "column to", "\"lefd\""}),
    distances("distance_from_unknown_pose", replaced(kDistances, "home,left", "hom,left"),
              {"distances.csv:3: ", "column from", "\"hom\""}),
    distances("distance_to_itself", replaced(kDistances, "home,left", "left,left"),
              {"distances.csv:3: ", "two different poses"}),
    distances("distance_twice", replaced(kDistances, "left", "right"), {"distances.csv:3: ", "line 2"}),
    distances("distance_twice_turned_round", replaced(kDistances, "home,left", "right,home"),
              {"distances.csv:3: ", "line 2"}),
    distances("distance_negative", replaced(kDistances, "399.6", "-399.6"),
              {"distances.csv:3: ", "distance_mm above 0", "-399.6"}),
    distances("distance_zero", replaced(kDistances, "399.6", "0"), {"distances.csv:3: ", "distance_mm above 0"}),
    distances("distance_text", replaced(kDistances, "399.6", "long"),
              {"distances.csv:3: ", "column distance_mm", "\"long\""}),
    distances("sigma_zero", replaced(kDistances, "399.6,0.05", "399.6,0"),
              {"distances.csv:3: ", "sigma_mm from 1e-05"}),
    distances("sigma_negative", replaced(kDistances, "399.6,0.05", "399.6,-0.05"),
              {"distances.csv:3: ", "sigma_mm from 1e-05", "-0.05"}),
    {"believed_joints_too_few",
     {{"distances.csv", "from,to,distance_mm\na,b,100\n"},
      {"poses.csv", "pose,x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg\na,0,0,-888,-11,-11,-11\nb,100,0,-888,-11,-11,-11\n"}},
     kCalibrate,
     kBadInputFile,
     {"poses.csv:1: ", "q4_deg"}},
    {"believed_joints_without_the_first",
     {{"distances.csv", "from,to,distance_mm\na,b,100\n"},
      {"poses.csv", "pose,x_mm,y_mm,z_mm,q2_deg,q3_deg,q4_deg\na,0,0,-888,-11,-11,-11\nb,100,0,-888,-11,-11,-11\n"}},
     kCalibrate,
     kBadInputFile,
     {"poses.csv:1: ", "q1_deg"}},
};

const std::vector<BrokenInput> kCalibrationFiles{
    calibration("not_json", "robot = 3\n", {"calibration.json:1: ", "expected JSON"}),
    calibration("cut_off", kCalibration.substr(0, kCalibration.find("\n]")), {"calibration.json:9: ", "expected JSON"}),
    calibration("empty", "", {"calibration.json:1: ", "expected JSON, got an empty file"}),
    calibration("json_of_something_else", "{\"wheels\": 4}\n",
                {"calibration.json:1: ", "expected a calibration with \"robot\""}),
    calibration("json_array", "[1, 2]\n", {"calibration.json:1: ", "a calibration: expected an object"}),
    calibration("without_parameters", replaced(kCalibration, "\"parameters\"", "\"parameter\""),
                {"calibration.json:1: ", "\"parameters\""}),
    calibration("of_another_robot", replaced(kCalibration, "huang2016", "sparrow"),
                {"calibration.json:3: ", "sparrow", "huang2016"}),
    calibration("of_a_robot_of_other_size", replaced(kCalibration, "375", "370"),
                {"calibration.json:3: ", "geometry", "370", "375"}),
    calibration("of_a_robot_with_other_plate", replaced(kCalibration, "mm\": 12", "mm\": 13"),
                {"calibration.json:3: ", "plate", "12", "13"}),
    calibration("unknown_parameter", replaced(kCalibration, "e_x", "ex"), {"calibration.json:9: ", "\"ex\""}),
    calibration("limb_of_no_robot", replaced(kCalibration, "\"limb\": 4", "\"limb\": 5"),
                {"calibration.json:9: ", "a limb from 1 to 4", "5"}),
    calibration("limb_zero", replaced(kCalibration, "\"limb\": 4", "\"limb\": 0"),
                {"calibration.json:9: ", "a limb from 1 to 4", "0"}),
    calibration("limb_not_whole", replaced(kCalibration, "\"limb\": 4", "\"limb\": 3.5"),
                {"calibration.json:9: ", "3.5"}),
    calibration("value_null", replaced(kCalibration, "0.2", "null"), {"calibration.json:9: ", "e_x", "null"}),
    calibration("value_text", replaced(kCalibration, "0.2", "\"0.2\""), {"calibration.json:9: ", "e_x"}),
    calibration("value_in_another_unit", replaced(kCalibration, "\"deg\"", "\"rad\""),
                {"calibration.json:8: ", "theta_offset", "deg", "rad"}),
    {"file_missing",
     {{"poses.csv", kPoses}},
     kInverse + " --errors none.json",
     kBadInputFile,
     {"none.json: ", "No such file"}},
};

const std::vector<BrokenInput> kUnreachable{
    unreachable("pose_too_far", {{"poses.csv", replaced(kPoses, "right,400", "right,1400")}}, kInverse,
                {"paracal: poses.csv:4: pose right", "(1400, 0, -888) mm", "limb", "cannot reach this pose"}),
    unreachable("pose_of_a_rigid_plate_that_turns",
                {{"poses.csv", replaced(kPoses, "400,0,-888,0\nleft", "400,0,-888,30\nleft")}},
                kInverse + " --robot rotary_delta",
                {"paracal: poses.csv:4: pose right", "30 deg", "rigid plate does not turn"}),
    unreachable("joints_that_do_not_close", {{"joints.csv", replaced(kJoints, "-13", "170")}}, kForward,
                {"paracal: joints.csv:2: joints a"}),
    // The wrists' circle has a radius of 3095 mm, so rods of 950 mm cannot meet.
    unreachable("rods_that_do_not_meet", {{"joints.csv", "q1_deg,q2_deg,q3_deg\n12.604,150.783,51.953\n"}},
                kForward + " --robot rotary_delta", {"joints 1", "rods do not meet"}),
    unreachable("error_model_out_of_reach", {}, "error-model --pose 0,0,-2000,0", {"huang2016", "(0, 0, -2000) mm"}),
    unreachable("error_model_of_a_rigid_plate_that_turns", {}, "error-model --pose 0,0,-900,30 --robot rotary_delta",
                {"rotary_delta", "30 deg"}),
    unreachable("station_of_a_calibration_too_far",
                {{"distances.csv", kDistances}, {"poses.csv", replaced(kPoses, "right,400", "right,1400")}}, kCalibrate,
                {"\"right\"", "cannot reach", "(1400, 0, -888) mm"}),
};

const std::vector<BrokenInput> kUsage{
    usage("no_command", "", {"expected a command, got none"}),
    usage("tilt_beyond_half_a_turn", "tolerance allocate --robot huang2016 --max-tilt 1e300",
          {"--max-tilt", "above 0 and up to 3.14159 rad (half a turn)", "1e+300"}),
    usage("pose_beyond_the_robot", "error-model --robot huang2016 --pose 0,0,-1e8,0",
          {"--pose", "ten times the reach of the robot", "-1e+08"}),
    usage("unknown_command", "calibrat", {"calibrat"}),
    usage("two_commands", "robot reproduce huang2016", {"reproduce"}),
    usage("unknown_option", "robot --colour red", {"--colour"}),
    usage("inverse_without_poses", "inverse", {"--poses"}),
    usage("forward_without_joints", "forward", {"--joints"}),
    usage("calibrate_without_measurements", "calibrate --poses poses.csv", {"--measurements"}),
    usage("calibrate_without_poses", "calibrate --measurements distances.csv", {"--poses"}),
    usage("error_model_without_pose", "error-model", {"--pose"}),
    usage("pose_of_two_numbers", "error-model --pose 0,0", {"--pose", "3"}),
    usage("pose_of_five_numbers", "error-model --pose 0,0,-888,0,0", {"--pose", "x,y,z,phi", "5 numbers"}),
    usage("pose_of_text", "error-model --pose 0,0,low", {"--pose"}),
    usage("pose_not_a_number", "error-model --pose nan,0,-888,0", {"--pose", "nan"}),
    usage("pose_infinite", "error-model --pose 0,0,-inf,0", {"--pose", "inf"}),
    usage("unknown_robot", "robot --robot huang2017", {"--robot", "huang2016", "rotary_delta", "\"huang2017\""}),
    usage("unknown_paper", "reproduce newton1687", {"huang2016", "newton1687"}),
    usage("unknown_schema", "schema calibratoin", {"calibration", "calibratoin"}),
    usage("reproduce_without_paper", "reproduce", {"expected PAPER, got none"}),
    usage("seed_negative", "robot --seed -1", {"--seed", "-1"}),
    usage("threads_text", "robot --threads all", {"--threads", "all"}),
};

TEST_P(BrokenInputTest, IsRefusedWithAMessage) {
  const ProgramResult result = run_with("");
  EXPECT_EQ(result.exit_code, GetParam().exit_code);
  EXPECT_THAT(result.out, IsEmpty());
  for (const std::string& fragment : GetParam().message) EXPECT_THAT(result.err, HasSubstr(fragment));
  EXPECT_THAT(result.err, testing::EndsWith("\n"));
}

TEST_P(BrokenInputTest, LeavesNoFileBehind) {
  const auto before = folder.names();
  const ProgramResult result = run_with(" --out result");
  EXPECT_EQ(result.exit_code, GetParam().exit_code);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(folder.names(), before);
}

TEST_P(BrokenInputTest, KeepsAnEarlierResult) {
  folder.write("result", "earlier\n");
  const auto before = folder.names();
  EXPECT_EQ(run_with(" --json --out result").exit_code, GetParam().exit_code);
  EXPECT_EQ(folder.names(), before);
  EXPECT_TRUE(folder.read("result") == "earlier\n");
}

INSTANTIATE_TEST_SUITE_P(Robot, BrokenInputTest, testing::ValuesIn(kRobotFiles), name_of);
INSTANTIATE_TEST_SUITE_P(SourceErrors, BrokenInputTest, testing::ValuesIn(kSourceErrorFiles), name_of);
INSTANTIATE_TEST_SUITE_P(Table, BrokenInputTest, testing::ValuesIn(kTables), name_of);
INSTANTIATE_TEST_SUITE_P(Calibration, BrokenInputTest, testing::ValuesIn(kCalibrationFiles), name_of);
INSTANTIATE_TEST_SUITE_P(Unreachable, BrokenInputTest, testing::ValuesIn(kUnreachable), name_of);
INSTANTIATE_TEST_SUITE_P(Usage, BrokenInputTest, testing::ValuesIn(kUsage), name_of);

/// The table above breaks files that are good: otherwise it would prove nothing.
TEST(UnbrokenInput, IsAccepted) {
  const TemporaryFolder folder;
  folder.write("robot.toml", kRobot);
  folder.write("rigid.toml", kRigidRobot);
  folder.write("errors.toml", kErrors);
  folder.write("poses.csv", kPoses);
  folder.write("joints.csv", kJoints);
  folder.write("calibration.json", kCalibration);
  EXPECT_EQ(folder.run("robot --robot robot.toml").exit_code, kDone);
  EXPECT_EQ(folder.run("robot --robot rigid.toml").exit_code, kDone);
  EXPECT_EQ(folder.run(kInverse).exit_code, kDone);
  EXPECT_EQ(folder.run(kForward + " --errors errors.toml").exit_code, kDone);
  EXPECT_EQ(folder.run(kInverse + " --errors calibration.json").exit_code, kDone);
  EXPECT_EQ(folder.run("error-model --pose 0,0,-888,0").exit_code, kDone);
}

TEST(BrokenInput, AnOptionWithoutItsValueIsWrongUsage) {
  const ProgramResult result = run_program({"inverse", "--poses"});
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, HasSubstr("--poses"));
}

/// Finite numbers that nobody can mean: the fit may say no, or the line is named.
TEST(BrokenInput, AbsurdMeasurementsAreJudgedOrRefusedByLine) {
  for (const char* reading : {"1e300,0.05", "1e-300,0.05", "399.5,5e-324", "399.5,1e300"}) {
    SCOPED_TRACE(reading);
    const TemporaryFolder folder;
    folder.write("distances.csv", replaced(kDistances, "399.5,0.05", reading));
    folder.write("poses.csv", kPoses);
    const ProgramResult result = folder.run(kCalibrate);
    if (result.exit_code == kVerdictIsNo) continue;
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.err, HasSubstr("distances.csv:2: "));
  }
}

/// Two distances cannot determine four offsets; the files themselves are good.
TEST(UnbrokenInput, DistancesAreReadAndJudged) {
  const TemporaryFolder folder;
  folder.write("distances.csv", kDistances);
  folder.write("poses.csv", kPoses);
  EXPECT_EQ(folder.run(kCalibrate).exit_code, kVerdictIsNo);
}

}  // namespace
}  // namespace paracal::test::broken_input_test

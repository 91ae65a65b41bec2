// More rows of the table of broken_input_test.cpp: for the commands that plan, simulate, calibrate from points and
// validate.

#include <algorithm>

#include "broken_input.hpp"

namespace paracal::test::broken_measurements_test {
namespace {

using testing::AnyOf, testing::HasSubstr, testing::IsEmpty;

// Unbroken files. Line numbers below can be checked against these texts.

const std::string kPoses =
    "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg\n"
    "home,0,0,-888,0\n"
    "right,400,0,-888,0\n"
    "left,-400,0,-888,90\n"
    "back,0,300,-950,-90\n"
    "front,0,-300,-800,0\n";

const std::string kPoints =
    "# a comment in line 1\n"
    "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm,repeat,phi_deg,x2_mm,y2_mm,z2_mm,sigma_mm\n"
    "home,0,0,-888,0,0.1,0.2,-888.3,1,0.01,50.1,0.2,-889.3,0.02\n"
    "home,0,0,-888,0,0.11,0.21,-888.31,2,0.02,50.11,0.21,-889.31,0.02\n"
    "right,400,0,-888,0,400.5,0.3,-888.4,1,0.03,450.5,0.3,-889.4,0.02\n"
    "left,-400,0,-888,90,-399.4,0.4,-887.5,1,90.4,-349.4,0.4,-888.5,0.02\n"
    "back,0,300,-950,-90,0.6,300.7,-950.8,1,-90.5,50.6,300.7,-951.8,0.02\n"
    "front,0,-300,-800,0,-0.7,-299.6,-800.5,1,0.06,49.3,-299.6,-801.5,0.02\n";

const std::string kThreePoints =
    "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\n"
    "home,0,0,-888,1,2,-888\n"
    "right,400,0,-888,401,2,-888\n"
    "left,-400,0,-888,-399,2,-888\n";

const std::string kErrors = "[[limb]]\ntheta_offset_deg = 0.1\n[[limb]]\n[[limb]]\n[[limb]]\nrod_mean_mm = 0.2\n";

const std::string kCalibration = R"({"format": "paracal calibration 1",
"accepted": true, "verdict": "accepted",
"robot": {"name": "huang2016",
  "geometry": {"base_radius_mm": 200, "plate_radius_mm": 75, "arm_mm": 375, "rod_mm": 950,
    "parallelogram_width_mm": 100, "limb_azimuth_deg": [-45, 45, 135, 225], "actuator": "revolute"},
  "plate": {"slide_axis": [0, -1, 0], "slide_sign": [1, 1, -1, -1], "pinion_radius_mm": 12}},
"parameters": [
  {"name": "theta_offset", "limb": 1, "value": 0.1, "unit": "deg", "status": "identified"},
  {"name": "e_x", "limb": 4, "value": 0.2, "unit": "mm", "status": "prior"}
],
"covariance": [[0.01, 0], [0, 0.02]], "inputs": []})";

const std::string kExport =
    "// a comment in line 1\n"
    "home\t0.0001\t0.0002\t-0.8883\t0.00002\n"
    "right\t0.4005\t0.0003\t-0.8884\t0.00002\n"
    "left\t-0.3994\t0.0004\t-0.8875\t0.00002\n"
    "back\t0.0006\t0.3007\t-0.9508\t0.00002\n"
    "front\t-0.0007\t-0.2996\t-0.8005\t0.00002\n";

const std::string kDistances =
    "from,to,distance_mm\n"
    "home,right,400.4\n"
    "home,left,399.5\n";

const std::string kBinary(
    "\x7f"
    "ELF\x02\x01\0\0\0\xff\xfe\n\0\x80,,\n",
    18);
const std::string kCommas(100000, ',');

const std::string kCalibrate = "calibrate --measurements points.csv";
const std::string kValidate = "validate --calibration calibration.json --measurements points.csv";
const std::string kCalibrateDistances = "calibrate --measurements distances.csv --poses poses.csv";
const std::string kColumns = " --poses poses.csv --columns name=1,x=2,y=3,z=4,sigma=5 --unit m";
const std::string kCalibrateExport = "calibrate --measurements export.txt" + kColumns;
const std::string kIdentifiability = "identifiability --poses poses.csv";
const std::string kSimulate = "simulate --poses poses.csv --errors errors.toml --truth truth.toml";
const std::string kSelect = "poses --optimal 12 --candidates 300";

/// All of them.
std::vector<NamedText> good_files() {
  return {{"poses.csv", kPoses},   {"points.csv", kPoints},       {"errors.toml", kErrors},
          {"export.txt", kExport}, {"distances.csv", kDistances}, {"calibration.json", kCalibration}};
}

/// All of them, one replaced.
BrokenInput with_file(std::string name, const std::string& file, std::string text, std::string command,
                      std::vector<std::string> message, int exit_code = kBadInputFile) {
  std::vector<NamedText> files = good_files();
  for (NamedText& one : files) {
    if (one.name == file) one.text = text;
  }
  if (std::ranges::none_of(files, [&](const NamedText& one) { return one.name == file; })) {
    files.push_back({file, std::move(text)});
  }
  return {std::move(name), std::move(files), std::move(command), exit_code, std::move(message)};
}

BrokenInput points(std::string name, std::string text, std::vector<std::string> message) {
  return with_file(std::move(name), "points.csv", std::move(text), kCalibrate, std::move(message));
}

BrokenInput exported(std::string name, std::string text, std::vector<std::string> message) {
  return with_file(std::move(name), "export.txt", std::move(text), kCalibrateExport, std::move(message));
}

BrokenInput calibration(std::string name, std::string text, std::vector<std::string> message) {
  return with_file(std::move(name), "calibration.json", std::move(text), kValidate, std::move(message));
}

BrokenInput tolerances(std::string name, std::string text, std::vector<std::string> message) {
  return with_file(std::move(name), "tolerances.toml", std::move(text), kCalibrate + " --tolerances tolerances.toml",
                   std::move(message));
}

BrokenInput command(std::string name, std::string command, std::vector<std::string> message, int exit_code) {
  return {std::move(name), good_files(), std::move(command), exit_code, std::move(message)};
}

BrokenInput usage(std::string name, std::string text, std::vector<std::string> message) {
  return command(std::move(name), std::move(text), std::move(message), kWrongUsage);
}

/// Every way in of every command, and every file that is none.
std::vector<BrokenInput> no_such_files() {
  struct Way {
    std::string name, before, after;
  };
  const std::vector<Way> ways{
      {"points", "calibrate --measurements ", ""},
      {"second_points", "calibrate --measurements points.csv ", ""},
      {"distances", "calibrate --measurements ", " --poses poses.csv"},
      {"poses_of_distances", "calibrate --measurements distances.csv --poses ", ""},
      {"export", "calibrate --measurements ", kColumns},
      {"poses_of_an_export", "calibrate --columns name=1,x=2,y=3,z=4 --unit m --measurements export.txt --poses ", ""},
      {"priors", "calibrate --measurements points.csv --tolerances ", ""},
      {"calibration", "validate --measurements points.csv --calibration ", ""},
      {"validated_points", "validate --calibration calibration.json --measurements ", ""},
      {"planned_poses", "identifiability --poses ", ""},
      {"simulated_poses", "simulate --poses ", ""},
      {"simulated_errors", "simulate --poses poses.csv --errors ", ""},
      {"robot_of_a_plan", "poses --robot ./", ""},
  };
  struct None {
    std::string name, file, message;
  };
  const std::vector<None> nones{{"missing", "none.csv", "No such file"},
                                {"folder", ".", "folder"},
                                {"empty", "empty", ": expected "},
                                {"binary", "binary", ": expected "},
                                {"commas", "commas", ": expected "}};
  std::vector<BrokenInput> rows;
  for (const Way& way : ways) {
    for (const None& none : nones) {
      if (way.name == "robot_of_a_plan" && none.name == "missing") continue;  // see robot_file_missing
      std::vector<NamedText> files = good_files();
      files.insert(files.end(), {{"empty", ""}, {"binary", kBinary}, {"commas", kCommas}});
      rows.push_back({way.name + "_" + none.name,
                      std::move(files),
                      way.before + none.file + way.after,
                      kBadInputFile,
                      {none.file, none.message}});
    }
  }
  return rows;
}

const std::vector<BrokenInput> kPointTables{
    points("header_only", kPoints.substr(0, kPoints.find("home")), {"points.csv: ", "at least one row"}),
    points("no_header", kPoints.substr(kPoints.find("home")), {"points.csv:1: ", "header"}),
    points("unknown_column", replaced(kPoints, "sigma_mm", "sigma_um"), {"points.csv:2: ", "\"sigma_um\""}),
    points("column_missing", replaced(kPoints, ",y_mm", ",q1_deg"), {"points.csv:2: ", "q2_deg"}),
    points("measured_column_missing", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,z_mm\nhome,0,0,-888,0.1,-888.1\n",
           {"points.csv:1: ", "\"y_mm\""}),
    points("commanded_columns_missing", "pose,x_mm,y_mm,z_mm\nhome,0.1,0.2,-888.1\n",
           {"points.csv:1: ", "\"x_cmd_mm\""}),
    points("two_separators", replaced(kPoints, "phi_cmd_deg,x_mm", "phi_cmd_deg;x_mm"),
           {"points.csv:2: ", "commas and semicolons"}),
    points("comma_of_decimals_or_thousands",
           "pose;x_cmd_mm;y_cmd_mm;z_cmd_mm;x_mm;y_mm;z_mm\nhome;0;0;-888;1,250;2;3\n",
           {"points.csv:2: ", "\"1,250\"", "1.250 or 1250?", "--decimal-comma"}),
    points("extra_column", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm,operator\nhome,0,0,-888,1,2,-888,NN\n",
           {"points.csv:1: ", "\"operator\"", "--ignore-columns \"operator\""}),
    points("fields_too_few", replaced(kPoints, ",-801.5,0.02", ",-801.5"), {"points.csv:8: expected 14 fields"}),
    points("decimal_commas", replaced(kPoints, "400.5", "400,5"), {"points.csv:5: expected 14 fields"}),
    points("partly_blank", replaced(kPoints, "400.5", ""), {"points.csv:5: ", "x_mm", "1 blank"}),
    points("second_partly_blank", replaced(kPoints, "450.5,0.3", ","), {"points.csv:5: ", "x2_mm", "2 blank"}),
    points("all_blank", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\nhome,0,0,-888,,,\nright,400,0,-888,,,\n",
           {"points.csv: ", "at least one row with a point"}),
    points("commanded_blank", replaced(kPoints, "right,400", "right,"), {"points.csv:5: ", "x_cmd_mm"}),
    points("text", replaced(kPoints, "400.5", "far"), {"points.csv:5: ", "column x_mm", "\"far\""}),
    points("nan", replaced(kPoints, "400.5", "nan"), {"points.csv:5: ", "column x_mm", "\"nan\""}),
    points("infinite", replaced(kPoints, "400.5", "-inf"), {"points.csv:5: ", "column x_mm", "\"-inf\""}),
    points("too_large", replaced(kPoints, "400.5", "1e309"), {"points.csv:5: ", "column x_mm", "\"1e309\""}),
    points("rotation_nan", replaced(kPoints, "90.4", "nan"), {"points.csv:6: ", "column phi_deg"}),
    points("second_infinite", replaced(kPoints, "450.5", "inf"), {"points.csv:5: ", "column x2_mm"}),
    points("sigma_zero", replaced(kPoints, "-801.5,0.02", "-801.5,0"), {"points.csv:8: ", "sigma_mm from 1e-05"}),
    points("sigma_negative", replaced(kPoints, "-801.5,0.02", "-801.5,-0.02"),
           {"points.csv:8: ", "sigma_mm from 1e-05", "-0.02"}),
    points("repeat_zero", replaced(kPoints, "-888.31,2", "-888.31,0"), {"points.csv:4: ", "expected repeat", "0"}),
    points("repeat_not_whole", replaced(kPoints, "-888.31,2", "-888.31,1.5"), {"points.csv:4: ", "column repeat"}),
    points("repeat_commanded_elsewhere", replaced(kPoints, "home,0,0,-888,0,0.11", "home,0,1,-888,0,0.11"),
           {"points.csv:4: ", "pose home", "line 3"}),
    points("pose_without_name", replaced(kPoints, "front", ""), {"points.csv:8: ", "name"}),
    points("believed_joints_of_another_robot",
           "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm,q1_deg,q2_deg,q3_deg\nhome,0,0,-888,0,0,-888,-11,-11,-11\n",
           {"points.csv:1: ", "q4_deg"}),
    with_file("second_file_broken", "more.csv", replaced(kPoints, "400.5", "far"),
              "calibrate --measurements points.csv more.csv", {"more.csv:5: ", "\"far\""}),
    with_file("validated_points_broken", "points.csv", replaced(kPoints, "400.5", "far"), kValidate,
              {"points.csv:5: ", "\"far\""}),
    with_file("distances_of_unknown_poses", "distances.csv", "from,to,distance_mm\nhome,nowhere,1\n",
              kCalibrateDistances, {"distances.csv:2: ", "\"nowhere\""}),
};

const std::vector<BrokenInput> kExports{
    with_file("no_unit", "export.txt", "Target;X;Y;Z\nhome;1;2;3\n",
              "calibrate --measurements export.txt --poses poses.csv", {"export.txt:1: ", "\"X [mm]\"", "--unit"}),
    with_file("two_units", "export.txt", "Target;X [mm];Y [mm];Z [m]\nhome;1;2;3\n",
              "calibrate --measurements export.txt --poses poses.csv",
              {"export.txt:1: ", "the same unit", "\"Z [m]\""}),
    with_file("another_unit", "export.txt", "Target;X [mm];Y [mm];Z [mm]\nhome;1;2;3\n",
              "calibrate --measurements export.txt --poses poses.csv --unit m", {"export.txt:1: ", "--unit", "1000"}),
    with_file("no_header_row", "export.txt", "// only comments tell\nhome 1 2 3\n",
              "calibrate --measurements export.txt --poses poses.csv", {"export.txt: ", "header row", "--columns"}),
    with_file("other_count_by_order", "export.txt", "X_mm\tY_mm\tZ_mm\n1\t2\t3\n4\t5\t6\n",
              "calibrate --measurements export.txt --poses poses.csv --match order",
              {"export.txt: ", "expected 5 points", "got 2"}),
    exported("only_comments", "// a\n# b\n\n", {"export.txt: ", "at least one line"}),
    exported("fields_too_few", replaced(kExport, "\t-0.8005\t0.00002", "\t-0.8005"),
             {"export.txt:6: ", "at least 5 fields", "got 4"}),
    exported("other_separators", replaced(kExport, "right\t0.4005\t", "right;0.4005;"), {"export.txt:3: ", "fields"}),
    exported("text", replaced(kExport, "0.4005", "X"), {"export.txt:3: ", "column 2 (x)", "\"X\""}),
    exported("nan", replaced(kExport, "0.4005", "nan"), {"export.txt:3: ", "column 2 (x)"}),
    exported("overflow", replaced(kExport, "0.4005", "1e308"), {"export.txt:3: ", "column 2 (x)", "1e308"}),
    exported("sigma_zero", replaced(kExport, "-0.8005\t0.00002", "-0.8005\t0"),
             {"export.txt:6: ", "column 5 (sigma) from 1e-05"}),
    exported("no_name", replaced(kExport, "front", " "), {"export.txt:6: ", "name"}),
    exported("quotation_mark_open", replaced(kExport, "front", "\"front"), {"export.txt:6: ", "quotation mark"}),
    exported("no_pose_of_these", "a 0.1 0.2 0.3 0.00002\nb 0.1 0.2 0.4 0.00002\n", {"export.txt: ", "home", "a, b"}),
};

const std::vector<BrokenInput> kCalibrations{
    calibration("rejected",
                replaced(kCalibration, "true, \"verdict\": \"accepted\"", "false, \"verdict\": \"not converged\""),
                {"calibration.json:2: ", "accepted", "not converged"}),
    calibration("rejected_without_a_verdict", replaced(kCalibration, "true, \"verdict\": \"accepted\"", "false"),
                {"calibration.json:2: ", "expected an accepted calibration", "accepted = false"}),
    calibration("accepted_against_its_verdict",
                replaced(kCalibration, "\"verdict\": \"accepted", "\"verdict\": \"rejected"),
                {"calibration.json:2: ", "\"accepted\"", "\"rejected\""}),
    calibration("accepted_a_number", replaced(kCalibration, "\"accepted\": true", "\"accepted\": 1"),
                {"calibration.json:2: ", "accepted: expected true or false", "got 1"}),
    calibration("without_accepted", replaced(kCalibration, "\"accepted\": true, ", ""),
                {"calibration.json:1: ", "expected a calibration with \"accepted\", got none"}),
    calibration("other_format", replaced(kCalibration, "calibration 1", "calibration 9"),
                {"calibration.json:1: ", "\"paracal calibration 1\"", "\"paracal calibration 9\""}),
    calibration("of_another_robot", replaced(kCalibration, "huang2016", "sparrow"),
                {"calibration.json:3: ", "sparrow", "huang2016"}),
    command("for_another_robot", kValidate + " --robot rotary_delta", {"calibration.json:3: ", "rotary_delta"},
            kBadInputFile),
    calibration("robot_a_text", "{\"accepted\": true,\n\"robot\": \"huang2016\", \"parameters\": []}",
                {"calibration.json:2: ", "robot: expected an object", "\"huang2016\""}),
    calibration("limb_9", replaced(kCalibration, "\"limb\": 4", "\"limb\": 9"),
                {"calibration.json:9: ", "a limb from 1 to 4", "9"}),
    calibration("without_a_limb", replaced(kCalibration, "\"limb\": 4, ", ""),
                {"calibration.json:9: ", "expected entry 2 of parameters with \"limb\""}),
    calibration("value_too_large", replaced(kCalibration, "0.2", "1e999"),
                {"calibration.json:9: ", "expected numbers below 1e309", "1e999"}),
    calibration("error_twice",
                replaced(kCalibration, "\"e_x\", \"limb\": 4, \"value\": 0.2, \"unit\": \"mm\"",
                         "\"theta_offset\", \"limb\": 1, \"value\": 0.2, \"unit\": \"deg\""),
                {"calibration.json:9: ", "every error once", "theta_offset of limb 1 again"}),
    calibration("status_unknown", replaced(kCalibration, "\"prior\"", "\"guessed\""),
                {"calibration.json:9: ", "status", "\"fixed\"", "\"guessed\""}),
    calibration("std_negative", replaced(kCalibration, "\"unit\": \"mm\"", "\"unit\": \"mm\", \"std\": -0.1"),
                {"calibration.json:9: ", "expected std from 0", "-0.1"}),
    calibration("std_of_another_covariance",
                replaced(kCalibration, "\"unit\": \"deg\"", "\"unit\": \"deg\", \"std\": 0.05"),
                {"calibration.json:7: ", "expected the std of theta_offset of limb 1 as in the covariance (0.1 deg)",
                 "got 0.05"}),
    calibration("covariance_too_small", replaced(kCalibration, ", [0, 0.02]", ""),
                {"calibration.json:11: ", "covariance of 2 rows", "1"}),
    calibration("covariance_not_square", replaced(kCalibration, "[0, 0.02]", "[0]"),
                {"calibration.json:11: ", "square", "row 2"}),
    calibration("covariance_text", replaced(kCalibration, "[0, 0.02]", "[0,\n \"x\"]"),
                {"calibration.json:12: ", "entry 2 of entry 2 of covariance: expected a number", "\"x\""}),
    calibration("covariance_a_number", replaced(kCalibration, "[[0.01, 0], [0, 0.02]]", "3"),
                {"calibration.json:11: ", "covariance: expected an array", "3"}),
    calibration("no_freedom_for_the_noise",
                replaced(kCalibration, "\"covariance\"", "\"noise_dof\": 0,\n\"covariance\""),
                {"calibration.json:11: ", "expected noise_dof above 0", "0"}),
    calibration("joint_std_negative",
                replaced(kCalibration, "\"covariance\"", "\"joint_std_deg\": -0.01,\n\"covariance\""),
                {"calibration.json:11: ", "joint_std_deg", "-0.01"}),
    calibration("visit_std_of_two_joints",
                replaced(kCalibration, "\"covariance\"", "\"visit_std_deg\": [0.01, 0.01],\n\"covariance\""),
                {"calibration.json:11: ", "visit_std_deg: expected 4 numbers", "got 2"}),
    calibration(
        "drives_without_covariance",
        replaced(kCalibration, "\"covariance\"",
                 "\"drives\": [{\"limb\": 1, \"unit\": \"deg\", \"centre\": 0, \"spacing\": 9}],\n\"covariance\""),
        {"calibration.json:11: ", "expected drive_covariance"}),
    calibration("joint_std_a_text",
                replaced(kCalibration, "\"covariance\"", "\"joint_std_deg\": \"0.01\",\n\"covariance\""),
                {"calibration.json:11: ", "joint_std_deg: expected an array", "\"0.01\""}),
    calibration("parameters_a_number", replaced(kCalibration, "\"parameters\": [", "\"parameters\": 3, \"others\": ["),
                {"calibration.json:7: ", "parameters: expected an array"}),
    calibration("inputs_without_hashes",
                replaced(kCalibration, "\"inputs\": []", "\"inputs\": [{\"file\": \"a.csv\"}]"),
                {"calibration.json:11: ", "expected entry 1 of inputs with \"sha256\""}),
    calibration("notes_no_list", replaced(kCalibration, "\"covariance\"", "\"notes\": true,\n\"covariance\""),
                {"calibration.json:11: ", "notes: expected an array, got true"}),
    calibration("U_negative",
                replaced(kCalibration, "\"covariance\"", "\"use\": {\"distance_mm\":\n{\"U\": -5}},\n\"covariance\""),
                {"calibration.json:12: ", "U: expected a number of at least 0, got -5"}),
    calibration("frames_a_number", replaced(kCalibration, "\"covariance\"", "\"frames\": 5,\n\"covariance\""),
                {"calibration.json:11: ", "frames: expected an array, got 5"}),
    calibration("residual_of_text",
                replaced(kCalibration, "\"covariance\"",
                         "\"residuals\": [{\"pose\": \"P1\", \"after_mm\": [1, 2]}],\n\"covariance\""),
                {"calibration.json:11: ", "after_mm"}),
    calibration(
        "residual_from_a_number",
        replaced(kCalibration, "\"covariance\"",
                 "\"residuals\": [{\"from\": 5, \"to\": \"P2\", \"distance_mm\": 3, \"before_mm\": 0, \"after_mm\": 0, "
                 "\"excluded\": false}],\n\"covariance\""),
        {"calibration.json:11: ", "from: expected a text, got 5"}),
    calibration(
        "residual_after_text",
        replaced(kCalibration, "\"covariance\"",
                 "\"residuals\": [{\"series\": \"a.csv\", \"pose\": \"P1\", \"before_mm\": [0, 0, 0],\n\"after_mm\": "
                 "\"x\", \"excluded\": false}],\n\"covariance\""),
        {"calibration.json:12: ", "after_mm: expected an array, got \"x\""}),
    calibration("joint_std_null", replaced(kCalibration, "\"covariance\"", "\"joint_std_deg\": null,\n\"covariance\""),
                {"calibration.json:11: ", "joint_std_deg: expected an array, got null"}),
    calibration("prior_of_text", replaced(kCalibration, "\"unit\": \"mm\"", "\"unit\": \"mm\", \"prior_std\": \"x\""),
                {"calibration.json:9: ", "prior_std: expected a number or null, got \"x\""}),
    calibration("day_of_no_year",
                replaced(kCalibration, "\"covariance\"", "\"date\": \"2026-02-29T10:00:00Z\",\n\"covariance\""),
                {"calibration.json:11: ", "date: expected a date like"}),
    calibration("hash_of_no_file",
                replaced(kCalibration, "\"inputs\": []", "\"inputs\": [{\"file\": \"a.csv\", \"sha256\": \"\"}]"),
                {"calibration.json:11: ", "sha256: expected a text of the form ^[0-9a-f]{64}$"}),
    calibration("inputs_null", replaced(kCalibration, "\"inputs\": []", "\"inputs\": null"),
                {"calibration.json:11: ", "inputs: expected an array, got null"}),
    calibration("inputs_missing", replaced(kCalibration, ", \"inputs\": []", ""),
                {"calibration.json:1: ", "expected a calibration with \"inputs\", got none"}),
    calibration("accepted_twice", replaced(kCalibration, "\"covariance\"", "\"accepted\": true,\n\"covariance\""),
                {"calibration.json:11: ", "expected each key once, got \"accepted\" again"}),
    calibration("cut_off", kCalibration.substr(0, 300), {"calibration.json:6: ", "expected JSON"}),
    calibration("nested_beyond_measure", std::string(100000, '['), {"calibration.json:1: ", "at most 64 levels"}),
    tolerances("all_zero", "theta_offset_deg = 0\nothers = \"exact\"\n",
               {"tolerances.toml: ", "at least one tolerance above 0"}),
    tolerances("partial", "# parts\ntheta_offset_deg = 1\n",
               {"tolerances.toml:", "others = \"exact\"", "others = \"generous\"",
                "got no others and no e_mm, arm_length_mm"}),
    tolerances("others_unknown", "theta_offset_deg = 1\nothers = \"tight\"\n",
               {"tolerances.toml:2: ", "exact", "tight"}),
    tolerances("larger_than_the_robot", "others = \"exact\"\ne_mm = 1525\n",
               {"tolerances.toml:2: ", "below 1525 for e_mm", "got 1525"}),
    tolerances("half_a_turn", "others = \"exact\"\ntheta_offset_deg = 180\n",
               {"tolerances.toml:2: ", "below 180 for theta_offset_deg", "got 180"}),
    tolerances("measured_beyond_the_robot", "others = \"exact\"\ne_mm = 1\n[measured]\nrod_mean_mm = [0.1, -1e300]\n",
               {"tolerances.toml:4: ", "measured.rod_mean_mm within 1525", "got -1e+300"}),
    tolerances("negative", "theta_offset_deg = -1\n", {"tolerances.toml:1: ", "theta_offset_deg", "-1"}),
    tolerances("drawing_of_another_size", "e_mm = 1\narm_length_mm = \"376 +- 0.04\"\n",
               {"tolerances.toml:2: ", "\"375 +- H\"", "the robot's size is 375 mm"}),
    tolerances("unknown_key", "theta_offset_rad = 0.01\n", {"tolerances.toml:1: ", "theta_offset_rad"}),
    tolerances("toml_syntax", "theta_offset_deg 1\n", {"tolerances.toml:1: ", "expected TOML"}),
};

/// One number that nobody can mean: a lost decimal point, a wrong column.
const std::vector<BrokenInput> kAbsurd{
    points("point_far_from_the_others", replaced(kPoints, "400.5,0.3", "1e8,0.3"),
           {"points.csv:5: expected x within", "of the middle of the points", "got 1e+08 mm", "check the number"}),
    points("point_beyond_all_instruments", replaced(kPoints, "400.5,0.3", "400.5,1e30"),
           {"points.csv:5: expected y_mm from -1e+09 to 1e+09 mm", "got 1e+30"}),
    points("second_far_from_the_first", replaced(kPoints, "450.5,0.3", "450.5,-1e8"),
           {"points.csv:5: expected y within", "of the first reflector"}),
    points("encoder_beyond_turns", replaced(kPoints, "90.4", "1e8"),
           {"points.csv:6: expected phi_deg from -36000 to 36000 deg", "got 1e+08"}),
    points("sigma_beyond_instruments", replaced(kPoints, "-801.5,0.02", "-801.5,1e8"),
           {"points.csv:8: expected sigma_mm from 1e-05 to 1e+06"}),
    points("repeat_beyond_counting", replaced(kPoints, "-888.31,2", "-888.31,1e8"),
           {"points.csv:4: expected repeat from 1 to 1e+06"}),
    exported("exported_far_from_the_others", replaced(kExport, "-0.8884", "1e5"),
             {"export.txt:3: expected z within", "of the middle of the points"}),
    with_file("distance_beyond_the_robot", "distances.csv", replaced(kDistances, "400.4", "1e8"), kCalibrateDistances,
              {"distances.csv:2: expected distance_mm above 0 and up to", "ten times the reach of the robot", "1e+08"}),
    with_file("one_reading_of_a_ball_bar", "bar.csv",
              "pose,ball_bar_mm,centre_x_mm,centre_y_mm,centre_z_mm\n"
              "home,312,0,0,-1200\nright,501,100,0,-1200\n",
              "calibrate --measurements bar.csv --poses poses.csv",
              {"bar.csv:2: expected at least 4 readings of one setup", "got 1"}),
    {"bed_beyond_the_printer",
     {{"config.g", "M665 L215.0 R97.5 B75 H330.0\nM666 X0 Y0 Z0\n"},
      {"bed.csv", "x_mm,y_mm,z_mm,height_mm\n0,0,1.5,1.65\n0,53,1.7,1e8\n"}},
     "calibrate --printer config.g --firmware reprapfirmware --readings bed.csv",
     kBadInputFile,
     {"bed.csv:3: expected height_mm from -3125 to 3125 mm (ten times the reach of the robot), got 1e+08"}},
    {"printer_of_no_size",
     {{"config.g", "M665 L215.0 R1e8 B75 H330.0\n"}, {"bed.csv", "x_mm,y_mm,z_mm,height_mm\n0,0,1.5,1.65\n"}},
     "calibrate --printer config.g --firmware reprapfirmware --readings bed.csv",
     kBadInputFile,
     {"config.g:1: expected R from -100000 to 100000 (no printer is larger than 100 m), got 1e+08"}},
    with_file("errors_beyond_the_robot", "errors.toml", replaced(kErrors, "rod_mean_mm = 0.2", "rod_mean_mm = 1e8"),
              kSimulate, {"errors.toml:6: expected limb 4.rod_mean_mm from", "the reach of the robot", "1e+08"}),
    with_file("errors_beyond_half_a_turn", "errors.toml", replaced(kErrors, "= 0.1", "= 1e8"), kSimulate,
              {"errors.toml:2: expected limb 1.theta_offset_deg from -180 to 180 deg", "1e+08"}),
    calibration("coverage_factor_negative",
                replaced(kCalibration, "\"accepted\": true", "\"coverage_factor\": -5, \"accepted\": true"),
                {"calibration.json:2: coverage_factor: expected a number of at least 1"}),
    calibration("freedom_negative",
                replaced(kCalibration, "\"accepted\": true", "\"degrees_of_freedom\": -1, \"accepted\": true"),
                {"calibration.json:2: degrees_of_freedom: expected a number of at least 0, got -1"}),
    calibration("noise_is_a_text",
                replaced(kCalibration, "\"accepted\": true", "\"noise_mm\": \"NaN\", \"accepted\": true"),
                {"calibration.json:2: noise_mm: expected a number, got \"NaN\""}),
    calibration("probability_above_1",
                replaced(kCalibration, "\"accepted\": true", "\"fit_probability\": 7, \"accepted\": true"),
                {"calibration.json:2: fit_probability: expected a number of at most 1, got 7"}),
    calibration("date_is_none",
                replaced(kCalibration, "\"accepted\": true", "\"date\": \"yesterday\", \"accepted\": true"),
                {"calibration.json:2: date: expected a text like 2016-10-05T12:00:00Z, got \"yesterday\""}),
    calibration("robot_of_no_proportions", replaced(kCalibration, "\"rod_mm\": 950", "\"rod_mm\": 1e8"),
                {"calibration.json:3: ", "geometry.rod_mm", "100000000"}),
};

const std::vector<BrokenInput> kTooLittle{
    with_file("three_poses", "points.csv", kThreePoints, kValidate,
              {"points.csv: ", "at least 4 different poses", "got 3"}),
    with_file("three_poses_in_the_second_file", "few.csv", kThreePoints, kValidate + " few.csv",
              {"few.csv: ", "at least 4 different poses", "got 3"}),
};

const std::vector<BrokenInput> kOutOfReach{
    with_file("commanded_too_far", "points.csv", replaced(kPoints, "right,400", "right,1400"), kCalibrate,
              {"points.csv:5: ", "\"right\"", "cannot reach", "(1400, 0, -888) mm"}, kMathematicsSaysNo),
    with_file("commanded_beyond_all_numbers", "points.csv", replaced(kPoints, "right,400", "right,1e308"), kCalibrate,
              {"points.csv:5: ", "x_cmd_mm", "ten times the reach of the robot", "1e+308"}),
    with_file("rotation_beyond_all_numbers", "points.csv",
              replaced(kPoints, "left,-400,0,-888,90", "left,-400,0,-888,1e308"), kCalibrate,
              {"points.csv:6: ", "phi_cmd_deg", "a hundred turns", "1e+308"}),
    with_file("validated_too_far", "points.csv", replaced(kPoints, "right,400", "right,1400"), kValidate,
              {"points.csv:5: ", "\"right\"", "cannot reach"}, kMathematicsSaysNo),
    with_file("exported_too_far", "poses.csv", replaced(kPoses, "right,400", "right,1400"), kCalibrateExport,
              {"poses.csv:3: ", "\"right\"", "cannot reach"}, kMathematicsSaysNo),
    with_file("planned_too_far", "poses.csv", replaced(kPoses, "right,400", "right,1400"), kIdentifiability,
              {"poses.csv:3: ", "\"right\"", "cannot reach"}, kMathematicsSaysNo),
    with_file("simulated_too_far", "poses.csv", replaced(kPoses, "right,400", "right,1400"), kSimulate,
              {"poses.csv:3: ", "\"right\"", "cannot reach"}, kMathematicsSaysNo),
    command("measured_for_another_robot", kCalibrate + " --robot rotary_delta", {"\"left\"", "rotary_delta"},
            kMathematicsSaysNo),
    with_file("machine_that_does_not_close", "errors.toml", replaced(kErrors, "= 0.2", "= -700"), kSimulate,
              {"no solution"}, kMathematicsSaysNo),
    command("no_pose_is_visible", kSelect + " --tracker 4000,0,-900 --facing 0,0,1 --acceptance-deg 5",
            {"expected 12 visible poses", "got "}, kMathematicsSaysNo),
};

const std::vector<BrokenInput> kUsage{
    usage("poses_unknown_option", "poses --number 9", {"--number"}),
    usage("poses_unknown_stage", "poses --stage auto", {"--stage", "auto"}),
    usage("poses_start_not_a_number", "poses --start-deg nan", {"--start-deg", "nan"}),
    usage("poses_start_too_far", "poses --start-deg 1e308", {"--start-deg", "1e+308"}),
    usage("poses_threshold_zero", "poses --threshold 0", {"--threshold", "0"}),
    usage("poses_threshold_not_a_number", "poses --threshold nan", {"--threshold", "nan"}),
    usage("one_optimal_pose", "poses --optimal 1", {"--optimal", "1"}),
    usage("optimal_not_whole", "poses --optimal 12.5", {"--optimal", "12.5"}),
    usage("optimal_text", "poses --optimal many", {"--optimal", "many"}),
    usage("candidates_too_few", "poses --optimal 12 --candidates 5", {"--candidates", "12", "5"}),
    usage("candidates_too_many", "poses --optimal 12 --candidates 1000000000", {"--candidates"}),
    usage("candidates_of_the_papers_scheme", "poses --stage fine --candidates 300", {"--candidates", "--optimal"}),
    usage("criterion_of_the_papers_scheme", "poses --stage fine --criterion D", {"--criterion", "--optimal"}),
    usage("tracker_of_the_papers_scheme", "poses --tracker 4000,0,-900 --facing 1,0,0", {"--optimal"}),
    usage("unknown_criterion", kSelect + " --criterion best", {"--criterion", "best"}),
    usage("tracker_without_facing", kSelect + " --tracker 4000,0,-900", {"--tracker", "--facing"}),
    usage("facing_without_tracker", kSelect + " --facing 1,0,0", {"--tracker", "--facing"}),
    usage("facing_nowhere", kSelect + " --tracker 4000,0,-900 --facing 0,0,0", {"--facing", "direction"}),
    usage("facing_infinitely", kSelect + " --tracker 4000,0,-900 --facing inf,0,0", {"--facing", "inf"}),
    usage("tracker_not_a_number", kSelect + " --tracker nan,0,0 --facing 1,0,0", {"--tracker", "nan"}),
    usage("tracker_of_two", kSelect + " --tracker 4000,0 --facing 1,0,0", {"--tracker", "3"}),
    usage("acceptance_zero", kSelect + " --acceptance-deg 0", {"--acceptance-deg", "0"}),
    usage("acceptance_not_a_number", kSelect + " --tracker 4000,0,-900 --facing 1,0,0 --acceptance-deg nan",
          {"--acceptance-deg", "nan"}),
    usage("plan_tracker_without_noise", kSelect + " --tracker-um 0,0,0,0", {"--tracker-um", "0"}),
    usage("identifiability_without_poses", "identifiability", {"--poses"}),
    usage("identifiability_of_angles", kIdentifiability + " --measure angles", {"--measure", "angles"}),
    usage("identifiability_frame", kIdentifiability + " --frame tracker", {"--frame", "tracker"}),
    usage("identifiability_rotation", kIdentifiability + " --rotation maybe", {"--rotation", "maybe"}),
    usage("second_reflector_of_distances", kIdentifiability + " --measure distance --second",
          {"--second", "coordinates"}),
    usage("identifiability_sigma", kIdentifiability + " --sigma-deg -1", {"--sigma-deg", "-1"}),
    usage("identifiability_tracker_of_three", kIdentifiability + " --tracker-um 15,6,10", {"--tracker-um", "4"}),
    usage("simulate_without_poses", "simulate --errors errors.toml", {"--poses"}),
    usage("simulate_unknown_option", kSimulate + " --noise 3", {"--noise"}),
    usage("noise_negative", kSimulate + " --noise-mm -1", {"--noise-mm", "-1"}),
    usage("noise_not_a_number", kSimulate + " --noise-mm nan", {"--noise-mm", "nan"}),
    usage("noise_beyond_measure", kSimulate + " --noise-mm 1e308", {"--noise-mm", "1e+308"}),
    usage("repeatability_beyond_measure", kSimulate + " --repeatability-mm 1e308", {"--repeatability-mm", "1e+308"}),
    usage("rotation_noise_infinite", kSimulate + " --rotation-noise-deg inf", {"--rotation-noise-deg", "inf"}),
    usage("noise_and_tracker", kSimulate + " --noise-mm 0.02 --tracker-um 15,6,10,0.3", {"--noise-mm", "--tracker-um"}),
    usage("tracker_negative", kSimulate + " --tracker-um 15,6,-10,0.3", {"--tracker-um", "-10"}),
    usage("tracker_without_noise", kSimulate + " --tracker-um 0,0,0,0", {"--tracker-um", "0"}),
    usage("no_repeats", kSimulate + " --repeats 0", {"--repeats", "0"}),
    usage("repeats_beyond_measure", kSimulate + " --repeats 1000000000000", {"--repeats"}),
    usage("machine_negative", kSimulate + " --machine -1", {"--machine", "-1"}),
    usage("second_of_two", kSimulate + " --second 60,0", {"--second", "3"}),
    usage("second_not_a_number", kSimulate + " --second nan,0,0", {"--second", "nan"}),
    usage("second_beyond_measure", kSimulate + " --second 1e308,0,0", {"--second", "1e+308"}),
    usage("simulate_unknown_frame", kSimulate + " --frame moon", {"--frame", "moon"}),
    usage("calibrate_unknown_option", kCalibrate + " --quick", {"--quick"}),
    usage("unknown_method", kCalibrate + " --method magic", {"--method", "magic"}),
    usage("unknown_reflectors", kCalibrate + " --reflectors arm", {"--reflectors", "arm"}),
    usage("export_without_poses", kCalibrate + " --unit mm", {"--poses: expected a table for points.csv, got none"}),
    usage("unknown_match", kCalibrate + " --match ordr", {"--match", "did you mean order?"}),
    usage("columns_without_unit", "calibrate --measurements export.txt --poses poses.csv --columns name=1,x=2,y=3,z=4",
          {"--unit: expected mm, m, um or inch, got none"}),
    usage("columns_without_poses", "calibrate --measurements export.txt --unit m --columns name=1,x=2,y=3,z=4",
          {"--poses"}),
    usage("column_missing", "calibrate --measurements export.txt --poses poses.csv --unit m --columns name=1,x=2,y=3",
          {"--columns", "z is missing"}),
    usage("column_twice", "calibrate --measurements export.txt --poses poses.csv --unit m --columns name=1,x=2,y=3,z=3",
          {"--columns", "column 3 is given twice"}),
    usage("column_zero", "calibrate --measurements export.txt --poses poses.csv --unit m --columns name=0,x=2,y=3,z=4",
          {"--columns", "\"0\" is not a column"}),
    usage("column_unknown",
          "calibrate --measurements export.txt --poses poses.csv --unit m --columns name=1,x=2,y=3,w=4",
          {"--columns", "w=4"}),
    usage("unknown_unit",
          "calibrate --measurements export.txt --poses poses.csv --unit cubit --columns name=1,x=2,y=3,z=4",
          {"--unit", "mm, m, um or inch", "cubit"}),
    usage("points_sigma_beyond_measure", kCalibrate + " --sigma-deg 1e308", {"--sigma-deg", "1e+308"}),
    usage("calibrate_tracker_without_noise", kCalibrate + " --tracker-um 0,6,0,0", {"--tracker-um", "radial"}),
    usage("calibrate_tracker_infinite", kCalibrate + " --tracker-um inf,6,10,0.3", {"--tracker-um", "inf"}),
    usage("fix_unknown", kCalibrate + " --fix e_w", {"source error", "\"e_w\""}),
    usage("fix_limb_9", kCalibrate + " --fix e_x9", {"of 4", "\"e_x9\""}),
    usage("fix_limb_0", kCalibrate + " --fix alpha00", {"of 4", "\"alpha00\""}),
    usage("fix_limb_10", kCalibrate + " --fix e_x10", {"\"e_x10\""}),
    usage("fix_limb_4_of_3", kCalibrate + " --fix e_x4 --robot rotary_delta", {"\"e_x4\""}),
    usage("fix_unit", kCalibrate + " --fix e_x_mm", {"\"e_x_mm\""}),
    usage("free_unknown", kCalibrate + " --free rods", {"source error", "\"rods\""}),
    usage("fix_and_free", kCalibrate + " --fix e_x --free e_x2", {"--fix", "--free", "e_x of limb 2"}),
    usage("fix_all_of_a_stage", kCalibrate + " --stage rough --fix theta_offset",
          {"--fix", "expected at least one error to estimate"}),
    usage("fix_everything",
          kCalibrate + " --fix theta_offset,e_x,e_y,e_z,arm_length,alpha0,beta0,rod_mean,rod_difference,"
                       "width_difference,alpha03,beta03,alpha2,beta2",
          {"--fix", "expected at least one error to estimate"}),
    usage("validate_without_calibration", "validate --measurements points.csv", {"--calibration"}),
    usage("validate_without_measurements", "validate --calibration calibration.json", {"--measurements"}),
    usage("validate_unknown_option", kValidate + " --limit 1", {"--limit"}),
    usage("validated_distances_without_poses", "validate --calibration calibration.json --measurements distances.csv",
          {"--poses"}),
};

INSTANTIATE_TEST_SUITE_P(NoFile, BrokenInputTest, testing::ValuesIn(no_such_files()), name_of);
INSTANTIATE_TEST_SUITE_P(PointTable, BrokenInputTest, testing::ValuesIn(kPointTables), name_of);
INSTANTIATE_TEST_SUITE_P(Export, BrokenInputTest, testing::ValuesIn(kExports), name_of);
INSTANTIATE_TEST_SUITE_P(KnownMachine, BrokenInputTest, testing::ValuesIn(kCalibrations), name_of);
INSTANTIATE_TEST_SUITE_P(Absurd, BrokenInputTest, testing::ValuesIn(kAbsurd), name_of);
INSTANTIATE_TEST_SUITE_P(TooLittle, BrokenInputTest, testing::ValuesIn(kTooLittle), name_of);
INSTANTIATE_TEST_SUITE_P(OutOfReach, BrokenInputTest, testing::ValuesIn(kOutOfReach), name_of);
INSTANTIATE_TEST_SUITE_P(MeasuringUsage, BrokenInputTest, testing::ValuesIn(kUsage), name_of);

/// The tables above break files and commands that are good: otherwise they would prove nothing.
TEST(UnbrokenMeasurements, AreReadAndJudged) {
  const TemporaryFolder folder;
  for (const NamedText& file : good_files()) folder.write(file.name, file.text);
  for (const std::string& command :
       {kCalibrate, kValidate, kCalibrateDistances, kCalibrateExport, kIdentifiability, kSimulate, kSelect,
        kSelect + " --tracker 4000,0,-900 --facing 1,0,0 --acceptance-deg 40", kCalibrate + " --fix e_x2,alpha0",
        kSimulate + " --tracker-um 15,6,10,0.3 --second 60,0,-40", kCalibrate + " --tracker-um 15,6,10,0.3"}) {
    const ProgramResult result = folder.run(command);
    EXPECT_THAT(result.exit_code, AnyOf(kDone, kVerdictIsNo)) << command << "\n" << result.err;
    EXPECT_THAT(result.out, testing::Not(IsEmpty())) << command;
  }
}

/// Finite numbers that nobody can mean: the fit may pass over them or say no, or the line is named. As text and as JSON
/// in turn, with every_machine() as both.
TEST(UnbrokenMeasurements, AbsurdReadingsAreJudgedOrRefused) {
  bool as_text = false;
  for (const char* old : {"400.5", "450.5", "90.4", "-801.5,0.02"}) {
    for (const std::string number : {"1e308", "-1e308", "1e200", "1e30", "1e-308"}) {
      SCOPED_TRACE(old + (" as " + number));
      const TemporaryFolder folder;
      for (const NamedText& file : good_files()) folder.write(file.name, file.text);
      const bool is_sigma = std::string(old).ends_with("0.02");
      folder.write("points.csv", replaced(kPoints, old, is_sigma ? "-801.5," + number : number));
      as_text = !as_text;
      for (const std::string& command : {kCalibrate, kCalibrate + " --json", kValidate, kValidate + " --json"}) {
        if (!every_machine() && as_text == command.ends_with("--json")) continue;
        const ProgramResult result = folder.run(command);
        EXPECT_THAT(result.exit_code, AnyOf(kDone, kVerdictIsNo, kBadInputFile)) << command << "\n" << result.err;
        EXPECT_EQ(result.out.empty(), result.exit_code == kBadInputFile) << command;
      }
    }
  }
}

}  // namespace
}  // namespace paracal::test::broken_measurements_test

// Files in a wrong unit, mirrored, in the wrong order: the program names the cause, first and instead of what follows
// from it.

#include <gmock/gmock.h>

#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "json_checks.hpp"

namespace paracal::test::wrong_input_test {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Row = std::vector<double>;

class WrongInput : public testing::Test {
 protected:
  void SetUp() override {
    folder.make({"poses --stage fine --out plan.csv",
                 "simulate --poses plan.csv --machine 3 --noise-mm 0.017 --frame random --out points.csv",
                 "inverse --poses plan.csv --out joints.csv"});
  }

  /// points.csv with every row of numbers changed, and with `more` columns.
  void spoil(const std::function<Row(Row)>& change, const std::string& more = "") const {
    std::istringstream lines(folder.read("points.csv"));
    std::string text, line;
    bool header = true;
    while (std::getline(lines, line)) {
      if (line.starts_with('#')) continue;
      text += header ? line + more + '\n' : changed(line, change);
      header = false;
    }
    folder.write("spoilt.csv", text);
  }

  /// Columns: x, y, z, phi commanded, x, y, z read.
  static std::string changed(const std::string& line, const std::function<Row(Row)>& change) {
    std::istringstream fields(line);
    std::string name, field;
    std::getline(fields, name, ',');
    Row row;
    while (std::getline(fields, field, ',')) row.push_back(std::stod(field));
    std::ostringstream text;
    text.precision(12);
    text << name;
    for (const double value : change(row)) text << ',' << value;
    return text.str() + '\n';
  }

  ProgramResult calibrated(const std::string& options = "") const {
    return folder.run("calibrate --measurements spoilt.csv --json" + options);
  }

  const TemporaryFolder folder;
};

void expect_cause(const ProgramResult& result, const std::string& cause) {
  ASSERT_EQ(result.exit_code, kVerdictIsNo) << result.err;
  const nlohmann::json calibration = nlohmann::json::parse(result.out);
  EXPECT_THAT(calibration.at("reasons").at(0).get<std::string>(), HasSubstr(cause));
  // A rejected calibration, too, says that its joints are not those of the poses.
  EXPECT_THAT(calibration.at("notes").get<std::vector<std::string>>(), Each(HasSubstr("the joints do not match")));
  EXPECT_THAT(calibration.at("suspects"), IsEmpty());
}

TEST_F(WrongInput, SoundInputIsAccepted) {
  spoil([](Row row) { return row; });
  EXPECT_EQ(calibrated().exit_code, kDone);
}

TEST_F(WrongInput, ReadingsInMetres) {
  spoil([](Row row) {
    for (std::size_t k = 4; k < 7; ++k) row[k] /= 1000.0;
    return row;
  });
  expect_cause(calibrated(), "the readings are in metres: corrected, the residuals drop from ");
  const ProgramResult text = folder.run("calibrate --measurements spoilt.csv");
  EXPECT_THAT(text.out, AllOf(testing::ContainsRegex("because the readings are in metres: corrected, .* to 0\\.0"),
                              Not(HasSubstr("a wrong part")), Not(HasSubstr("outlier excluded"))));
}

TEST_F(WrongInput, WholeFileInMetres) {
  spoil([](Row row) {
    for (const std::size_t k : {0u, 1u, 2u, 4u, 5u, 6u}) row[k] /= 1000.0;
    return row;
  });
  const ProgramResult result = calibrated();
  EXPECT_EQ(result.exit_code, kMathematicsSaysNo);
  EXPECT_THAT(result.err, AllOf(HasSubstr("cannot reach (0, 0, -0.888) mm"),
                                HasSubstr("the readings and the commanded poses are in metres")));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST_F(WrongInput, MirroredFrame) {
  spoil([](Row row) {
    row[5] = -row[5];
    return row;
  });
  expect_cause(calibrated(), "the frame of the readings is mirrored");
}

TEST_F(WrongInput, JointsInRad) {
  std::istringstream joints(folder.read("joints.csv"));
  std::string line;
  do std::getline(joints, line);
  while (line.starts_with('#'));  // and the header
  const auto with_joints = [&](double factor) {
    return [&, factor](Row row) {
      std::getline(joints, line);
      std::istringstream fields(line);
      std::string field;
      while (std::getline(fields, field, ',')) {
        if (field.find_first_not_of("-+.0123456789e") == std::string::npos) row.push_back(factor * std::stod(field));
      }
      return row;
    };
  };
  spoil(with_joints(0.017453292519943295), ",q1_deg,q2_deg,q3_deg,q4_deg");
  expect_cause(calibrated(), "the joint angles are in rad, not deg");
}

/// A reflector that turns by -phi: as it is mounted, and as somebody takes it to be mounted.
TEST_F(WrongInput, MountThatTurnsTheOtherWay) {
  for (const std::string mount : {"plate", "end-effector", "end-effector-reversed"}) {
    const ProgramResult simulated = folder.run(
        "simulate --poses plan.csv --machine 3 --noise-mm 0.005 --second 60,0,-150 "
        "--frame random --out spoilt.csv --reflectors " +
        mount);
    ASSERT_EQ(simulated.exit_code, kDone) << simulated.err;
    const ProgramResult right = calibrated(" --reflectors " + mount);
    EXPECT_EQ(right.exit_code, kDone) << right.out << right.err;
    EXPECT_EQ(nlohmann::json::parse(right.out).at("options").at("reflectors"), mount);
    const std::string wrong = mount == "end-effector" ? "end-effector-reversed" : "end-effector";
    expect_cause(calibrated(" --reflectors " + wrong), "(--reflectors " + mount + ")");
  }
}

}  // namespace
}  // namespace paracal::test::wrong_input_test

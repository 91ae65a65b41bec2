// Two hexapods of others: one of the literature, of which nothing but numbers is known, and one that was measured.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "calibration/fit/placement.hpp"
#include "numerics/dense.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/places.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::hexapods_test {
namespace {

std::filesystem::path data(const char* name) { return test::source_folder() / "data/hexapod" / name; }

/// [nategh2009]: 42 nominal and "real" parameters.
struct Published {
  Robot robot;
  SourceErrors errors;
};

Published published() {
  const io::CsvTable table(io::read_file(data("nategh2009.csv")));
  std::vector<LimbDescription> nominal(6), real(6);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& quantity = table.text(row, "quantity");
    const auto leg = static_cast<std::size_t>(table.number(row, "leg", plausible::kFinite)) - 1;
    for (const auto& [struts, column] : {std::pair(&nominal, "nominal_mm"), std::pair(&real, "real_mm")}) {
      LimbDescription& strut = (*struts)[leg];
      const double value = table.number(row, column, plausible::kFinite);
      if (quantity == "l0") strut.length = value;
      if (quantity.starts_with("u_")) strut.base(quantity.back() - 'x') = value;
      if (quantity.starts_with("s_")) strut.plate(quantity.back() - 'x') = value;
    }
  }
  SourceErrors errors;
  for (std::size_t leg = 0; leg < 6; ++leg) {
    const Eigen::Vector3d base = real[leg].base - nominal[leg].base, plate = real[leg].plate - nominal[leg].plate;
    errors(leg, "zero") = real[leg].length - nominal[leg].length;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      errors(leg, sharing("base_x", Actuator::strut)[axis]) = base(static_cast<Eigen::Index>(axis));
      errors(leg, sharing("plate_x", Actuator::strut)[axis]) = plate(static_cast<Eigen::Index>(axis));
    }
  }
  RobotDescription robot;
  robot.name = "nategh2009";
  robot.limbs = nominal;
  robot.workspace = {.radius = 150.0, .height = 150.0, .top_z = 640.0, .max_tilt = 0.3};
  Tolerances tolerances = generous_tolerances(robot.limbs);
  for (const Source source : sources_of(Actuator::strut)) tolerances.state(source, 15.0);
  robot.tolerances = tolerances;
  return {Robot(robot), errors};
}

CalibrationOptions without_gains() {
  CalibrationOptions options;
  options.fixed = {{.source = Source("gain")}};
  options.scale_std = 0.0;
  options.diagnose = options.states_use = false;
  return options;
}

/// The tolerance, 1e-6 mm, is the issue's.
TEST(Nategh2009, All42ParametersComeBackFromPosesWithoutNoise) {
  const auto [robot, errors] = published();
  const Measurements plan = planned(robot, candidate_stations(robot, 40, 1), {.measurand = Measurand::poses});
  RandomStream unused(0);
  CalibrationOptions options = without_gains();
  options.frame = Frame::robot;
  options.body = BodyPlace::plate;
  options.noise = {.body = 1e-4, .rotation = 1e-7};  // far above where the kinematics end, far below any tolerance
  options.noise_is_known = true;
  const Calibration found = calibrate(robot, simulate(robot, errors, plan, {}, unused), options);
  ASSERT_TRUE(found.accepted()) << found.brief();
  EXPECT_EQ(found.rank, 42);
  EXPECT_TRUE(found.null_space.empty());
  double worst = 0.0;
  for (std::size_t leg = 0; leg < 6; ++leg) {
    for (const Source source : sources_of(Actuator::strut)) {
      worst = std::max(worst, std::abs(found.errors()(leg, source) - errors(leg, source)));
    }
  }
  RecordProperty("worst_mm", fmt::format("{:.2g}", worst));
  EXPECT_LT(worst, 1e-6);
}

TEST(Nategh2009, SixCannotBeSeenInAnUnknownFrame) {
  const auto [robot, errors] = published();
  const Measurements plan = planned(robot, candidate_stations(robot, 40, 1), {.measurand = Measurand::poses});
  CalibrationOptions options = without_gains();
  options.body = BodyPlace::plate;
  RandomStream unused(0);
  const Calibration found = calibrate(robot, simulate(robot, errors, plan, {}, unused), options);
  EXPECT_EQ(found.rank, 36) << found.brief();
  EXPECT_EQ(found.null_space.size(), 6u);
  for (const NullDirection& one : found.null_space) EXPECT_TRUE(one.gauge) << one.text;
}

/// Motion capture of a hexapod whose struts are cords on spools, half of its 108 poses for the fit (data/hexapod).
class Measured : public testing::Test {
 protected:
  using Choice = std::function<bool(const Station&)>;

  Measurements chosen(const Choice& is_kept) const {
    const Measurements all = read();
    Measurements kept{.series = {{all.series[0].name, {}}}, .files = all.files};
    for (const PointReading& reading : all.series[0].readings) {
      if (!is_kept(all.stations[reading.station])) continue;
      kept.series[0].readings.push_back(reading);
      kept.series[0].readings.back().station = kept.stations.size();
      kept.stations.push_back(all.stations[reading.station]);
    }
    return kept;
  }

  /// Poses `first`, first + 2, ...
  Measurements half(std::size_t first) const {
    std::size_t number = 0;
    return chosen([&](const Station&) { return number++ % 2 == first; });
  }

  Measurements read() const {
    return with_commands(robot, io::read_points(io::read_file(data("jugglebot.csv")), robot.joint_space()));
  }

  /// Of the poses, along an axis, mm.
  double middle(Eigen::Index axis) const {
    std::vector<double> places;
    for (const Station& one : read().stations) places.push_back(one.commanded.position(axis));
    return test::quantile(places, 0.5);
  }

  /// By how much the struts of the calibrated machine are longer than the joints say, where readings have its plate in
  /// the set-up of the fit, mm.
  Eigen::VectorXd strut_residuals(const Calibration& found, const Measurements& readings) const {
    const Machine machine = build(robot, found.errors());
    const RigidMotion to_robot = found.frames.at(0).frame.inverse(), body = found.frames.at(0).body.value().inverse();
    Eigen::VectorXd residuals(6 * std::ssize(readings.stations));
    for (const PointReading& reading : readings.series[0].readings) {
      const Eigen::Matrix3d carrier =
          to_robot.rotation * reading.orientation->normalized().toRotationMatrix() * body.rotation;
      const Eigen::Vector3d centre = to_robot(reading.point) + carrier * body.rotation.transpose() * body.translation;
      for (std::size_t i = 0; i < 6; ++i) {
        const Limb& limb = machine.limbs[i];
        const double joint = (*readings.stations[reading.station].believed)(static_cast<Eigen::Index>(i));
        residuals(static_cast<Eigen::Index>(6 * reading.station + i)) =
            (centre + carrier * as_eigen(limb.plate) - as_eigen(limb.base)).norm() - ends_at(limb, joint).length[0];
      }
    }
    return residuals;
  }

  Robot robot = io::read_robot(io::read_file(data("jugglebot.toml")));
};
double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Independent fits, with the same weak priors, left 0.48 mm.
TEST_F(Measured, EitherHalfPredictsTheStrutsOfTheOther) {
  for (const std::size_t fitted : {0U, 1U}) {
    const Calibration found = calibrate(robot, half(fitted));
    ASSERT_TRUE(found.accepted()) << found.brief();
    const double of_fit = root_mean_square(strut_residuals(found, half(fitted)));
    const double of_other = root_mean_square(strut_residuals(found, half(1 - fitted)));
    RecordProperty(fmt::format("struts_{}", fitted),
                   fmt::format("fitted {:.4f}, other half {:.4f} mm", of_fit, of_other));
    EXPECT_LT(of_fit, 0.48);
    EXPECT_LT(of_other, 0.48);
    EXPECT_GT(std::max(found.joint_std.maxCoeff(), found.visit_std.maxCoeff()), 0.03);  // spools are not even
  }
}

/// Of a half, how many numbers read there lie within the intervals of a calibration by the other half: positions and
/// orientations, the frame found anew, parameters, joints and noise as uncertain as the calibration says.
Eigen::Index held_readings(const Robot& robot, const Calibration& found, const Measurements& readings) {
  const KnownErrors known = known_errors(found);
  CalibrationOptions options;
  options.noise.body = found.noise;
  options.noise.rotation = found.orientation_noise.value();
  options.noise_is_known = true;
  options.scale_std = 0.0;
  const Measurements actual = at_actual_joints(robot, known.drives(), readings);
  const detail::Placement placed(robot, actual, options, known.errors);
  detail::Observation observation(robot, actual, options, known.parameters);
  Eigen::VectorXd unknowns = observation.start(known.errors).value();
  unknowns.head(observation.nuisance_count()) = placed.setup;
  const auto states = observation.stations(unknowns);
  const Eigen::Index rows = 6 * std::ssize(observation.groups()), n = observation.nuisance_count();
  Eigen::MatrixXd set_up(rows, n), by_errors(rows, observation.source_count());
  Eigen::MatrixXd variance = Eigen::MatrixXd::Identity(rows, rows);
  Eigen::VectorXd off(rows);
  Eigen::MatrixXd block, by_joint;
  Eigen::Index row = 0;
  for (const detail::Group& group : observation.groups()) {
    observation.rows(group, *states, unknowns, block, &by_joint);
    set_up.middleRows<6>(row) = block.leftCols(n);
    by_errors.middleRows<6>(row) = block.middleCols(n, observation.source_count());
    off.segment<6>(row) = block.rightCols<1>();
    if (known.joint_std.size() > 0) {
      variance.block<6, 6>(row, row) += by_joint * known.joint_std.cwiseAbs2().asDiagonal() * by_joint.transpose();
    }
    row += 6;
  }
  variance += by_errors * known.expanded_covariance() * by_errors.transpose();
  // What is left where the set-up has been found by least squares.
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(rows, rows) - set_up * detail::pseudo_inverse(set_up);
  const Eigen::VectorXd std = (left * variance * left.transpose()).diagonal().cwiseSqrt(), residual = left * off;
  return (residual.cwiseAbs().array() <= kCoverageFactor * std.array()).count();
}

/// 93 to 97 % of the 648 numbers.
TEST_F(Measured, IntervalsHoldTheReadingsOfTheOtherHalf) {
  Eigen::Index held = 0, all = 0;
  for (const std::size_t fitted : {0U, 1U}) {
    const Measurements other = half(1 - fitted);
    const Eigen::Index of_half = held_readings(robot, calibrate(robot, half(fitted)), other);
    RecordProperty(fmt::format("held_{}", fitted), fmt::format("{} of {}", of_half, 6 * other.stations.size()));
    held += of_half;
    all += 6 * std::ssize(other.stations);
  }
  EXPECT_GE(held, 0.93 * static_cast<double>(all));
  EXPECT_LE(held, 0.97 * static_cast<double>(all));
}

/// Positions relative to home at the poses that were not fitted, root mean square, mm.
double off_positions(const Robot& robot, const KnownErrors& known, const Measurements& readings) {
  double sum = 0.0;
  const Validation validation = validate(robot, known, readings);
  for (const ValidatedPose& one : validation.poses) {
    sum += std::pow(error_relative_to(validation.poses.front().after, one.after).volumetric, 2);
  }
  return std::sqrt(sum / static_cast<double>(validation.poses.size()));
}

/// Spools wind cords unevenly: with that, either half predicts the plate of the other much better.
TEST_F(Measured, UnevenSpoolsPredictTheOtherHalf) {
  for (const std::size_t fitted : {0U, 1U}) {
    const Calibration found = calibrate(robot, half(fitted));
    const double with = off_positions(robot, known_errors(found), half(1 - fitted));
    const double rigid = off_positions(robot, rigid_errors(found), half(1 - fitted));
    RecordProperty(fmt::format("positions_{}", fitted),
                   fmt::format("rigid {:.2f}, with drives {:.2f} mm", rigid, with));
    EXPECT_GT(found.drive_sizes.size(), 0);
    EXPECT_LT(with, 0.75 * rigid);
  }
}

/// Fitted in one part of the workspace and judged in the other: the result says so, and of mixed halves it does not.
TEST_F(Measured, ExtrapolationIsStated) {
  const auto extrapolates = [&](const Choice& fitted, const Choice& judged) {
    const Calibration found = calibrate(robot, chosen(fitted));
    const std::vector<std::string> notes = validate(robot, known_errors(found), chosen(judged)).notes;
    return std::ranges::any_of(notes, [](const std::string& one) { return one.find("extrapolates") != one.npos; });
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Choice low = [&, most = middle(axis)](const Station& one) { return one.commanded.position(axis) < most; };
    EXPECT_TRUE(extrapolates(low, std::not_fn(low))) << axis;
    EXPECT_TRUE(extrapolates(std::not_fn(low), low)) << axis;
  }
  const auto every_second = [](std::size_t first) -> Choice {
    return [number = first](const Station&) mutable { return number++ % 2 == 0; };
  };
  EXPECT_FALSE(extrapolates(every_second(0), every_second(1)));
}

/// A controller whose joints are connected in another order: said, instead of errors of centimetres.
TEST_F(Measured, SwappedStrutsAreNamed) {
  Measurements swapped = half(0);
  for (Station& station : swapped.stations) std::swap((*station.believed)(1), (*station.believed)(2));
  std::string said;
  try {
    const Calibration found = calibrate(robot, swapped);
    EXPECT_FALSE(found.accepted());
    said = found.reasons.empty() ? "" : found.reasons.front();
  } catch (const Unreachable& complaint) {
    said = complaint.what();
  }
  EXPECT_THAT(said, testing::HasSubstr("joints 1 to 6 are those of limbs 1, 3, 2, 4, 5, 6"));
}

/// One strut 100 mm longer than the file says, five times what is assumed of such files.
TEST_F(Measured, AWrongLengthIsSaid) {
  RobotDescription wrong = robot.description();
  wrong.limbs[3].length += 100.0;
  const Calibration found = calibrate(Robot(wrong), half(0));
  std::vector<std::string> said = found.notes;
  said.insert(said.end(), found.reasons.begin(), found.reasons.end());
  said.insert(said.end(), found.assumed.begin(), found.assumed.end());
  EXPECT_THAT(said, testing::Contains(testing::AnyOf(testing::HasSubstr("zero of limb 4 is "),
                                                     testing::HasSubstr("length_at_zero_mm of limb 4"))))
      << found.brief();
}

}  // namespace
}  // namespace paracal::hexapods_test

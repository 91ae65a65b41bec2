// The table of variances: its formulas against the same found in other ways, and what is read from it on machines of
// which one thing is off.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibration/fit/sought.hpp"
#include "calibration/verdict/explanation.hpp"
#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::variances_test {
namespace {

using detail::Spreads;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double kNoise = 0.017;  // mm

class Variances : public testing::Test {
 protected:
  /// Errors so many times as large as tolerances say.
  Measurements read(double noise, double errors, int repeats = 1, int number = 5) const {
    MeasuredMachine machine = measured_machine(robot, stations, number, {});
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) machine.errors(limb, source) *= errors;
    }
    return measure(robot, machine.errors, stations, number, {.noise = noise, .repeats = repeats});
  }
  detail::StageFit fit(const Measurements& measured) const {
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    return stage;
  }
  /// A joint that stands `off` to one side or the other, anew at each visit or at each pose.
  Measurements with_joint_off(double off, std::size_t joint, bool each_visit, int number) const {
    Measurements measured{.stations = stations, .series = {{"tracker", {}}}};
    const Machine machine = build(robot, measured_machine(robot, stations, number, {}).errors);
    RandomStream random(17, static_cast<std::uint64_t>(number));
    std::vector<double> sides;
    for (std::size_t k = 0; k < stations.size(); ++k) sides.push_back(random.uniform() < 0.5 ? -off : off);
    for (std::size_t visit = 0; visit < 3 * stations.size(); ++visit) {
      const std::size_t at = visit % stations.size();
      Joints joints = believed_joints(robot, stations[at]);
      joints(static_cast<Eigen::Index>(joint)) += each_visit ? (random.uniform() < 0.5 ? -off : off) : sides[at];
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      measured.series.front().readings.push_back(
          {.station = at, .point = forward(machine, joints).plate.position + kNoise * noise});
    }
    return measured;
  }
  Calibration with_wrong(Source source, double deviations, bool all_limbs) const {
    SourceErrors errors;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      if (all_limbs || limb == 1) {
        errors(limb, source) = (limb == 1 ? 1.0 : -1.0) * deviations * (*robot.tolerances())[source] / 3.0;
      }
    }
    Measurements measured = measure(robot, errors, stations, 5, {.noise = kNoise});
    state_sigma(measured, kNoise);
    return calibrate(robot, measured, {.states_use = false, .diagnose = false});
  }

  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations = fine_stations(robot, 9);
  CalibrationOptions options;
};

/// A fit of three visits of every pose, its linear model and its table.
class TableOfReadings : public Variances {
 protected:
  void SetUp() override {
    // Not where a likelihood is flat: every variance has an effect.
    u.resize(std::ssize(table.terms()));
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      const Spreads what = table.terms()[static_cast<std::size_t>(k)].what;
      const bool of_errors = what == Spreads::positions || what == Spreads::tilts;
      u(k) = what == Spreads::noise || of_errors ? 0.1 : std::log(0.01 + 0.002 * static_cast<double>(k));
    }
  }
  double variance(Spreads what, Eigen::Index joint = -1) const {
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      if (table.terms()[k].what == what && table.terms()[k].joint == joint) {
        return std::exp(2.0 * u(static_cast<Eigen::Index>(k)));
      }
    }
    throw std::logic_error("no such variance");
  }
  /// D(u), of errors of parts and of splines.
  Eigen::MatrixXd covariance_before() const {
    const Eigen::Index n = linear.by_errors.cols();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    for (const detail::VarianceTerm& one : table.terms()) {
      if (!one.places.empty()) all(one.places, one.places) += variance(one.what) * one.covariance;
    }
    return all;
  }
  /// Minus the logarithm of the density of all readings, one by one, their set-up integrated over a flat prior: from
  /// their rows alone.
  double cost_of_every_reading() const {
    const detail::Observation& observation = stage.observation();
    const auto states = observation.stations(stage.fit().parameters);
    const Eigen::Index count = 3 * std::ssize(observation.groups()), set_up = observation.nuisance_count(),
                       n = observation.source_count(), joints = 3;
    Eigen::MatrixXd S(count, set_up), X(count, linear.by_errors.cols()), H(count, joints), block, by_joint;
    Eigen::VectorXd y(count);
    for (Eigen::Index g = 0; g < std::ssize(observation.groups()); ++g) {
      const detail::Group& group = observation.groups()[static_cast<std::size_t>(g)];
      observation.rows(group, *states, stage.fit().parameters, block, &by_joint);
      S.middleRows<3>(3 * g) = block.leftCols(set_up);
      X.middleRows<3>(3 * g).leftCols(n) = block.middleCols(set_up, n);
      for (std::size_t k = 0; k < drives.knots.size(); ++k) {
        const auto limb = static_cast<Eigen::Index>(drives.knots[k].limb);
        const double joint = believed_joints(robot, stations[group.station])(limb);
        X.middleRows<3>(3 * g).col(n + static_cast<Eigen::Index>(k)) =
            drives.knots[k].knot->at(joint) * by_joint.col(limb);
      }
      H.middleRows<3>(3 * g) = linear.joint_per_mm * by_joint;
      y.segment<3>(3 * g) = -block.rightCols<1>();
    }
    y += X.leftCols(n) * stage.fit().parameters.tail(n);
    Eigen::MatrixXd V = X * covariance_before() * X.transpose();
    V.diagonal().array() += variance(Spreads::noise, 0);
    for (Eigen::Index i = 0; i < std::ssize(observation.groups()); ++i) {
      for (Eigen::Index k = 0; k < std::ssize(observation.groups()); ++k) {
        const bool here = observation.groups()[static_cast<std::size_t>(i)].station ==
                          observation.groups()[static_cast<std::size_t>(k)].station;
        for (Eigen::Index joint = 0; joint < joints && here; ++joint) {
          double each = variance(Spreads::poses, joint) + variance(Spreads::poses);
          if (i == k) each += variance(Spreads::visits, joint) + variance(Spreads::visits);
          V.block<3, 3>(3 * i, 3 * k) += each * H.block<3, 1>(3 * i, joint) * H.block<3, 1>(3 * k, joint).transpose();
        }
      }
    }
    const detail::Cholesky root(V);
    const Eigen::MatrixXd information =
        S.transpose() * root.solve(S) + linear.set_up_root.transpose() * linear.set_up_root;
    const Eigen::VectorXd a = detail::cholesky_solution(information, S.transpose() * root.solve(y));
    const Eigen::VectorXd left = y - S * a;
    return root.log_root() + 0.5 * std::log(detail::determinant(information / information.norm())) +
           0.5 * static_cast<double>(set_up) * std::log(information.norm()) + 0.5 * left.dot(root.solve(left).col(0)) +
           0.5 * (linear.set_up_root * a).squaredNorm();
  }
  double cost_of_priors() const {
    const Discrepancies scales;
    double cost = 0.0;
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      const double one = u(static_cast<Eigen::Index>(k));
      const auto half_cauchy = [&](double scale) { return std::log1p(std::exp(2.0 * one) / (scale * scale)) - one; };
      switch (table.terms()[k].what) {
        case Spreads::visits:
          cost += half_cauchy(scales.visits);
          break;
        case Spreads::poses:
          cost += half_cauchy(scales.poses);
          break;
        case Spreads::drives:
          cost += half_cauchy(scales.drives);
          break;
        case Spreads::positions:
        case Spreads::tilts:
          cost += (one - 0.5 * 0.01 / scales.tolerances) / scales.tolerances;  // beyond its round part
          break;
        default:
          cost += one * one / 18.0;
      }
    }
    return cost;
  }

  Measurements measured = read(kNoise, 1.0, 3);
  detail::StageFit stage = fit(measured);
  detail::DriveSplines drives = detail::drive_splines(robot, stations, Discrepancies{}.length);
  detail::ReadingPlaces places{stage.observation()};
  detail::LinearReadings linear = detail::linear_readings(stage, places, 1, drives);
  detail::VarianceTable table{stage, linear, drives, Discrepancies{}};
  Eigen::VectorXd u;
};

TEST_F(TableOfReadings, CostIsThatOfEveryReadingByItself) {
  const double cost = table.at(u, false).cost, brute = cost_of_every_reading() + cost_of_priors();
  u.array() += 0.2;
  EXPECT_NEAR(table.at(u, false).cost - cost, cost_of_every_reading() + cost_of_priors() - brute, 1e-6);
}

TEST_F(TableOfReadings, SlopesAreThoseOfTheCost) {
  constexpr double kStep = 1e-4;
  const detail::VarianceTable::At here = table.at(u, true);
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    Eigen::VectorXd more = u, less = u;
    more(k) += kStep;
    less(k) -= kStep;
    const double slope = (table.at(more, false).cost - table.at(less, false).cost) / (2.0 * kStep);
    EXPECT_NEAR(here.gradient(k), slope, 1e-5 * (1.0 + std::abs(slope))) << k;
  }
  EXPECT_GT(detail::symmetric_eigenvalues(here.curvature).minCoeff(), 0.0);
}

/// The mode is no worse than its neighbours.
TEST_F(TableOfReadings, ModeIsAMinimum) {
  const detail::VarianceTable::Mode mode = table.mode();
  const double cost = table.at(mode.u, false).cost;
  for (Eigen::Index k = 0; k < u.size(); ++k) {
    for (const double step : {-0.3, 0.3}) {
      Eigen::VectorXd beside = mode.u;
      beside(k) += step;
      EXPECT_GT(table.at(beside, false).cost, cost - 1e-3) << k << " " << step;
    }
  }
}

/// By the covariance of the readings, and by the information that they add to that of the priors.
TEST_F(TableOfReadings, ErrorsAreThoseOfTheInformation) {
  const detail::VarianceTable::At here = table.at(u, false);
  const Eigen::MatrixXd before = covariance_before(), by = linear.by_errors * before;
  const detail::VariancePosterior all = detail::of_all(stage, places, drives, {table, {u, {}, 0.0, 0.0}});
  const Eigen::VectorXd mean = by.transpose() * here.z;
  EXPECT_LT((all.errors - mean).norm(), 1e-6 * mean.norm());
  const Eigen::MatrixXd after = before - by.transpose() * here.P * by;
  EXPECT_LT((all.covariance - after).norm(), 1e-6 * after.norm());
}

/// Averaged over variances, E[Var] + Var[E], each by the covariance of the readings.
TEST_F(TableOfReadings, AveragedErrorsAreThoseOfEachSetOfVariances) {
  const detail::VariancePosterior posterior = detail::averaged({{table, table.mode(), 1.0}});
  const Eigen::Index n = linear.by_errors.cols();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, n);
  for (const detail::VariancePosterior::Point& one : posterior.points) {
    u = one.u;
    const detail::VarianceTable::At at = table.at(u, false);
    const Eigen::MatrixXd before = covariance_before(), by = linear.by_errors * before;
    const Eigen::VectorXd errors = by.transpose() * at.z;
    mean += one.weight * errors;
    squares += one.weight * (before - by.transpose() * at.P * by + errors * errors.transpose());
  }
  const Eigen::MatrixXd covariance = squares - mean * mean.transpose();
  EXPECT_LT((posterior.errors - mean).norm(), 1e-6 * mean.norm());
  EXPECT_LT((posterior.covariance - covariance).norm(), 1e-5 * covariance.norm());
}

/// U is about the machine that is written, the fit: what the mean of the table has beside it counts.
TEST_F(TableOfReadings, SquaresAreThoseAboutTheFit) {
  const detail::VariancePosterior posterior = detail::averaged({{table, table.mode(), 1.0}});
  const std::optional<detail::Explanation> found = detail::explained(stage, measured, options);
  ASSERT_TRUE(found);
  Eigen::VectorXd off = posterior.errors;
  off.head(linear.prior.rows()) -= stage.fit().parameters.tail(linear.prior.rows());
  EXPECT_GT(off.norm(), 0.0);
  EXPECT_LT((found->covariance - posterior.covariance - off * off.transpose()).norm(), 1e-9 * found->covariance.norm());
}

/// Truths drawn from the table itself: the share of its own distribution below an error, or below a variance, is
/// uniform. Largest distance of their distribution function from it; limit: what 1 in 1000 exceeds.
TEST_F(TableOfReadings, PosteriorIsThatOfItsOwnPrior) {
  const int count = machines({.claim = 400, .quick = 60});
  std::vector<double> shares;
  const Eigen::Index n = linear.by_errors.cols(), rows = linear.y.size();
  for (int number = 0; number < count; ++number) {
    RandomStream random(2026, static_cast<std::uint64_t>(number));
    const auto normal = [&](Eigen::Index size) {
      return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(size, [&] { return random.normal(); }));
    };
    detail::LinearReadings drawn = linear;
    const auto half_cauchy = [&](double scale) { return scale * std::tan(0.49 * std::numbers::pi * random.uniform()); };
    const Discrepancies scales;
    Eigen::VectorXd visits(4), poses(4);
    for (double& one : visits) one = half_cauchy(scales.visits);
    for (double& one : poses) one = half_cauchy(scales.poses);
    const double uneven = half_cauchy(scales.drives) * linear.joint_per_mm;
    Eigen::VectorXd errors(n);
    const Eigen::Index parts = linear.prior.rows();
    errors.head(parts) = detail::cholesky(linear.prior) * normal(parts);
    errors.tail(n - parts) = uneven * detail::cholesky(drives.covariance) * normal(n - parts);
    drawn.y = linear.by_errors * errors;
    for (std::size_t k = 0; k < drawn.blocks.size(); ++k) {
      detail::ReadingBlock& one = drawn.blocks[k];
      const auto off = [&](const Eigen::VectorXd& std) {
        Eigen::VectorXd joints(3);
        for (Eigen::Index j = 0; j < 3; ++j) joints(j) = std::hypot(std(j), std(3)) * random.normal();
        return Eigen::VectorXd(linear.joint_per_mm * one.by_joint * joints);
      };
      Eigen::MatrixXd each(3, 3);  // three visits
      for (Eigen::Index visit = 0; visit < 3; ++visit) each.col(visit) = off(visits) + normal(3);
      const Eigen::VectorXd mean = each.rowwise().mean();
      each.colwise() -= mean;
      one.scatter = each * each.transpose();
      drawn.y.segment<3>(drawn.first[k]) += mean + off(poses);
    }
    const detail::VarianceTable own(stage, drawn, drives, scales);
    const detail::VariancePosterior posterior = detail::averaged({{own, own.mode(), 1.0}});
    const auto at = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(parts));
    const double std = std::sqrt(posterior.covariance(at, at));
    shares.push_back(detail::normal_probability((errors(at) - posterior.errors(at)) / std));
  }
  ASSERT_EQ(rows, 57);
  std::ranges::sort(shares);
  double distance = 0.0;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    distance = std::max(distance, std::abs(shares[k] - (static_cast<double>(k) + 0.5) / static_cast<double>(count)));
  }
  EXPECT_LT(distance * std::sqrt(count), 1.95);
}

TEST(Splines, AddUpToOneWithinTheStroke) {
  const Robot robot = catalogue::linear_delta();
  const detail::DriveSplines drives = detail::drive_splines(robot, {}, 0.15);
  const SplineKnot first = *drives.knots[1].knot;
  for (const double share : {0.0, 0.3, 0.77, 1.0}) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 11; ++k) sum += drives.knots[k].knot->at(first.centre + share * 8.0 * first.spacing);
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

/// What they add up to varies by 1 everywhere, and goes together as a Gaussian of that length does.
TEST(Splines, FollowTheirCorrelation) {
  const Robot robot = catalogue::rotary_delta();
  const detail::DriveSplines drives = detail::drive_splines(robot, {}, 0.15);
  const SplineKnot first = *drives.knots[1].knot;
  const auto at = [&](double share) {
    Eigen::VectorXd splines = Eigen::VectorXd::Zero(std::ssize(drives.knots));
    for (std::size_t k = 0; k < 11; ++k) {
      splines(static_cast<Eigen::Index>(k)) = drives.knots[k].knot->at(first.centre + share * 8.0 * first.spacing);
    }
    return splines;
  };
  for (const double one : {0.2, 0.31, 0.5, 0.66}) {
    for (const double other : {0.2, 0.31, 0.45, 0.8}) {
      EXPECT_NEAR(at(one).dot(drives.covariance * at(other)), std::exp(-0.5 * std::pow((one - other) / 0.15, 2)), 0.03);
    }
  }
}

/// A spline moves the plate as its joint does, by its share.
TEST(Splines, MoveThePlateAsTheirJointDoes) {
  const Robot robot = catalogue::huang2016();
  const Pose pose{{100.0, -50.0, -850.0}, 0.3};
  const Joints joints = believed_joints(robot, {"P", pose});
  const SoughtSource joint{2, joint_zero(robot.nominal().limbs[2].actuator)};
  SoughtSource spline = joint;
  spline.knot = SplineKnot{joints(2) + 0.03, 0.1};
  const PlateMotions motions =
      plate_jacobian(robot.nominal(), plate_at(robot.nominal(), pose), joints, {joint, spline});
  EXPECT_NEAR(spline.knot->at(joints(2)), 2.0 / 3.0 - 0.09 * (1.0 - 0.15), 1e-12);
  EXPECT_LT((motions.col(1) - spline.knot->at(joints(2)) * motions.col(0)).norm(), 1e-12 * motions.col(0).norm());
  EXPECT_EQ(SplineKnot({0.0, 1.0}).at(2.0), 0.0);
  EXPECT_NEAR(SplineKnot({0.0, 1.0}).at(-1.0), 1.0 / 6.0, 1e-12);
}

/// Nobody stated it: 36 rows to spare know the noise of one machine to 0.12 of it.
TEST_F(Variances, NoiseThatNobodyStated) {
  double mean = 0.0;
  for (int number = 0; number < 10; ++number) {
    const Measurements measured = measured_machine(robot, stations, number, {.noise = 0.03}).measurements;
    mean += calibrate(robot, measured, {.states_use = false, .diagnose = false}).noise / 10.0;
  }
  EXPECT_NEAR(mean, 0.03, 0.0045);
}

/// Whatever the rounds before it knew, the last answer is one for the noise that is stated with it: to solve again
/// moves nothing by more than a thousandth of its standard deviation, and what the readings scatter is within 2 % of
/// that noise.
TEST_F(Variances, SettlesAtTheAnswer) {
  for (int number = 0; number < 10; ++number) {
    const Measurements measured = measured_machine(robot, stations, number, {.noise = 0.03}).measurements;
    detail::StageFit stage = fit(measured);
    const detail::Scatter scatter = stage.scatter();
    EXPECT_NEAR(std::sqrt(scatter.sum / scatter.redundancy), 1.0, 0.02);
    const Eigen::VectorXd settled = stage.fit().parameters;
    const Eigen::ArrayXd std = stage.covariance().diagonal().cwiseSqrt();
    stage.solve();
    EXPECT_LT(((stage.fit().parameters - settled).array().abs() / std).maxCoeff(), 1e-3);
  }
}

/// Visits and poses of a sound machine scatter alike, as stated.
TEST_F(Variances, ScatterOfVisitsAndOfPosesIsTheNoise) {
  Measurements measured = read(kNoise, 1.0, 3);
  state_sigma(measured, kNoise);
  const detail::StageFit stage = fit(measured);
  const detail::Scatter all = stage.scatter(),
                        visits = detail::scatter_of_visits(stage.observation(), stage.fit().parameters);
  EXPECT_EQ(visits.redundancy, 19.0 * 2.0 * 3.0);
  EXPECT_NEAR(visits.sum / visits.redundancy, 1.0, 0.4);                                 // deviation 0.13
  EXPECT_NEAR((all.sum - visits.sum) / (all.redundancy - visits.redundancy), 1.0, 0.8);  // deviation 0.25
}

/// Two instruments read the same machine, one ten times as well: each series enters by its own noise.
TEST_F(Variances, EachSeriesHasItsOwnNoise) {
  const SourceErrors errors = measured_machine(robot, stations, 5, {}).errors;
  Measurements both = measure(robot, errors, stations, 5, {.noise = kNoise, .repeats = 4});
  both.series.push_back(measure(robot, errors, stations, 6, {.noise = 10.0 * kNoise, .repeats = 4}).series[0]);
  detail::StageFit stage = fit(both);
  EXPECT_EQ(stage.observation().noise()[0], stage.observation().noise()[1]);  // before anything tells them apart
  const std::optional<detail::Explanation> found = detail::explained(stage, both, options);
  ASSERT_TRUE(found);
  const detail::NoiseOfSeries& entered = stage.observation().noise();
  EXPECT_NEAR(entered[1].unstated / entered[0].unstated, 10.0, 2.5);
  EXPECT_NEAR(found->noise[0].unstated * options.noise.point, kNoise, 0.2 * kNoise);
  EXPECT_NEAR(found->noise[1].unstated * options.noise.point, 10.0 * kNoise, 2.0 * kNoise);
}

TEST_F(Variances, StatedNoiseThatIsThreeTimesAsLarge) {
  Measurements measured = read(3.0 * kNoise, 1.0, 3);
  state_sigma(measured, kNoise);
  const Calibration found = calibrate(robot, measured, {.states_use = false, .diagnose = false});
  EXPECT_NEAR(*found.unit_weight_std, 3.0, 0.5);
  EXPECT_THAT(found.notes, Contains(HasSubstr("times as much as their stated sigmas")));
}

/// A joint that stops 0.02 deg aside at each visit: which one, how far, and what a single visit is worth.
TEST_F(Variances, AJointThatDoesNotRepeatIsNamed) {
  const double off = to_radians(0.02);
  const Calibration found = calibrate(robot, with_joint_off(off, 1, true, 3), {.diagnose = false});
  EXPECT_NEAR(found.visit_std(1), off, 0.3 * off);
  EXPECT_LT(std::max(found.visit_std(0), found.visit_std(2)), 0.4 * off);
  EXPECT_LT(found.joint_std.maxCoeff(), 0.3 * off);
  EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("does not repeat: the joint of limb 2"), HasSubstr("deg"))));
  ASSERT_TRUE(found.use && found.use_mean);
  EXPECT_GT(found.use->distance.U, 2.0 * found.use_mean->distance.U);
  const Calibration refused = calibrate(
      robot, with_joint_off(off, 1, true, 3),
      {.limits = {.distance = 0.5 * (found.use->distance.U + found.use_mean->distance.U)}, .diagnose = false});
  EXPECT_FALSE(refused.accepted());  // a limit is for any single visit
}

/// Readings scatter as much more than stated as the joint does, and their noise is as stated.
TEST_F(Variances, StatedNoiseIsToldFromALooseJoint) {
  Measurements measured = with_joint_off(to_radians(0.02), 1, true, 3);
  state_sigma(measured, kNoise);
  const Calibration found = calibrate(robot, measured, {.states_use = false, .diagnose = false});
  EXPECT_NEAR(*found.unit_weight_std, 1.0, 0.2);
  EXPECT_GT(*found.fit_probability, 1e-3);
}

/// The same side at each visit of a pose: backlash. No visit is better or worse than their mean.
TEST_F(Variances, AJointThatStandsElsewhereAtEachPoseIsNamed) {
  const double off = to_radians(0.02);
  const Calibration found = calibrate(robot, with_joint_off(off, 1, false, 3), {.diagnose = false});
  EXPECT_GT(found.joint_std(1), 0.4 * off);
  EXPECT_LT(found.visit_std.maxCoeff(), 0.1 * off);
  EXPECT_THAT(found.notes, Contains(HasSubstr("the poses differ from the model by")));
  EXPECT_NEAR(found.noise, kNoise, 0.2 * kNoise);
  EXPECT_LT(found.use->distance.U, 1.1 * found.use_mean->distance.U);
}

TEST_F(Variances, PriorsThatNoTableCanUseAreRefused) {
  const Measurements measured = read(kNoise, 1.0);
  CalibrationOptions options;
  options.discrepancies.length = 0.1;
  EXPECT_THROW((void)calibrate(robot, measured, options), InvalidArgument);
  options.discrepancies = {.visits = 0.0};
  EXPECT_THROW((void)calibrate(robot, measured, options), InvalidArgument);
}

TEST_F(Variances, AWrongPartIsNamed) {
  EXPECT_THAT(with_wrong("arm_length", 30.0, false).notes,
              Contains(AllOf(HasSubstr("arm_length of limb 2 is"), HasSubstr("check the part and the tolerance"))));
}

TEST_F(Variances, AKindOfPartIsNamed) {
  EXPECT_THAT(with_wrong("arm_length", 8.0, true).notes, Contains(HasSubstr("arm_length of all limbs are")));
}

/// A pose that was another at all its visits is left out, and everything else is as it would be without it.
TEST_F(Variances, AWrongPoseIsNamedAndLeftOut) {
  Measurements measured = read(kNoise, 1.0, 3);
  const Calibration clean = calibrate(robot, measured, {.diagnose = false});
  for (PointReading& one : measured.series.front().readings) {
    if (one.station == 7) one.point += Eigen::Vector3d(0.3, -0.32, 0.24);
  }
  const Calibration found = calibrate(robot, measured, {.diagnose = false});
  EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("all readings of pose " + stations[7].name), HasSubstr(" mm"))));
  EXPECT_LT(found.use->distance.U, 1.3 * clean.use->distance.U);
}

/// Of readings without noise, too: what is written can be read. Of more poses than a table holds, and of few.
TEST_F(Variances, CovariancesAreSemidefiniteToRounding) {
  constexpr double kRounding = 1e-11;  // of correlations
  for (const auto& [one, circle] :
       {std::pair(catalogue::linear_delta(), 34), std::pair(catalogue::rotary_delta(), 9)}) {
    const std::vector<Station> poses = fine_stations(one, circle);
    const Calibration found = calibrate(one, measured_machine(one, poses, 1, {}).measurements, {.diagnose = false});
    ASSERT_TRUE(found.accepted()) << found.brief();
    KnownErrors known{.errors = {}, .parameters = {}, .covariance = found.covariance};
    add_drives(found.drives, found.drive_covariance, known);
    for (const Eigen::MatrixXd& covariance : {known.covariance, found.noise_covariance}) {
      const Eigen::VectorXd inverse = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
      EXPECT_GT(detail::symmetric_eigenvalues(correlations).minCoeff(), -kRounding) << one.name();
    }
  }
}

/// Without repeats the noise is what was stated, and there may be more of it, as there is here.
TEST_F(Variances, WithoutRepeatsMoreNoiseAndJointsAreAlike) {
  robot = catalogue::huang2016();
  Measurements measured = measured_machine(robot, fine_stations(robot, 9), 3, {.noise = 3.0 * kNoise}).measurements;
  state_sigma(measured, 0.005);
  const Calibration found = calibrate(robot, measured, {.states_use = false, .diagnose = false});
  EXPECT_THAT(found.components, Contains(testing::Field(&Component::told, true))) << found.brief();
}

/// Of more readings than a table holds variances are told by some, and errors by all.
TEST_F(Variances, ManyPosesAreKnownAsWellAsTheirNumberSays) {
  std::vector<Station> many;
  for (int part = 0; part < 8; ++part) {
    for (Station one : fine_stations(robot, 9 + part)) {
      one.name += fmt::format("_{}", part);
      one.commanded.position.z() += 2.0 * part;
      many.push_back(one);
    }
  }
  const auto std_of = [&](const std::vector<Station>& poses) {
    const MeasuredMachine machine = measured_machine(robot, poses, 3, {.noise = kNoise, .repeats = 2});
    const Calibration found = calibrate(robot, machine.measurements, {.states_use = false, .diagnose = false});
    double squares = 0.0, count = 0.0;
    for (const ParameterEstimate& one : found.parameters) {
      if (!one.identified()) continue;
      squares += std::pow((one.value - machine.errors(one.limb, one.source)) / *one.std, 2);
      ++count;
    }
    EXPECT_LT(std::sqrt(squares / count), 1.8);
    return found.covariance.trace();
  };
  EXPECT_LT(std_of(many), std_of(stations));
}

}  // namespace
}  // namespace paracal::test::variances_test

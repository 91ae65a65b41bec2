#include "surrogate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/fit/linear_estimate.hpp"
#include "calibration/fit/sought.hpp"
#include "numerics/dense.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal {
namespace {

constexpr Eigen::Index kBlock = 64;  // machines: their poses stay in the cache

/// What a machine of these tolerances may have.
std::vector<SoughtSource> varying_errors(const Robot& robot, const Tolerances& tolerances) {
  std::vector<SoughtSource> errors;
  for (const Parameter& one : robot.parameters()) {
    if (tolerances.std(one.source) > 0.0) errors.push_back({one.limb, one.source});
  }
  return errors;
}

/// As the residuals tell the metrologist in the end.
CalibrationOptions with_true_noise(const ProductionPlan& plan) {
  constexpr double kSmallest = 1e-5;  // mm or rad: a perfect instrument is not believed
  CalibrationOptions options = plan.calibration;
  const VirtualInstrument& instrument = plan.instrument;
  options.noise.point = options.noise.body =
      std::max(std::hypot(instrument.noise, instrument.repeatability), kSmallest);
  if (instrument.rotation_noise > 0.0) options.noise.rotation = std::max(instrument.rotation_noise, kSmallest);
  return options;
}

/// x of all poses, then y, then z, from three rows a pose.
Eigen::MatrixXd by_coordinate(const std::vector<Eigen::MatrixXd>& of_poses) {
  const auto count = static_cast<Eigen::Index>(of_poses.size()), rows = of_poses.front().rows();
  Eigen::MatrixXd all(rows * count, of_poses.front().cols());
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index j = 0; j < rows; ++j) all.row(j * count + k) = of_poses[static_cast<std::size_t>(k)].row(j);
  }
  return all;
}

/// Displacements of all poses by a shift and a turn about the middle of them, in tenths of a metre.
Eigen::MatrixXd rigid_motions(const Eigen::Matrix3Xd& places) {
  constexpr double kLever = 100.0;
  const Eigen::Matrix3Xd arms = (places.colwise() - places.rowwise().mean()) / kLever;
  const Eigen::Index n = places.cols();
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * n, 6);
  for (Eigen::Index j = 0; j < 3; ++j) {
    motions.block(j * n, j, n, 1).setOnes();
    // e_j x arm
    const Eigen::Index next = (j + 1) % 3, last = (j + 2) % 3;
    motions.block(next * n, 3 + j, n, 1) = -arms.row(last).transpose();
    motions.block(last * n, 3 + j, n, 1) = arms.row(next).transpose();
  }
  return motions;
}

/// The largest length of vectors whose coordinates stand below each other, x of all, y of all, ..., less the first.
double largest_since_home(const Eigen::Ref<const Eigen::VectorXd>& coordinates, Eigen::Index each) {
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(each);
  for (Eigen::Index first = 0; first < coordinates.size(); first += each) {
    squares += (coordinates.segment(first, each).array() - coordinates(first)).square();
  }
  return std::sqrt(squares.maxCoeff());
}

/// The same without a home.
double largest_length(const Eigen::Ref<const Eigen::VectorXd>& coordinates, Eigen::Index each) {
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(each);
  for (Eigen::Index first = 0; first < coordinates.size(); first += each) {
    squares += coordinates.segment(first, each).array().square();
  }
  return std::sqrt(squares.maxCoeff());
}

}  // namespace

bool Surrogate::follows(const ProductionPlan& plan) {
  return plan.calibration.method == Method::best && plan.calibration.stage == Stage::fine;
}

Surrogate::Surrogate(const Robot& robot, const ProductionPlan& plan)
    : tolerances_(plan.tolerances),
      reserved_(kReservedNumbers * robot.limb_count()),
      errors_(varying_errors(robot, plan.tolerances)),
      stays_level_(robot.is_level()) {
  if (!follows(plan)) throw InvalidArgument("surrogate: expected a fine calibration of all errors with method best");
  ask_readings(robot, plan);
  ask_validation(robot, plan.validation);
}

void Surrogate::ask_readings(const Robot& robot, const ProductionPlan& plan) {
  const CalibrationOptions options = with_true_noise(plan);
  const auto read = [&](std::vector<double> normals, std::uint64_t& asked) {
    RandomStream random(std::move(normals));
    Measurements readings = simulate(robot, {}, plan.stations, plan.instrument, random);
    asked = random.normals();
    return readings;
  };
  std::uint64_t count = 0;
  const Measurements quiet = read({}, count);
  const detail::LinearEstimate fit = detail::linear_estimate(robot, quiet, options, errors_);
  const Eigen::VectorXd nothing = detail::weighed_readings(robot, quiet, options);
  Eigen::MatrixXd by_normal(nothing.size(), static_cast<Eigen::Index>(count));
  for (std::uint64_t k = 0; k < count; ++k) {
    std::vector<double> one(count, 0.0);
    one[k] = 1.0;
    by_normal.col(static_cast<Eigen::Index>(k)) =
        detail::weighed_readings(robot, read(std::move(one), count), options) - nothing;
  }
  const auto varying = static_cast<Eigen::Index>(errors_.size());
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(varying, static_cast<Eigen::Index>(fit.sought.size()));
  for (std::size_t k = 0; k < fit.sought.size(); ++k) {
    const auto same = std::ranges::find_if(
        errors_, [&](const SoughtSource& one) { return detail::is_same_error(one, fit.sought[k]); });
    if (same != errors_.end()) found(same - errors_.begin(), static_cast<Eigen::Index>(k)) = 1.0;
  }
  left_by_error_ = Eigen::MatrixXd::Identity(varying, varying) - detail::product(found, fit.by_error);
  left_by_normal_ = -detail::product(detail::product(found, fit.by_reading), by_normal);
}

void Surrogate::ask_validation(const Robot& robot, const std::vector<Station>& validation) {
  std::vector<Eigen::MatrixXd> position, rotation, tilt;
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(validation.size()));
  for (std::size_t k = 0; k < validation.size(); ++k) {
    const Pose& pose = validation[k].commanded;
    const DifferentiableMachine& nominal = robot.nominal();
    const PlateMotions motions =
        plate_jacobian(nominal, plate_at(nominal, pose), inverse(nominal, pose).joints, errors_);
    if (motions.cols() == 0) throw Unreachable("surrogate: the nominal machine is singular at a validation pose");
    const Eigen::MatrixXd turn = stays_level_ ? Eigen::MatrixXd(motions.bottomRows<3>())
                                              : plate_rotation(pose.tilt).axes * motions.bottomRows<3>();
    position.emplace_back(motions.topRows<3>());
    rotation.emplace_back(stays_level_ ? Eigen::MatrixXd(motions.row(3)) : turn);
    tilt.emplace_back(turn.topRows(2));
    places.col(static_cast<Eigen::Index>(k)) = pose.position;
  }
  position_ = by_coordinate(position);
  rotation_ = by_coordinate(rotation);
  tilt_ = by_coordinate(tilt);
  directions_ = places.colwise() - places.col(0);
  motions_ = rigid_motions(places);
  motion_fit_ = detail::pseudo_inverse(motions_);
}

Surrogate::Block Surrogate::drawn_errors(const Block& normals, std::uint64_t seed, std::uint64_t first) const {
  Block errors(static_cast<Eigen::Index>(errors_.size()), normals.cols());
  for (Eigen::Index m = 0; m < normals.cols(); ++m) {
    for (std::size_t k = 0; k < errors_.size(); ++k) {
      const Source source = errors_[k].source;
      const std::uint64_t number = number_of(errors_[k].limb, source);
      const double normal = number < reserved_
                                ? normals(static_cast<Eigen::Index>(number), m)
                                : RandomStream(seed, first + static_cast<std::uint64_t>(m)).normal_at(number);
      errors(static_cast<Eigen::Index>(k), m) = source_error(tolerances_, source, normal);
    }
  }
  return errors;
}

/// The normal numbers of machines, a column each: those of their errors, then those of their readings.
Surrogate::Block Surrogate::drawn_normals(std::uint64_t seed, std::uint64_t first, Eigen::Index count) const {
  const Eigen::Index numbers = static_cast<Eigen::Index>(reserved_) + left_by_normal_.cols();
  Block normals(numbers + numbers % 2, count);
  for (Eigen::Index m = 0; m < count; ++m) {
    for (Eigen::Index k = 0; k < numbers; k += 2) {
      const std::array<double, 2> pair =
          normal_pair(seed, first + static_cast<std::uint64_t>(m), static_cast<std::uint64_t>(k / 2));
      normals(k, m) = pair[0];
      normals(k + 1, m) = pair[1];
    }
  }
  return normals;
}

/// How far off machines with these errors are, all but their tilt.
void Surrogate::look(const Block& off, Values* machines, Accuracy Values::*when) const {
  Block position = position_ * off;
  const Block rotation = rotation_ * off;
  const Eigen::Index n = directions_.cols();
  const Eigen::ArrayXd nominal = directions_.colwise().norm();
  for (Eigen::Index m = 0; m < off.cols(); ++m) {
    Accuracy& accuracy = machines[m].*when;
    Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(n);
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto one = position.col(m).segment(j * n, n).array();
      squares += (one - one(0) + directions_.row(j).transpose().array()).square();
    }
    accuracy[ErrorKind::distance] = (squares.sqrt() - nominal).abs().maxCoeff();
    accuracy[ErrorKind::volumetric] = largest_since_home(position.col(m), n);
    accuracy[ErrorKind::rotation] = largest_since_home(rotation.col(m), n);
  }
  position -= motions_ * (motion_fit_ * position);
  for (Eigen::Index m = 0; m < off.cols(); ++m) {
    (machines[m].*when)[ErrorKind::volumetric_aligned] = largest_length(position.col(m), n);
  }
}

void Surrogate::look_at_tilt(const Block& off, Values* machines, Accuracy Values::*when) const {
  const Block tilt = tilt_ * off;
  for (Eigen::Index m = 0; m < off.cols(); ++m) {
    (machines[m].*when)[ErrorKind::tilt] = largest_length(tilt.col(m), directions_.cols());
  }
}

double Surrogate::multiplications() const {
  const Eigen::Index once = left_by_error_.size() + left_by_normal_.size();
  const Eigen::Index twice = position_.size() + rotation_.size() + tilt_.size() + 2 * motions_.size();
  return static_cast<double>(once + 2 * twice);
}

std::vector<Surrogate::Values> Surrogate::machines(std::uint64_t seed, std::uint64_t first, std::uint64_t count) const {
  std::vector<Values> all(count);
  for (std::uint64_t begin = 0; begin < count; begin += kBlock) {
    const Block normals =
        drawn_normals(seed, first + begin, std::min(static_cast<Eigen::Index>(count - begin), kBlock));
    const auto noise = normals.middleRows(static_cast<Eigen::Index>(reserved_), left_by_normal_.cols());
    const Block errors = drawn_errors(normals, seed, first + begin);
    const Block left = left_by_error_ * errors + left_by_normal_ * noise;
    Values* const here = &all[begin];
    look(errors, here, &Values::before);
    look(left, here, &Values::after);
    look_at_tilt(errors, here, &Values::before);
    if (!stays_level_) look_at_tilt(left, here, &Values::after);
    for (Eigen::Index m = 0; stays_level_ && m < normals.cols(); ++m) {
      here[m].after[ErrorKind::tilt] = here[m].before[ErrorKind::tilt];
    }
  }
  return all;
}

}  // namespace paracal

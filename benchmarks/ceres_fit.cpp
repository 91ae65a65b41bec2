#include "ceres_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <array>
#include <type_traits>

#include "kinematics/linear_closure.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/machine_impl.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kLimbs = 4;

double plain(double number) { return number; }
template <int N>
double plain(const ceres::Jet<double, N>& number) {
  return number.a;
}

template <typename Scalar, typename Number>
BasicSourceErrors<Scalar> source_errors(const Number* numbers) {
  BasicSourceErrors<Scalar> errors;
  for (std::size_t k = 0; k < kSources; ++k) {
    const Source source = sources_of(Actuator::revolute)[k % sources_of(Actuator::revolute).size()];
    if constexpr (std::is_same_v<Scalar, double>) {
      errors(k / sources_of(Actuator::revolute).size(), source) = plain(numbers[k]);
    } else {
      errors(k / sources_of(Actuator::revolute).size(), source) = numbers[k];
    }
  }
  return errors;
}

/// Residuals of the rods, mm, with the plate in plain numbers: rod_residuals without products by zero derivatives.
template <typename Scalar>
Eigen::Matrix<Scalar, 2 * kLimbs, 1> rod_residuals_at(const BasicMachine<Scalar>& machine, const PlateState& plate,
                                                      const Joints& joints) {
  const Eigen::Matrix3d rotation = plate_rotation(plate.tilt).matrix;
  Eigen::Matrix<Scalar, 2 * kLimbs, 1> residuals;
  for (std::size_t i = 0; i < kLimbs; ++i) {
    const BasicLimb<Scalar>& limb = machine.limbs[i];
    const Elbow<Scalar> elbow = elbow_of(limb, Scalar(joints(static_cast<Eigen::Index>(i))));
    const std::array<Vector3<Scalar>, 2> hinges = plate_joints(machine, limb, Scalar(plate.slide));
    for (std::size_t j = 0; j < 2; ++j) {
      const Vector3<Scalar> lever = rotation * hinges[j];
      const Vector3<Scalar> rod = lever + plate.position - elbow.joint[j];
      residuals(static_cast<Eigen::Index>(2 * i + j)) = rod.norm() - limb.rod[j];
    }
  }
  return residuals;
}

/// Rows x, y, z of (J^T J)^-1 J^T.
Eigen::Matrix<double, 3, 2 * kLimbs> centre_per_rod(const Machine& machine, const PlateState& plate,
                                                    const Joints& joints) {
  const auto elbows = detail::elbows_of<kLimbs>(machine, joints);
  const detail::LinearClosure<kLimbs> linear = detail::linearize<kLimbs>(machine, plate, elbows);
  return linear.normal().selfadjointView<Eigen::Lower>().llt().solve(linear.jacobian.transpose()).topRows<3>();
}

/// Whitened points of `count` stations from `first` on, three residuals each.
class Points {
 public:
  Points(const FineFit& fit, std::size_t first, std::size_t count) : fit_(&fit), first_(first), count_(count) {}

  template <typename Scalar>
  bool operator()(const Scalar* errors, const Scalar* frame, Scalar* residuals) const {
    const RobotDescription& robot = fit_->robot.description();
    const Machine plain_machine = build(robot, source_errors<double>(errors));
    const BasicMachine<Scalar> machine = build(robot, source_errors<Scalar>(errors));
    for (std::size_t k = first_; k < first_ + count_; ++k) {
      const ForwardResult pose = forward(plain_machine, fit_->joints[k]);
      if (!pose.ok()) return false;
      const Vector3<Scalar> centre = plate_centre(machine, plain_machine, pose.plate, fit_->joints[k]);
      point_residual(centre, fit_->points[k], frame, residuals + 3 * (k - first_));
    }
    return true;
  }

 private:
  template <typename Scalar>
  static Vector3<Scalar> plate_centre(const BasicMachine<Scalar>& machine, const Machine& plain_machine,
                                      const PlateState& plate, const Joints& joints) {
    if constexpr (std::is_same_v<Scalar, double>) {
      return plate.position;
    } else {
      const Vector3<Scalar> step =
          centre_per_rod(plain_machine, plate, joints) * rod_residuals_at(machine, plate, joints);
      return plate.position - step;
    }
  }

  template <typename Scalar>
  void point_residual(const Vector3<Scalar>& centre, const Eigen::Vector3d& read, const Scalar* frame,
                      Scalar* residual) const {
    const Vector3<Scalar> turned = fit_->frame.rotation * centre;
    Vector3<Scalar> point;
    ceres::AngleAxisRotatePoint(frame, turned.data(), point.data());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      residual[axis] = (point(axis) + frame[3 + axis] - read(axis)) / fit_->sigma;
    }
  }

  const FineFit* fit_;
  std::size_t first_, count_;
};

ceres::Solver::Options options_of(CeresSolver solver) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver == CeresSolver::qr ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.initial_trust_region_radius = options.max_trust_region_radius;  // undamped
  options.function_tolerance = 1e-9;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  return options;
}

void add_points(const FineFit& fit, CeresCost cost, double* errors, double* frame, ceres::Problem& problem) {
  const std::size_t stations = fit.points.size();
  if (cost == CeresCost::all_stations) {
    using All = ceres::AutoDiffCostFunction<Points, ceres::DYNAMIC, kSources, kFrame>;
    problem.AddResidualBlock(new All(new Points(fit, 0, stations), static_cast<int>(3 * stations)), nullptr, errors,
                             frame);
    return;
  }
  using One = ceres::AutoDiffCostFunction<Points, 3, kSources, kFrame>;
  for (std::size_t k = 0; k < stations; ++k) {
    problem.AddResidualBlock(new One(new Points(fit, k, 1)), nullptr, errors, frame);
  }
}

void add_priors(const FineFit& fit, double* errors, ceres::Problem& problem) {
  const Eigen::MatrixXd weight = fit.prior_std.cwiseInverse().asDiagonal();
  problem.AddResidualBlock(new ceres::NormalPrior(weight, Eigen::VectorXd::Zero(kSources)), nullptr, errors);
}

std::array<double, kSources> numbers_of(const SourceErrors& errors) {
  std::array<double, kSources> numbers{};
  for (std::size_t k = 0; k < kSources; ++k)
    numbers[k] = errors(k / sources_of(Actuator::revolute).size(),
                        sources_of(Actuator::revolute)[k % sources_of(Actuator::revolute).size()]);
  return numbers;
}

RigidMotion frame_of(const double* frame, const RigidMotion& start) {
  Eigen::Matrix3d turn;
  ceres::AngleAxisToRotationMatrix(frame, turn.data());
  return {turn * start.rotation, Eigen::Vector3d(frame[3], frame[4], frame[5])};
}

/// Whitened points of all stations, with our derivatives by all unknowns.
class OurRows final : public ceres::CostFunction {
 public:
  explicit OurRows(const FineSolve& fit) : fit_(&fit) {
    fit.rows(fit.start(), rows_);
    set_num_residuals(static_cast<int>(rows_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(fit.start().size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index unknowns = fit_->start().size();
    if (!fit_->rows(Eigen::Map<const Eigen::VectorXd>(parameters[0], unknowns), rows_)) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.rows()) = rows_.col(unknowns);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor>(jacobians[0], rows_.rows(), unknowns) = rows_.leftCols(unknowns);
    }
    return true;
  }

 private:
  const FineSolve* fit_;
  mutable Eigen::MatrixXd rows_;  // one thread
};

}  // namespace

std::string ceres_version() { return "Ceres " CERES_VERSION_STRING; }

FineAnswer solve_with_ceres(const FineSolve& fit, CeresSolver solver) {
  Eigen::VectorXd unknowns = fit.start();
  const Eigen::VectorXd prior_std = fit.prior_std();
  std::vector<Eigen::Index> known;
  for (Eigen::Index k = 0; k < prior_std.size(); ++k) {
    if (prior_std(k) > 0.0) known.push_back(k);
  }
  Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(known.size()), unknowns.size());
  for (std::size_t row = 0; row < known.size(); ++row) {
    weight(static_cast<Eigen::Index>(row), known[row]) = 1.0 / prior_std(known[row]);
  }
  ceres::Problem problem;
  problem.AddResidualBlock(new OurRows(fit), nullptr, unknowns.data());
  problem.AddResidualBlock(new ceres::NormalPrior(weight, Eigen::VectorXd::Zero(unknowns.size())), nullptr,
                           unknowns.data());
  ceres::Solver::Summary summary;
  ceres::Solve(options_of(solver), &problem, &summary);
  return fit.answer(unknowns, static_cast<int>(summary.iterations.size()) - 1);
}

FineAnswer solve_with_ceres(const FineFit& fit, CeresCost cost, CeresSolver solver) {
  std::array<double, kSources> errors = numbers_of(fit.start);
  const Eigen::Vector3d& shift = fit.frame.translation;
  std::array<double, kFrame> frame{0.0, 0.0, 0.0, shift.x(), shift.y(), shift.z()};
  ceres::Problem problem;
  add_points(fit, cost, errors.data(), frame.data(), problem);
  add_priors(fit, errors.data(), problem);
  ceres::Solver::Summary summary;
  ceres::Solve(options_of(solver), &problem, &summary);
  return {source_errors<double>(errors.data()), frame_of(frame.data(), fit.frame),
          static_cast<int>(summary.iterations.size()) - 1};
}

}  // namespace paracal::benchmark

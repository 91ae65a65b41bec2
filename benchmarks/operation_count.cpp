#include "operation_count.hpp"

#include <Eigen/LU>

#include "floor.hpp"
#include "paracal/kinematics/closure.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/machine_impl.hpp"

namespace paracal::benchmark {
namespace {

template <int Rows, int Columns>
using Matrix = Eigen::Matrix<Counted, Rows, Columns>;
using CountedMachine = BasicMachine<Counted>;

// Hand counts of vector work; a sum or a scaling of vectors is 3.
constexpr double kDot = 5.0, kCross = 9.0, kRotate = 15.0, kVector = 3.0, kNorm = 6.0;

Operations by_hand(double arithmetic, double functions = 0.0) { return {arithmetic, functions}; }

// Textbook counts for n unknowns. Eigen spends somewhat more, but its factorizations of counting numbers take half a
// minute to compile.

/// L L^T: n roots, a division for every other entry of L, and pairs of multiplication and subtraction.
constexpr double cholesky(double n) { return n + n * (n - 1.0) / 2.0 + n * (n * n - 1.0) / 3.0; }

/// Forward and backward substitution of one right-hand side.
constexpr double substitutions(double n) { return 2.0 * n * n; }

/// P L U and substitution.
constexpr double lu_solution(double n) {
  return n * (n - 1.0) / 2.0 + n * (n - 1.0) * (2.0 * n - 1.0) / 3.0 + substitutions(n) - n;
}

/// Counts the parts of the kinematics of N limbs, in the order in which the library's sources call them.
template <int N>
class Counter {
 public:
  explicit Counter(const CountedMachine& machine) : machine_(machine) { joints_.fill(Counted(0.1)); }

  PoseOperations operator()() const {
    const Operations factor_normal = normal() + factor();
    return {
        .floor = N * by_hand(1.0, 1.0),
        .inverse = inverse(),
        .inverse_iteration =
            elbows() + linearize() + joints_to_gradient() + tilt_to_gradient() + gradient() + settle_step(),
        .forward_start =
            elbows() + default_start() + level_start() + linearize() + gradient() + by_hand(2.0 * kUnknowns),
        .forward_iteration = factor_normal + gradient() + solve(1) + judge_step() + linearize(),
        .error_model = inverse() + assemble() + solve_error_model(),
        .exact_jacobian = elbows() + linearize() + factor_normal + solve(kRods) + rod_derivatives(),
    };
  }

 private:
  static constexpr int kUnknowns = N + 3;
  static constexpr int kRods = 2 * N;
  static constexpr bool kHasSlide = N == 4;

  // inverse.cpp

  Operations inverse() const {
    const Operations slide = by_hand(1.0 + kVector);
    const Operations joint_at_plate = by_hand(3.0 * kVector);
    const Operations triangle =
        count([&] { keep(triangle_arguments(machine_.limbs[0], Vector3<Counted>::Ones().eval())); });
    const Operations joint = by_hand(1.0, 1.0);
    return slide + N * (joint_at_plate + triangle + joint);
  }

  static Operations joints_to_gradient() {
    const double rod = kVector + kCross + kDot + 2.0 * kUnknowns;
    return by_hand(kRods * rod);
  }

  static Operations tilt_to_gradient() { return by_hand(3.0 * kUnknowns * (2.0 * kRods - 1.0)); }
  static Operations settle_step() { return by_hand(lu_solution(kUnknowns) + kUnknowns); }

  // linear_closure.hpp

  Operations elbows() const {
    return N * count([&] { keep(elbow_of(machine_.limbs[0], joints_[0])); });
  }

  /// The lines up to the residual are those of rod_residuals, whose elbows are counted elsewhere.
  Operations linearize() const {
    const Operations residuals = count([&] { keep(rod_residuals(machine_, BasicPlateState<Counted>{}, joints_)); });
    const double unit_vector = kVector, slide = kHasSlide ? kDot + 1.0 : 0.0, tilt = kCross + kRotate;
    const double slide_direction = kRotate;
    return residuals - elbows() + by_hand(slide_direction + kRods * (unit_vector + slide + tilt));
  }

  Operations gradient() const {
    const Matrix<kRods, kUnknowns> jacobian = Matrix<kRods, kUnknowns>::Ones();
    const Matrix<kRods, 1> residual = Matrix<kRods, 1>::Ones();
    return count([&] { keep(jacobian.transpose().lazyProduct(residual).eval()); });
  }

  Operations normal() const {
    const Matrix<kRods, kUnknowns> jacobian = Matrix<kRods, kUnknowns>::Ones();
    Matrix<kUnknowns, kUnknowns> normal;
    return count([&] { normal.template triangularView<Eigen::Lower>() = jacobian.transpose().lazyProduct(jacobian); });
  }

  static Operations factor() { return by_hand(cholesky(kUnknowns)); }
  static Operations solve(int columns) { return by_hand(columns * substitutions(kUnknowns)); }

  // forward.cpp

  static Operations default_start() {
    const double wrist = 3.0 * kVector, centre = 2.0 * kVector, spread = 5.0, rod = 4.0, depth = 6.0;
    return by_hand(N * (wrist + centre + spread + rod) + depth);
  }

  static Operations level_start() {
    const double iterations = 3.0, slide_direction = kVector, d = 6.0 * kVector, residual = 2.0 + kDot + 3.0;
    const double limb = slide_direction + d + residual + (kHasSlide ? kDot : 0.0);
    const double step =
        count([] { keep((Matrix<N, N>::Identity().eval().inverse() * Matrix<N, 1>::Ones()).eval()); }).arithmetic;
    return by_hand(iterations * (N * limb + step + N) + 2.0 * N);
  }

  static Operations judge_step() {
    const double length = 2.0 * N + kNorm + 1.0, cost = 2.0 * kRods - 1.0, advance = kUnknowns;
    return by_hand(length + cost + advance);
  }

  // error_model.cpp

  Operations assemble() const {
    const Operations arm = count([&] { keep(arm_directions(machine_.limbs[0], joints_[0])); });
    const double a_s = 1.0 + 2.0 * kVector, l = 4.0 * kVector + kNorm + kVector;
    const double slide = kHasSlide ? kDot + 1.0 : 0.0, A_de = kCross, A_ee = kCross;
    const double B_d = 4.0 * kDot + 2.0, B_e = 5.0 * kDot;
    return N * (arm + by_hand(a_s + l + slide + A_de + A_ee + B_d + B_e, 2.0)) + by_hand(1.0);
  }

  Operations solve_error_model() const {
    const Matrix<N, N> A_dd = Matrix<N, N>::Identity();
    const Matrix<N, 3> A_de = Matrix<N, 3>::Identity(), A_ee = Matrix<N, 3>::Identity();
    const Operations dense = count([&] {
      const Matrix<N, N> A_dd_inverse = A_dd.inverse();
      const Matrix<3, 3> normal = A_ee.transpose() * A_ee;
      const Matrix<3, 3> normal_inverse = normal.inverse();
      const Matrix<3, N> A_ee_pseudo_inverse = normal_inverse * A_ee.transpose();
      keep((-A_dd_inverse * A_de * A_ee_pseudo_inverse).eval());
    });
    const double conditions = 2.0 * (2.0 * N * N) + 2.0 * (2.0 * 9.0) + 4.0;
    const double G = N * (N * ErrorModel::kPosition + (N + 3.0) * ErrorModel::kTilt);
    return dense + by_hand(conditions + G);
  }

  // exact_jacobian.cpp

  Operations rod_derivatives() const {
    const double turn = kCross + kDot, turns = 9.0;  // about the elbow 5, about the plate 4
    const double halves = kVector + 2.0 * kVector + 2.0 + kVector + kRotate, directions = 2.0 * kRotate + 5.0 * kVector;
    // arm_length; the sums of alpha0 and beta0; rod_difference; width_difference
    const double rest = kDot + 2.0 + 1.0 + (kDot + 1.0);
    const double accumulate = 2.0 * kUnknowns * sources_of(Actuator::revolute).size();
    const Operations rotation = count([&] { keep(plate_rotation(Vector3<Counted>::Zero().eval())); });
    return rotation + by_hand(kRods * (turn * turns + halves + directions + rest + accumulate));
  }

  CountedMachine machine_;
  std::array<Counted, kMaxLimbs> joints_;
};

}  // namespace

PoseOperations count_operations(const Robot& robot) {
  const auto machine = build(robot.description(), BasicSourceErrors<Counted>{});
  return robot.limb_count() == 4 ? Counter<4>(machine)() : Counter<3>(machine)();
}

}  // namespace paracal::benchmark

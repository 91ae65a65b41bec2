#pragma once

#include <cmath>
#include <vector>

#include "interleaved_timing.hpp"
#include "task.hpp"

namespace paracal::benchmark {

/// What close_triangle gives to its square root, and what then goes to the arctangent.
template <typename Scalar>
struct TriangleArguments {
  Scalar radicand, y, x;
};

/// The lines of close_triangle, over any scalar; they follow
/// include/paracal/mechanism/limb_closure.hpp by hand.
template <typename Scalar>
TriangleArguments<Scalar> triangle_arguments(const BasicLimb<Scalar>& limb, const Vector3<Scalar>& joint_at_plate) {
  using std::sqrt;
  const Vector3<Scalar> d = joint_at_plate - limb.base;
  const Scalar diameter = 2.0 * limb.arm;
  const Scalar a = diameter * d.dot(limb.frame.col(0));
  const Scalar b = diameter * d.dot(limb.frame.col(1));
  const Scalar rod = limb.mean_rod();
  const Scalar k = d.squaredNorm() + limb.arm * limb.arm - rod * rod;
  const Scalar radicand = a * a + b * b - k * k;
  const Scalar root = sqrt(radicand);
  const Scalar w = b < Scalar(0) ? root : -root;
  return {radicand, b * k + a * w, a * k - b * w};
}

/// What the closed-form inverse cannot avoid: a square root and an arctangent a limb.
class Floor {
 public:
  explicit Floor(const Task& task) {
    const Machine& machine = task.robot.nominal();
    for (const Pose& pose : task.poses) {
      const Eigen::Vector3d slide = machine.slide_of(pose.rotation) * machine.slide_axis;
      for (std::size_t i = 0; i < machine.limb_count; ++i) {
        const Limb& limb = machine.limbs[i];
        arguments_.push_back(triangle_arguments<double>(limb, pose.position + limb.plate + limb.slide_sign * slide));
      }
    }
  }

  void pass() const {
    for (const TriangleArguments<double>& arguments : arguments_) {
      keep(std::sqrt(arguments.radicand));
      keep(std::atan2(arguments.y, arguments.x));
    }
  }

  /// Largest difference between the arctangents and the joints of the inverse, rad: 0 while the lines above follow
  /// close_triangle.
  double difference(const Task& task) const {
    double largest = 0.0;
    auto arguments = arguments_.begin();
    for (const Joints& joints : task.joints) {
      for (const double joint : joints) {
        largest = std::max(largest, std::abs(std::atan2(arguments->y, arguments->x) - joint));
        ++arguments;
      }
    }
    return largest;
  }

 private:
  std::vector<TriangleArguments<double>> arguments_;  ///< pose by pose, limb by limb
};

}  // namespace paracal::benchmark

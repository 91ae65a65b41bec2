#pragma once

// Private to calibration: a rigid body on the plate whose pose an instrument reads, as motion capture does.

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/numerics/rigid_fit.hpp"

namespace paracal::detail {

/// Frame of an instrument and a body on a carrier: instrument = frame(robot), carrier = body(body).
struct BodySetUp {
  RigidMotion frame = {}, body = {};
};

/// The set-up with which poses were read as read_k = frame(carrier_k(body)), from nothing: frame and place of the body
/// in turn. Where carriers hardly turn, the place stays near their origin, for the frame takes it up. Gross errors in a
/// minority of poses hardly move it.
/// @param carriers     in the robot's frame.
/// @param seeks_frame  false: it is the robot's.
BodySetUp place_body(const std::vector<RigidMotion>& carriers, const std::vector<RigidMotion>& read, bool seeks_frame);

/// The set-up with which points were read as read_k = frame(carrier_k(place)), `place` the translation of the body:
/// least squares, where carriers hardly turn the place nearest to their origin.
BodySetUp place_reflector(const std::vector<RigidMotion>& carriers, const std::vector<Eigen::Vector3d>& read,
                          bool seeks_frame);

/// Beside what a reflector on this mount may be: "the plate's centre".
std::string_view centre_of(ReflectorMount mount);

}  // namespace paracal::detail

#pragma once

#include <Eigen/Core>
#include <array>

#include "paracal/mechanism/limb.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

struct RobotDescription;
class Robot;

/// Where the plate works, as far as a search for it needs to know; mm and rad.
struct WorkingRange {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the workspace
  Eigen::Vector3d half = Eigen::Vector3d::Zero();    ///< from there to the sides of the box around it
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();    ///< as far as each angle goes, either way
};

/// A robot as built: the constants of all loop closures with the source errors worked in. Fixed size, no heap.
template <typename Scalar>
struct BasicMachine {
  std::size_t limb_count = 0;
  std::array<BasicLimb<Scalar>, kMaxLimbs> limbs;
  Eigen::Vector3d slide_axis = Eigen::Vector3d::Zero();  ///< shat in the plate frame; zero for a rigid plate
  double pinion_radius = 0.0;                            ///< r_g, mm; zero for a rigid plate
  /// The centre lines of the limbs do not say where the plate is: some source error of the tilt group is not zero, or
  /// a parallelogram leans whose plate can be tilted.
  bool tilts_plate = false;
  WorkingRange range = {};
  /// Unit vector from the upper ends of the rods to the plate in the middle of the workspace; zero where it is among
  /// them, or unknown.
  Eigen::Vector3d hang = Eigen::Vector3d::Zero();
  PlateFreedoms freedoms = {};  ///< of the plate, without its slide
  bool is_level = false;        ///< parallelograms alone keep the plate level: three of them, or four and a slide
  bool has_guides = false;      ///< guides hold what is not free: no limb has two rods
  bool has_harmonics = false;   ///< some limb has errors of each turn
  double guided_z = 0.0;        ///< where guides hold z, mm
  double turn_lever = 0.0;      ///< mm at which the rods feel turns of the plate: half the width of a parallelogram
  std::array<std::uint16_t, kMaxLimbs + 1> first_parameter{};  ///< of each limb, and how many there are

  Actuator actuator() const { return limbs[0].actuator; }
  bool has_slide() const { return pinion_radius > 0.0; }
  /// Some tilt of the plate is commanded.
  bool commands_tilt() const { return freedoms.tilt(); }
  /// Limbs more than degrees of freedom: the joints of all must agree.
  std::size_t spare_limbs() const { return limb_count - freedoms.count() - (has_slide() ? 1 : 0); }
  /// How many numbers their joints say besides where the plate is; none where some limb has two rods, which disagree
  /// whatever the joints.
  std::size_t gap_count() const {
    for (std::size_t i = 0; i < limb_count; ++i) {
      if (!limbs[i].has_one_rod()) return 0;
    }
    return spare_limbs();
  }
  /// Slide distance s = r_g phi, mm.
  double slide_of(double rotation) const { return pinion_radius * rotation; }
  /// Rotation phi = s / r_g, rad; 0 for a rigid plate.
  double rotation_of(double slide) const { return has_slide() ? slide / pinion_radius : 0.0; }
  std::size_t parameter_count() const { return first_parameter[limb_count]; }
  /// Place of a source error in Robot::parameters(), for a limb that has it.
  std::size_t parameter(std::size_t limb, Source source) const {
    return first_parameter[limb] + place_in(limbs[limb].actuator, source);
  }
};
using Machine = BasicMachine<double>;

/// The machine that a robot becomes with these source errors. The reduced errors enter Eq. (1) as, with what its limbs
/// differ in by design (LimbDescription::zero, gain, alpha0, beta0) added to them,
///
///   db = e, da = 0;  l_1,2 = l + rod_mean +- rod_difference / 2;  c_c = c + width_difference, c_a = c;
///   alpha3 = alpha0 - alpha03, beta3 = beta0 - beta03;
///   R_0 = Rot(z, gamma) Rot(x, pi/2 + alpha0) Rot(y, beta0),  R_2 = Rot(x, alpha2) Rot(y, beta2),
///   R_3 = Rot(z, gamma) Rot(x, pi/2 + alpha3) Rot(y, beta3).
///
/// Of a rail alpha0 and beta0 are the two directions in which it leans, and no bar at the plate leans with beta0; its
/// drive has a gain:
///
///   R_0 = F Rot(x, alpha0) Rot(z, beta0),  beta3 = -beta03;
///   C = b - L u_1 + ((1 + gain) q + theta_offset) v_1.
///
/// Of limbs with one rod b and a are shifted each by an error of its own, and with F = (u_0, v_0, w_0) of frame_of()
///
///   strut:     l = l_0 + theta_offset + (1 + gain) q;
///   crank:     l = l_1 + rod_length, an arm L + arm_length in R_0 = F Rot(x, alpha0) Rot(y, beta0);
///   carriage:  l = l_1 + rod_length, C = b + normal u_0 + across w_0 + ((1 + gain) q + theta_offset) v_1 on a rail
///              along v_1 of R_0 = F Rot(x, alpha0) Rot(z, beta0).
///
/// With harmonics q stands for where the joint is, q + turn_sine sin(2 pi q / pitch) + turn_cosine cos(2 pi q / pitch)
/// for q commanded.
///
/// Instantiated for double; include machine_impl.hpp for other scalars.
template <typename Scalar>
BasicMachine<Scalar> build(const RobotDescription& robot, const BasicSourceErrors<Scalar>& errors);

Machine build(const Robot& robot, const SourceErrors& errors);

}  // namespace paracal

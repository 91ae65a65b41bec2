#pragma once

#include <string_view>
#include <vector>

#include "paracal/compensation/self_test.hpp"
#include "paracal/mechanism/machine.hpp"
#include "procedure.hpp"

// Machines whose limbs have one rod each as exports need them.

namespace paracal::compensation_detail {

/// A constant of a limb, errors included, under the name that an export gives it.
struct LimbConstant {
  std::string_view name;  ///< of static storage
  std::string_view what;
  std::vector<double> values;  ///< three of a vector, else one
};

/// What a kind of limb needs; of all limbs of a machine the same names.
///
///   strut     |r + R plate - base| = length + growth q
///   crank     |r + R plate - base - arm (cos(q + zero) u + sin(q + zero) v)| = rod
///   carriage  |r + R plate - base - (zero + growth q) v| = rod, (u, v, w) square to each other
std::vector<LimbConstant> constants_of(const Limb& limb);

/// Formulas of any machine of that kind. Their symbols:
///
///   pose[6]    O' in {O}, mm; tilt, rad; what guides hold does not stand in the formulas
///   joints[N]  to command, mm or rad
///   rows[N N]  d joints / d pose, a row a limb, a column each that is free
struct RecordedRods {
  Procedure joints;  ///< pose -> joints
  Procedure rows;    ///< pose -> joints, rows
};
RecordedRods record_single_rods(const Machine& machine);

/// The centre of the workspace, and its rims in all tilts, with the joints of a machine.
/// @throws Unreachable when it does not reach one of these.
std::vector<SelfTestCase> single_rod_self_test(const Robot& robot, const Machine& machine);

}  // namespace paracal::compensation_detail

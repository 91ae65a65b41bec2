#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "paracal/compensation/self_test.hpp"
#include "paracal/mechanism/machine.hpp"
#include "procedure.hpp"

// Machines on struts as exports need them.

namespace paracal::compensation_detail {

inline constexpr std::size_t kStruts = 6;

/// One strut, errors included: |r + R plate - base| = length + growth q.
struct StrutConstants {
  std::array<double, 3> base, plate;
  double length = 0.0, growth = 1.0;
};
std::array<StrutConstants, kStruts> strut_constants(const Machine& machine);

/// Formulas of any machine on struts with these constants. Their symbols:
///
///   pose[6]    O' in {O}, mm; tilt, rad
///   joints[6]  to command, mm
///   rows[36]   d joints / d pose, a row a strut
struct RecordedStruts {
  Procedure joints;  ///< pose -> joints
  Procedure rows;    ///< pose -> joints, rows
};
RecordedStruts record(const std::array<StrutConstants, kStruts>& struts);

/// The centre of the workspace, and its rims in all tilts, with the joints of a machine.
/// @throws Unreachable when it does not reach one of these.
std::vector<SelfTestCase> strut_self_test(const Robot& robot, const Machine& machine);

}  // namespace paracal::compensation_detail

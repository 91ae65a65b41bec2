#pragma once

#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::test {

/// As many machines as a statistical test wants where PARACAL_EVERY_MACHINE is set (tools/check_all.sh). Else of 100
/// and more a quarter, 50 at least; under sanitizers, where each costs twenty times as much, a tenth.
int machines(int wanted);

/// A machine out of the robot's tolerances, and what an instrument in a frame of its own reads of it.
struct MeasuredMachine {
  SourceErrors errors;
  Measurements measurements;
};
/// @param number  the same number is the same machine with the same noise.
MeasuredMachine measured_machine(const Robot& robot, const std::vector<Station>& stations, int number,
                                 VirtualInstrument instrument);
/// The same for given errors.
Measurements measure(const Robot& robot, const SourceErrors& errors, const std::vector<Station>& stations, int number,
                     VirtualInstrument instrument);

/// Poses of a body somewhere on the plate of a machine out of the robot's tolerances, with their sigmas: 0.02 mm and
/// 0.01 deg.
Measurements body_poses(const Robot& robot, const std::vector<Station>& stations, int number);

/// States the sigma of every point.
void state_sigma(Measurements& measurements, double sigma);

/// The same machine, to first order, by errors that its actuators feel: of a rail e_z joins theta_offset.
SourceErrors as_felt(const Robot& robot, SourceErrors errors);

/// [huang2016, Table 4] as position errors, tilt errors drawn from the robot's tolerances.
SourceErrors table4_machine(const Robot& robot, int number);

/// Poses of the true machine against those that the calibrated one predicts, at stations that were not measured.
PoseErrorSummary held_out_errors(const Robot& robot, const SourceErrors& truth, const SourceErrors& found,
                                 const std::vector<Station>& stations);

/// Quantile of a sample.
double quantile(std::vector<double> values, double share);

}  // namespace paracal::test

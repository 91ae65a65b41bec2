#pragma once

#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::test {

/// Whether tests make all machines that their claims need, which takes hours (PARACAL_EVERY_MACHINE;
/// tools/check_all.sh).
bool every_machine();

/// How many machines a statistical test makes. Each such test says why so many.
struct Machines {
  int claim;  ///< as many as its claim needs: made where every_machine()
  int quick;  ///< the fewest that still fail where what it guards is broken: made elsewhere
};
int machines(const Machines& wanted);
/// By how much more a mean, or a share, scatters over the machines that are made than over as many as the claim needs.
double looser(const Machines& wanted);

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

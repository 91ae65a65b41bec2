#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/prediction.hpp"
#include "paracal/compensation/stated_uncertainty.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// True for limbs with one rod each, and for three or four limbs, as many as degrees of freedom. The joints of others
/// are only found by least squares.
bool has_compensator(const Robot& robot);

/// Parameters of the compensator for a machine with these (identified) errors, mm and rad, rounded to Scalar last.
/// @param drives  whose smooth errors the joints make up for, where they are uneven.
/// @throws InvalidArgument unless has_compensator().
/// Instantiated for double and float. Real-time: no; compute them before the control thread needs them.
template <typename Scalar = double>
CompensatorParameters<Scalar> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                     const DriveCurves& drives = {});

extern template CompensatorParameters<double> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                                     const DriveCurves& drives);
extern template CompensatorParameters<float> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                                    const DriveCurves& drives);

/// Covariance of identified errors for the compensator.
/// @throws InvalidArgument where errors of each turn are among them: it has no place for these, and U would be too
/// small. PlateUncertainty (prediction.hpp) has.
/// @param parameters  of the rows: any type with `limb` (from 0) and `source`, as in a Calibration.
/// @param covariance  of these, mm and rad.
template <typename Parameter>
CompensatorCovariance<double> compensator_covariance(const Robot& robot, const std::vector<Parameter>& parameters,
                                                     const Eigen::MatrixXd& covariance) {
  CompensatorCovariance<double> scaled{};
  const auto at = [&](const Parameter& one) {
    return kCompensatorErrors * one.limb + place_in(robot.nominal().limbs[one.limb].actuator, one.source);
  };
  for (const Parameter& one : parameters) {
    if (!is_harmonic(one.source)) continue;
    throw InvalidArgument(std::string(name(one.source)) +
                          ": expected a calibration without errors of each turn, for which this covariance has no "
                          "place. Use PlateUncertainty");
  }
  for (std::size_t r = 0; r < parameters.size(); ++r) {
    for (std::size_t c = 0; c < parameters.size(); ++c) {
      scaled[at(parameters[r])][at(parameters[c])] =
          paper_scale(robot, parameters[r].source) * paper_scale(robot, parameters[c].source) *
          covariance(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
    }
  }
  return scaled;
}

/// Compensated joints for the library.
Joints compensated_joints(const Robot& robot, const CompensatorJoints<double>& joints);

/// The pose to command to a closed controller, which computes with the nominal robot: its nominal inverse gives these
/// joints. It is the nominal forward kinematics of the corrected joints.
/// @param wanted  the pose that these joints reach: a good start for the solver.
/// @returns nothing if the nominal robot does not close with these joints.
std::optional<Pose> corrected_target(const Robot& robot, const Joints& joints, const Pose& wanted);

}  // namespace paracal

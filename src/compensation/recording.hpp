#pragma once

#include <cstddef>

#include "procedure.hpp"

namespace paracal::compensation_detail {

/// The exact way of compensator.hpp for one machine, and the step of its way back, as formulas. Their symbols:
///
///   pose[4]      O' in {O}, mm; phi, rad
///   joints[N]    to command, rad or mm
///   state[...]   while the tilt is sought: tilt (3), by how much each joint has moved (N), where arms or carriages
///   stand answer[...]  how arms and plate answer a pull changes[N+3] by how much each arm turns (carriage turns its
///   rods) and the plate tilts in a step, rad motion[N]    of the plate: position, mm, and of four limbs phi, rad
///   angle, value of the two turns
struct RecordedMachine {
  Procedure level;        ///< pose -> joints and, where the plate tilts, state
  Procedure answer;       ///< pose, state -> answer
  Procedure step;         ///< pose, answer, state -> state, changes
  Procedure way_back;     ///< pose, its joints, change of these (`changes`) -> motion: Newton's step for the pose
  Procedure turn_cosine;  ///< angle -> value, by series
  Procedure turn_sine;
  std::size_t state_size, answer_size;
};

RecordedMachine record(const CompensatorParameters<double>& parameters);

}  // namespace paracal::compensation_detail

#pragma once

#include <cstddef>
#include <vector>

#include "paracal/mechanism/machine.hpp"
#include "procedure.hpp"

namespace paracal::compensation_detail {

/// The closure of one machine (machine_closure.hpp) as formulas, without its zeros. Their symbols:
///
///   pose[6]      O' in {O}, mm; tilt_x, tilt_y, tilt_z or, of a slide, phi, rad; what cannot be commanded is not read
///   joints[N]    to command, rad or mm
///   rates[N F]   d joints / d pose, a row a limb, a column each that can be commanded
///
/// and while the angles are sought that limbs of two rods hold:
///
///   state[...]   the angles (3), by how much each joint has moved (N), where arms or carriages stand
///   answer[...]  how arms and plate answer a pull
///   changes[N+3] by how much each arm turns (a length turns its rods) and the plate tilts in a step, rad
///   angle, value of the two turns
struct RecordedMachine {
  Procedure closed;                  ///< pose -> joints and, where the plate tilts, state
  Procedure rates;                   ///< pose -> rates, of the closed form
  Procedure answer;                  ///< pose, state -> answer
  Procedure step;                    ///< pose, answer, state -> state, changes
  Procedure turn_cosine, turn_sine;  ///< angle -> value, by series
  std::size_t state_size = 0, answer_size = 0;
  std::vector<Symbol> numbers = {};  ///< constants of limbs that they use, limb after limb
};

RecordedMachine record(const Machine& machine);

/// Where a constant of a limb stands among the numbers of an export.
std::size_t place_of_number(const std::vector<Symbol>& numbers, const Symbol& symbol);

}  // namespace paracal::compensation_detail

#pragma once

// Private to calibration: one way in which an input may be wrong, and the input without it.

#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <string>

#include "trial_fit.hpp"

namespace paracal::detail {

enum class MistakeKind : std::uint8_t {
  usual,    ///< has nothing to adjust
  robot,    ///< another robot of the catalogue
  nominal,  ///< one number of the robot file, which the readings themselves have told
  part,     ///< one part out of its tolerance: no mistake of the input, but the rival of all that are
};

/// One way in which an input may be wrong.
struct Mistake {
  MistakeKind kind = MistakeKind::usual;
  std::string family;  ///< of several alike that explain the readings equally well one is named
  std::string text;    ///< "the readings are in metres"
  std::function<void(Input&)> undo;
};

/// A usual one, of readings or commands.
Mistake mistake_of_measurements(std::string family, std::string text, std::function<void(Measurements&)> undo);

/// What a number in rad lost when it was read as deg.
inline constexpr double kRadInDegrees = 180.0 / std::numbers::pi;

/// The station's joints as the controller of `robot` believed them, said of every station: what is commanded no longer
/// matters then, nor the robot that it was commanded to.
void state_joints(const Robot& robot, Measurements& measurements);

/// The input as it would have been; empty where there is none (a pose out of the other robot's reach).
std::optional<Input> undone(const Input& given, const Mistake& mistake);
/// What fits it.
std::optional<TrialFit> fit_without(const Input& given, const Mistake& mistake);

}  // namespace paracal::detail

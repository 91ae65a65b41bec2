#include "mistake.hpp"

#include <utility>

#include "paracal/error.hpp"

namespace paracal::detail {

Mistake mistake_of_measurements(std::string family, std::string text, std::function<void(Measurements&)> undo) {
  return {MistakeKind::usual, std::move(family), std::move(text),
          [undo = std::move(undo)](Input& input) { undo(input.measurements); }};
}

void state_joints(const Robot& robot, Measurements& measurements) {
  for (Station& station : measurements.stations) station.believed = believed_joints(robot, station);
}

std::optional<Input> undone(const Input& given, const Mistake& mistake) {
  Input input = given;
  try {
    mistake.undo(input);
  } catch (const Error&) {
    return std::nullopt;
  }
  return input;
}

std::optional<TrialFit> fit_without(const Input& given, const Mistake& mistake) {
  const auto input = undone(given, mistake);
  return input ? fit_robustly(*input) : std::nullopt;
}

}  // namespace paracal::detail

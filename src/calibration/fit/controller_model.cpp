#include "paracal/calibration/controller_model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

namespace paracal {
namespace {

constexpr std::array<std::pair<ControllerEvidence, std::string_view>, 4> kEvidence{
    {{ControllerEvidence::assumed, "assumed"},
     {ControllerEvidence::readings, "readings"},
     {ControllerEvidence::confirmed, "confirmed"},
     {ControllerEvidence::stated, "stated"}}};

bool limbs_differ(const SharedDimensions& shared) {
  for (std::size_t limb = 0; limb < shared.limb_azimuth.size(); ++limb) {
    const auto is_set = [&](Source source) { return shared.differences(limb, source) != 0.0; };
    if (std::ranges::any_of(all_sources(), is_set)) return true;
  }
  return false;
}

}  // namespace

std::string_view name(ControllerEvidence evidence) {
  return std::ranges::find(kEvidence, evidence, &decltype(kEvidence)::value_type::first)->second;
}

std::optional<ControllerEvidence> controller_evidence(std::string_view name) {
  const auto found = std::ranges::find(kEvidence, name, &decltype(kEvidence)::value_type::second);
  return found == kEvidence.end() ? std::nullopt : std::optional(found->first);
}

std::string dimensions_in_words(const Robot& robot) {
  const std::optional<SharedDimensions> shared = shared_dimensions(robot.limbs());
  if (!shared) return "the joint positions and lengths of the robot file";
  std::vector<std::string> words{fmt::format("rod {:g} mm", shared->rod)};
  if (shared->arm > 0.0) words.push_back(fmt::format("arm {:g} mm", shared->arm));
  words.push_back(fmt::format("base radius {:g} mm", shared->base_radius));
  words.push_back(fmt::format("plate radius {:g} mm", shared->plate_radius));
  if (robot.slide()) words.push_back(fmt::format("pinion radius {:g} mm", robot.slide()->pinion_radius));
  if (limbs_differ(*shared)) words.emplace_back("individual limb dimensions as in the robot file");
  return fmt::format("{}", fmt::join(words, ", "));
}

std::vector<std::string> controller_assumptions(const ControllerModel& controller, const Robot& drawing) {
  const std::string computes =
      fmt::format("the controller computes joints with {}", dimensions_in_words(controller.computes_with(drawing)));
  switch (controller.evidence) {
    case ControllerEvidence::assumed:
      return {computes + "; " + (controller.source.empty() ? "check with --controller-joints" : controller.source)};
    case ControllerEvidence::confirmed:
      return {fmt::format("confirmed by {}: {}", controller.source, computes)};
    case ControllerEvidence::stated:
      if (controller.robot) return {fmt::format("stated by {}: {}", controller.source, computes)};
      [[fallthrough]];
    default:
      return {};
  }
}

ControllerModel with_readings(ControllerModel controller, const Measurements& measurements) {
  const bool states_all =
      std::ranges::all_of(measurements.stations, [](const Station& station) { return station.believed.has_value(); });
  if (controller.evidence == ControllerEvidence::assumed && states_all) {
    controller.evidence = ControllerEvidence::readings;
  }
  return controller;
}

Measurements commanded_by(const Robot& controller, Measurements measurements) {
  for (Station& station : measurements.stations) station.believed = believed_joints(controller, station);
  return measurements;
}

}  // namespace paracal

#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace paracal {

/// What a length is that a pose shows by itself, on an instrument whose set-up is found with the rest.
enum class LengthKind : std::uint8_t {
  height,  ///< of the plate centre above a plane, along the robot's z: a probe, a nozzle on a sheet of paper
};

/// What a kind is called in tables, options, JSON and messages.
struct LengthWords {
  LengthKind kind = LengthKind::height;
  std::string_view name;      ///< "height": of options
  std::string_view noun;      ///< "height"
  std::string_view plural;    ///< "heights"
  std::string_view column;    ///< of its table, which is known by it: "height_mm"
  std::string_view list;      ///< of such readings, in JSON: "heights"
  std::string_view set_ups;   ///< what was found of its set-ups, in JSON: "planes"
  std::string_view reversed;  ///< said where the opposite sign explains the readings; empty: there is none
};

/// Every kind once.
const std::vector<LengthWords>& length_kinds();

const LengthWords& words(LengthKind kind);

}  // namespace paracal

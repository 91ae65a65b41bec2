#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "paracal/calibration/noise.hpp"

namespace paracal {

/// What a length is that a pose shows by itself, on an instrument whose setup is found with the rest.
enum class LengthKind : std::uint8_t {
  height,    ///< of the plate centre above a plane, along the robot's z: a probe, a nozzle on a sheet of paper
  ball_bar,  ///< from the plate centre to a fixed point: a ball bar, a draw wire
  dial,      ///< displacement of the plate centre along a known direction, from wherever the dial was zeroed
};

/// What a kind is called in tables, options, JSON and messages.
struct LengthWords {
  LengthKind kind = LengthKind::height;
  std::string_view name;      ///< "height": of options
  std::string_view noun;      ///< "height"
  std::string_view plural;    ///< "heights"
  std::string_view column;    ///< of its table, which is known by it: "height_mm"
  std::string_view list;      ///< of such readings, in JSON: "heights"
  std::string_view set_ups;   ///< what was found of its setups, in JSON: "planes"
  std::string_view reversed;  ///< said where the opposite sign explains the readings; empty: there is none
  /// What is known of the setup (LengthSeries::at); its columns are empty where only a plan wants to know it.
  std::array<std::string_view, 3> at_columns = {};
  std::string_view at = {};
  bool needs_at = false;                            ///< and has to be said
  bool positive = false;                            ///< no such length is zero or less
  std::size_t unknowns = 3;                         ///< of a setup, which nothing but its own readings tell
  double NoiseModel::*sigma = &NoiseModel::height;  ///< of readings that state none
};

/// Every kind once.
const std::vector<LengthWords>& length_kinds();

const LengthWords& words(LengthKind kind);

}  // namespace paracal

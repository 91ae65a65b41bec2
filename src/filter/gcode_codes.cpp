#include "gcode_codes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace paracal::io {
namespace {

constexpr std::array kCodes{
    Code{0, Effect::rapid},
    Code{10, Effect::straight},
    Code{20, Effect::clockwise},
    Code{30, Effect::anticlockwise},
    Code{40, Effect::dwell},
    Code{50, Effect::spline},
    Code{51, Effect::spline},
    Code{52, Effect::spline},
    Code{53, Effect::spline},
    Code{70, Effect::transform, kDiameter},
    Code{80, Effect::no_transform, kDiameter},
    Code{90, Effect::none},
    Code{100, Effect::shift_if_stated},
    Code{110, Effect::none},
    Code{150, Effect::no_transform, kPolar},
    Code{160, Effect::transform, kPolar},
    Code{170, Effect::plane, 0, 2},
    Code{171, Effect::plane},
    Code{180, Effect::plane, 0, 1},
    Code{181, Effect::plane},
    Code{190, Effect::plane, 0, 0},
    Code{191, Effect::plane},
    Code{200, Effect::inch},
    Code{210, Effect::mm},
    Code{270, Effect::home},
    Code{280, Effect::home},
    Code{281, Effect::none},
    Code{290, Effect::home},
    Code{300, Effect::home},
    Code{301, Effect::none},
    Code{330, Effect::thread},
    Code{331, Effect::thread},
    Code{382, Effect::probe},
    Code{383, Effect::probe},
    Code{384, Effect::probe},
    Code{385, Effect::probe},
    Code{400, Effect::no_transform, kRadius},
    Code{410, Effect::transform, kRadius},
    Code{411, Effect::transform, kRadius},
    Code{420, Effect::transform, kRadius},
    Code{421, Effect::transform, kRadius},
    Code{430, Effect::tool_length},
    Code{431, Effect::tool_length_by_axes},
    Code{432, Effect::tool_length_by_axes},
    Code{440, Effect::tool_length},
    Code{490, Effect::no_tool_length},
    Code{500, Effect::no_transform, kScale},
    Code{501, Effect::no_transform, kMirror},
    Code{510, Effect::transform_by_axes, kScale},
    Code{511, Effect::transform_by_axes, kMirror},
    Code{520, Effect::shift_by_axes},
    Code{530, Effect::in_machine},
    Code{540, Effect::system},
    Code{550, Effect::system},
    Code{560, Effect::system},
    Code{570, Effect::system},
    Code{580, Effect::system},
    Code{590, Effect::system},
    Code{591, Effect::system},
    Code{592, Effect::system},
    Code{593, Effect::system},
    Code{600, Effect::save_place},
    Code{610, Effect::path_mode},
    Code{611, Effect::path_mode},
    Code{640, Effect::path_mode},
    Code{650, Effect::flow},
    Code{680, Effect::transform_by_axes, kTurn},
    Code{690, Effect::no_transform, kTurn},
    Code{730, Effect::cycle},
    Code{760, Effect::cycle},
    Code{800, Effect::no_motion},
    Code{810, Effect::cycle},
    Code{820, Effect::cycle},
    Code{830, Effect::cycle},
    Code{840, Effect::cycle},
    Code{850, Effect::cycle},
    Code{860, Effect::cycle},
    Code{870, Effect::cycle},
    Code{880, Effect::cycle},
    Code{890, Effect::cycle},
    Code{900, Effect::absolute},
    Code{901, Effect::centre_is_place},
    Code{910, Effect::incremental},
    Code{911, Effect::centre_from_start},
    Code{920, Effect::shift_axes},
    Code{921, Effect::shift},
    Code{922, Effect::shift},
    Code{923, Effect::shift},
    Code{930, Effect::inverse_time},
    Code{940, Effect::feed_per_time},
    Code{950, Effect::feed_per_time},
    Code{960, Effect::none},
    Code{970, Effect::none},
    Code{980, Effect::return_to_start},
    Code{990, Effect::return_to_clearance},
};
static_assert(std::ranges::is_sorted(kCodes, {}, &Code::tenths));

}  // namespace

int tenths_of(double code) {
  const double tenths = std::round(10.0 * code);
  return std::abs(10.0 * code - tenths) < 1e-6 && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
}

int stage_of(Effect effect) {
  switch (effect) {
    case Effect::inverse_time:
    case Effect::feed_per_time:
      return 0;
    case Effect::dwell:
      return 2;
    case Effect::plane:
      return 3;
    case Effect::inch:
    case Effect::mm:
      return 4;
    case Effect::transform:
    case Effect::transform_by_axes:
    case Effect::no_transform:
      return 5;
    case Effect::tool_length:
    case Effect::tool_length_by_axes:
    case Effect::no_tool_length:
      return 6;
    case Effect::system:
      return 7;
    case Effect::path_mode:
      return 8;
    case Effect::absolute:
    case Effect::incremental:
    case Effect::centre_is_place:
    case Effect::centre_from_start:
      return 9;
    case Effect::return_to_start:
    case Effect::return_to_clearance:
      return 10;
    case Effect::home:
    case Effect::shift:
    case Effect::shift_by_axes:
    case Effect::shift_if_stated:
    case Effect::shift_axes:
      return 11;
    default:
      return 12;  // motions, and what none of this asks for
  }
}

const Code* find_code(int tenths) {
  const auto* const found = std::ranges::lower_bound(kCodes, tenths, {}, &Code::tenths);
  return found != kCodes.end() && found->tenths == tenths ? found : nullptr;
}

MEffect effect_of_m(int tenths) {
  switch (tenths) {
    case 0:
    case 10:
    case 600:
      return MEffect::pause;
    case 20:
    case 300:
      return MEffect::end;
    case 820:
      return MEffect::absolute_extrusion;
    case 830:
      return MEffect::relative_extrusion;
    case 700:  // modes are kept
    case 710:
    case 720:  // and restored
      return MEffect::end_of_modes;
    case 730:
      return MEffect::end_of_modes_if_bare;
    case 60:
      return MEffect::tool_change;
    case 980:
    case 990:
      return MEffect::flow;
    case 180:  // RepRap
    case 840:
      return MEffect::motors_off;
    case 170:   // motors on
    case 920:   // RepRap: steps per mm
    case 2010:  // accelerations
    case 2020:
    case 2030:  // feed rates
    case 2040:
    case 2050:  // jerk
    case 2080:  // limits
    case 3500:  // micro-steps
    case 4250:  // backlash
    case 5660:
    case 5930:  // input shaping
    case 9060:  // currents
    case 9070:
    case 9130:
      return MEffect::setting;
    case 2060:  // RepRap: home offsets
    case 2180:  // of tools
    case 4280:
      return MEffect::shift;
    default:
      return MEffect::none;
  }
}

bool takes_axis_words(int tenths) {
  constexpr std::array kOfRs274{300, 480, 490, 500, 510, 520, 530, 600, 620, 630, 640, 650, 660, 670, 680};
  return tenths >= 100 && std::ranges::find(kOfRs274, tenths) == kOfRs274.end();
}

}  // namespace paracal::io

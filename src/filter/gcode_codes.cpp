#include "gcode_codes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace paracal::io {
namespace {

constexpr std::string_view kSpline = "a spline", kDiameter = "diameter mode (G7)", kPolar = "polar coordinates (G16)",
                           kRadius = "cutter radius compensation (G41, G42)",
                           kAddedLength = "an additional tool length (G43.2)",
                           kNegativeLength = "a negative tool length (G44)", kScaled = "a scaled path (G51)",
                           kMirrored = "a mirrored path (G51.1)", kSubprogram = "a subprogram (G65)",
                           kTurned = "a rotated path (G68)";

constexpr std::array kCodes{
    Code{0, Effect::rapid},
    Code{10, Effect::straight},
    Code{20, Effect::clockwise},
    Code{30, Effect::anticlockwise},
    Code{40, Effect::dwell},
    Code{50, Effect::refused, {}, kSpline},
    Code{51, Effect::refused, {}, kSpline},
    Code{52, Effect::refused, {}, kSpline},
    Code{53, Effect::refused, {}, kSpline},
    Code{70, Effect::refused, {}, kDiameter},
    Code{80, Effect::none},
    Code{90, Effect::none},
    Code{100, Effect::define},
    Code{110, Effect::none},
    Code{150, Effect::none},
    Code{160, Effect::refused, {}, kPolar},
    Code{170, Effect::plane, 2},
    Code{171, Effect::plane},
    Code{180, Effect::plane, 1},
    Code{181, Effect::plane},
    Code{190, Effect::plane, 0},
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
    Code{400, Effect::none},
    Code{410, Effect::refused, {}, kRadius},
    Code{411, Effect::refused, {}, kRadius},
    Code{420, Effect::refused, {}, kRadius},
    Code{421, Effect::refused, {}, kRadius},
    Code{430, Effect::tool_length},
    Code{431, Effect::tool_length_by_axes},
    Code{432, Effect::refused, {}, kAddedLength},
    Code{440, Effect::refused, {}, kNegativeLength},
    Code{490, Effect::no_tool_length},
    Code{500, Effect::none},
    Code{501, Effect::none},
    Code{510, Effect::refused, {}, kScaled},
    Code{511, Effect::refused, {}, kMirrored},
    Code{520, Effect::local_shift},
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
    Code{600, Effect::saved_place},
    Code{610, Effect::saved_place},
    Code{611, Effect::none},
    Code{640, Effect::none},
    Code{650, Effect::refused, {}, kSubprogram},
    Code{680, Effect::refused, {}, kTurned},
    Code{690, Effect::none},
    Code{700, Effect::inch_if_bare},
    Code{710, Effect::mm_if_bare},
    Code{720, Effect::cycle},
    Code{730, Effect::cycle},
    Code{740, Effect::cycle},
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
    Code{921, Effect::no_shift},
    Code{922, Effect::no_shift},
    Code{923, Effect::restored_shift},
    Code{930, Effect::inverse_time},
    Code{940, Effect::feed_per_time},
    Code{950, Effect::feed_per_turn},
    Code{960, Effect::none},
    Code{970, Effect::none},
    Code{980, Effect::none},
    Code{990, Effect::none},
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
    case Effect::feed_per_turn:
      return 0;
    case Effect::dwell:
      return 2;
    case Effect::plane:
      return 3;
    case Effect::inch:
    case Effect::mm:
    case Effect::inch_if_bare:
    case Effect::mm_if_bare:
      return 4;
    case Effect::tool_length:
    case Effect::tool_length_by_axes:
    case Effect::no_tool_length:
      return 6;
    case Effect::system:
      return 7;
    case Effect::absolute:
    case Effect::incremental:
    case Effect::centre_is_place:
    case Effect::centre_from_start:
      return 9;
    case Effect::home:
    case Effect::define:
    case Effect::shift_axes:
    case Effect::no_shift:
    case Effect::restored_shift:
    case Effect::local_shift:
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
  constexpr int kFirstMacro = 8100, kLastMacro = 8190;  // Marlin's
  if (tenths >= kFirstMacro && tenths <= kLastMacro) return MEffect::subprogram;
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
    case 320:  // another file of a printer's
    case 970:
    case 980:
    case 990:
      return MEffect::subprogram;
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

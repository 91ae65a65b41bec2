#include "gcode_codes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace paracal::io {
namespace {

/// Codes of one effect, 10 times each, and when a line carries them out.
struct Group {
  int stage;
  Effect effect;
  std::vector<int> tenths;
  std::string_view refusal = {};
};

std::map<int, Code> all_codes() {
  constexpr int kLast = 12;  // motions, and what none of the stages before asks for
  const std::vector<Group> groups{
      {0, Effect::inverse_time, {930}},
      {0, Effect::feed_per_time, {940}},
      {0, Effect::feed_per_turn, {950}},
      {2, Effect::dwell, {40}},
      {3, Effect::plane, {170, 171, 180, 181, 190, 191}},
      {4, Effect::inch, {200}},
      {4, Effect::mm, {210}},
      {4, Effect::inch_if_bare, {700}},
      {4, Effect::mm_if_bare, {710}},
      {6, Effect::tool_length, {430}},
      {6, Effect::tool_length_by_axes, {431}},
      {6, Effect::no_tool_length, {490}},
      {7, Effect::system, {540, 550, 560, 570, 580, 590, 591, 592, 593}},
      {9, Effect::absolute, {900}},
      {9, Effect::centre_is_place, {901}},
      {9, Effect::incremental, {910}},
      {9, Effect::centre_from_start, {911}},
      {11, Effect::define, {100}},
      {11, Effect::home, {270, 280, 290, 300}},
      {11, Effect::local_shift, {520}},
      {11, Effect::shift_axes, {920}},
      {11, Effect::no_shift, {921, 922}},
      {11, Effect::restored_shift, {923}},
      {kLast, Effect::rapid, {0}},
      {kLast, Effect::straight, {10}},
      {kLast, Effect::clockwise, {20}},
      {kLast, Effect::anticlockwise, {30}},
      {kLast, Effect::none, {80, 90, 110, 150, 400, 611, 640, 690, 960, 970, 980, 990}},
      {kLast, Effect::alone, {500, 501}},
      {kLast, Effect::reference, {281, 301}},
      {kLast, Effect::thread, {330, 331}},
      {kLast, Effect::probe, {382, 383, 384, 385}},
      {kLast, Effect::in_machine, {530}},
      {kLast, Effect::saved_place, {600, 610}},
      {kLast, Effect::cycle, {720, 730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890}},
      {kLast, Effect::no_motion, {800}},
      {kLast, Effect::refused, {50, 51, 52, 53}, "a spline"},
      {kLast, Effect::refused, {70}, "diameter mode (G7)"},
      {kLast, Effect::refused, {160}, "polar coordinates (G16)"},
      {kLast, Effect::refused, {410, 411, 420, 421}, "cutter radius compensation (G41, G42)"},
      {kLast, Effect::refused, {432}, "an additional tool length (G43.2)"},
      {kLast, Effect::refused, {440}, "a negative tool length (G44)"},
      {kLast, Effect::refused, {510}, "a scaled path (G51)"},
      {kLast, Effect::refused, {511}, "a mirrored path (G51.1)"},
      {kLast, Effect::refused, {650}, "a subprogram (G65)"},
      {kLast, Effect::refused, {680}, "a rotated path (G68)"},
  };
  std::map<int, Code> codes;
  for (const auto& [stage, effect, all, refusal] : groups) {
    for (const int tenths : all) codes[tenths] = {.effect = effect, .stage = stage, .refusal = refusal};
  }
  codes[170].normal = 2;
  codes[180].normal = 1;
  codes[190].normal = 0;
  return codes;
}

}  // namespace

int tenths_of(double code) {
  const double tenths = std::round(10.0 * code);
  return std::abs(10.0 * code - tenths) < 1e-6 && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
}

const Code* find_code(int tenths) {
  static const std::map<int, Code> kCodes = all_codes();
  const auto found = kCodes.find(tenths);
  return found != kCodes.end() ? &found->second : nullptr;
}

MEffect effect_of_m(int tenths) {
  static const std::vector<std::pair<MEffect, std::vector<int>>> kEffects{
      {MEffect::pause, {0, 10, 600}},
      {MEffect::end, {20, 300}},
      {MEffect::absolute_extrusion, {820}},
      {MEffect::relative_extrusion, {830}},
      {MEffect::end_of_modes, {700, 710, 720}},  // modes are kept, and restored
      {MEffect::end_of_modes_if_bare, {730}},
      {MEffect::tool_change, {60}},
      {MEffect::subprogram, {320, 970, 980, 990}},  // 32: another file of a printer's
      {MEffect::motors_off, {180, 840}},            // RepRap
      // Motors on; RepRap: steps per mm, accelerations, feed rates, jerk, limits, micro-steps, backlash, input shaping,
      // currents.
      {MEffect::setting, {170, 920, 2010, 2020, 2030, 2040, 2050, 2080, 3500, 4250, 5660, 5930, 9060, 9070, 9130}},
      {MEffect::shift, {2060, 2180, 4280}},  // RepRap: home offsets, of tools
  };
  constexpr int kFirstMacro = 8100, kLastMacro = 8190;  // Marlin's
  if (tenths >= kFirstMacro && tenths <= kLastMacro) return MEffect::subprogram;
  const auto has = [&](const auto& one) { return std::ranges::find(one.second, tenths) != one.second.end(); };
  const auto found = std::ranges::find_if(kEffects, has);
  return found != kEffects.end() ? found->first : MEffect::none;
}

bool takes_axis_words(int tenths) {
  constexpr std::array kOfRs274{300, 480, 490, 500, 510, 520, 530, 600, 620, 630, 640, 650, 660, 670, 680};
  return tenths >= 100 && std::ranges::find(kOfRs274, tenths) == kOfRs274.end();
}

}  // namespace paracal::io

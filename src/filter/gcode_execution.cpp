// The codes of a block in the order in which they are carried out.

#include <algorithm>
#include <cmath>

#include "gcode_codes.hpp"
#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kSubprogram = "a subprogram (M32, M97 to M99, M810 to M819)";

int stage_of(const GcodeWord& word) {
  if (word.letter == 'M') return kStageOfM;
  const Code* const code = word.is_number() ? find_code(tenths_of(word.value)) : nullptr;
  return code != nullptr ? code->stage : 0;
}

}  // namespace

void GcodeModes::apply_m(int tenths, const GcodeBlock& block, Request& request) {
  request.has_m_code |= takes_axis_words(tenths);
  switch (effect_of_m(tenths)) {
    case MEffect::none:
      return;
    case MEffect::pause:
      request.acts_after = true;
      return;
    case MEffect::end:
      request.acts_after = request.then_unknown = true;
      return;
    case MEffect::absolute_extrusion:
      return extruder_.set_relative(false);
    case MEffect::relative_extrusion:
      return extruder_.set_relative(true);
    case MEffect::end_of_modes:
      return forget();
    case MEffect::end_of_modes_if_bare:
      if (!block.has_letter("PRCD")) forget();
      return;
    case MEffect::tool_change:
      tool_ = prepared_tool_;
      request.then_lost = true;
      return lose_all();
    case MEffect::motors_off:
      request.then_lost = true;
      request.is_setting = true;
      return;
    case MEffect::subprogram:
      if (!traits_.is_printer) throw RefusedProgram(kSubprogram, kExpand);
      request.is_macro = true;
      return;
    case MEffect::setting:
      request.is_setting = true;
      return;
    case MEffect::shift:
      return move_origin({});
  }
}

/// RS-274 knows no order of words in a line; firmwares that take several codes take them as they come.
void GcodeModes::put_in_order(const GcodeBlock& block) {
  codes_.clear();
  for (const GcodeWord& word : block.words) {
    if (word.letter == 'G' || word.letter == 'M') codes_.push_back(&word);
  }
  if (traits_.runs_as_written || codes_.size() < 2) return;
  std::ranges::stable_sort(codes_, {}, [](const GcodeWord* word) { return stage_of(*word); });
}

/// T: firmwares change the tool at once.
void GcodeModes::choose_tool(const GcodeBlock& block, Request& request) {
  const GcodeWord* const tool = block.word('T');
  if (tool == nullptr || !names_tool(block, traits_)) return;
  prepared_tool_ = tool->is_number() ? std::optional(static_cast<int>(std::lround(tool->value))) : std::nullopt;
  if (traits_.prepares_tools) return;
  tool_ = prepared_tool_;
  request.then_lost = true;
  lose_all();
}

GcodeModes::Request GcodeModes::apply_codes(const GcodeBlock& block, const Axes& axes) {
  Request request{.is_malformed = axes.has_duplicate};
  choose_tool(block, request);
  put_in_order(block);
  for (const GcodeWord* word : codes_) {
    if (!word->is_number()) {
      request.is_malformed = true;
      continue;
    }
    const int tenths = tenths_of(word->value);
    const auto stated_before = request.motion;
    word->letter == 'G' ? apply_g(tenths, block, axes, request) : apply_m(tenths, block, request);
    if (request.motion && !stated_before) request.motion_word = {word->at, word->end};
  }
  if (!request.is_macro) refuse_missing_numbers(block, axes, request);
  return request;
}

}  // namespace paracal::io

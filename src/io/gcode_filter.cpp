#include "gcode_block.hpp"
#include "gcode_modes.hpp"
#include "paracal/units.hpp"
#include "target_line.hpp"

namespace paracal::io {
namespace {

class Gcode : public TargetFormat {
 public:
  Gcode(std::size_t axis_count, const std::optional<AxisValues>& start) : modes_(axis_count, start) {}

  bool read(std::string_view text, TargetLine& target, std::string_view& passed) override {
    block_.parse(text);
    passed = modes_.take(block_, target);
    if (!target.may_insert) return false;
    style_insertions(text, target);
    return true;
  }
  void skip() override { modes_.forget(); }

 private:
  /// Words are added as the last axis word is written: behind it, in its case, after a blank if it stands after one.
  void style_insertions(std::string_view text, TargetLine& target) const {
    for (const GcodeWord& word : block_.words) {
      if (word.end != target.insert_at) continue;
      target.in_lower_case = text[word.at] != word.letter;
      target.with_blank = word.at > 0 && (text[word.at - 1] == ' ' || text[word.at - 1] == '\t');
    }
    target.checksum_at = block_.checksum_at;
  }

  GcodeBlock block_;
  GcodeModes modes_;
};

std::optional<AxisValues> axis_values(const std::optional<Pose>& pose) {
  if (!pose) return std::nullopt;
  const Eigen::Vector3d& r = pose->position;
  return AxisValues{r.x(), r.y(), r.z(), to_degrees(pose->rotation)};
}

}  // namespace

FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeFrame& frame, unsigned threads) {
  Gcode gcode(correction.robot().limb_count(), axis_values(frame.start));  // as many axes as limbs
  return filter(in, out, gcode, correction, frame.origin, threads);
}

}  // namespace paracal::io

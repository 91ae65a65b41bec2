#include "gcode_loss.hpp"

#include <fmt/format.h>

#include <array>
#include <string>

#include "gcode_block.hpp"

namespace paracal::io {
namespace {

/// Behind the letter of the axis, in the order of Loss.
constexpr std::array<std::string_view, 8> kCauses{
    "is not stated yet (if the program never states it, give --start=X,Y,Z)",
    "is unknown after a tool change (T, M6)",
    "is unknown after motors were switched off (M18, M84) or moved alone (H)",
    "is unknown after homing, probing or a stored position (G28 to G30, G33, G38, G61)",
    "is unknown after a change of origin (G10, G52, G54 to G59.3, G92, M206)",
    "is unknown after a change of tool length (G43, G49; give lengths with --tools)",
    "is unknown after a line with unknown effect (a macro, M2, /, an unknown line)",
    "is unknown after a line that could not be corrected",
};

}  // namespace

std::string_view sentence_of(Loss loss, std::size_t axis) {
  static const auto kSentences = [] {
    std::array<std::array<std::string, kCauses.size()>, kAxisLetters.size()> sentences;
    for (std::size_t k = 0; k < kAxisLetters.size(); ++k) {
      for (std::size_t cause = 0; cause < kCauses.size(); ++cause) {
        sentences.at(k).at(cause) = fmt::format("{} {}", kAxisLetters.at(k), kCauses.at(cause));
      }
    }
    return sentences;
  }();
  return kSentences.at(axis).at(static_cast<std::size_t>(loss));
}

}  // namespace paracal::io

#include "gcode_loss.hpp"

#include <fmt/format.h>

#include <array>
#include <string>

#include "gcode_block.hpp"

namespace paracal::io {
namespace {

/// Behind the letter of the axis, in the order of Loss.
constexpr std::array<std::string_view, 8> kCauses{
    "has not been stated yet (--start=X,Y,Z, if the program never does)",
    "is not known since the tool was changed (T, M6)",
    "is not known since motors were switched off (M18, M84) or moved singly (H)",
    "is not known since homing, probing or a stored place (G28 to G30, G33, G38, G61)",
    "is not known since the origin moved (G10, G52, G54 to G59.3, G92, M206)",
    "is not known since the length of the tool changed (G43, G49; --tools)",
    "is not known since something that may have done anything (a macro, M2, /, a line not known here)",
    "is not known since a line that could not be corrected",
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

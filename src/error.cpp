#include "paracal/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace paracal {

InputFileError::InputFileError(const std::string& file, int line, const std::string& complaint)
    : Error(line > 0 ? fmt::format("{}:{}: {}", file, line, complaint) : fmt::format("{}: {}", file, complaint)),
      file_(file),
      line_(line) {}

std::optional<std::size_t> control_character(std::string_view text) {
  constexpr unsigned char kFirstShown = 0x20, kDelete = 0x7F, kLeadOfC1 = 0xC2, kFirstC1 = 0x80, kLastC1 = 0x9F;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    const bool is_c1 =
        byte >= kFirstC1 && byte <= kLastC1 && k > 0 && static_cast<unsigned char>(text[k - 1]) == kLeadOfC1;
    if ((byte < kFirstShown && byte != '\t') || byte == kDelete || is_c1) return k;
  }
  return std::nullopt;
}

std::string printable(std::string_view message) {
  constexpr std::size_t kLongest = 2000;
  const std::size_t more = message.size() - std::min(message.size(), kLongest);
  message = message.substr(0, kLongest);
  std::string text;
  for (auto at = control_character(message); at; at = control_character(message)) {
    text += message.substr(0, *at);
    text += fmt::format("\\x{:02x}", static_cast<unsigned char>(message[*at]));
    message.remove_prefix(*at + 1);
  }
  text += message;
  return more == 0 ? text : fmt::format("{} ... ({} characters more)", text, more);
}

}  // namespace paracal

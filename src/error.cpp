#include "paracal/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace paracal {

Error::Error(const std::string& message) : std::runtime_error(printable(message)) {}

InputFileError::InputFileError(const std::string& file, int line, const std::string& complaint)
    : Error(line > 0 ? fmt::format("{}:{}: {}", file, line, complaint) : fmt::format("{}: {}", file, complaint)),
      file_(file),
      line_(line) {}

namespace {

/// Bytes of the character that the text begins with, where it is no text: controls (C0, DEL, C1), ends of lines and
/// what turns the order of characters round (U+2028 ... U+202E, U+2066 ... U+2069); else 0.
std::size_t length_of_control(std::string_view text) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
  if ((byte(0) < 0x20 && byte(0) != '\t') || byte(0) == 0x7F) return 1;
  if (byte(0) == 0xC2 && byte(1) >= 0x80 && byte(1) <= 0x9F) return 2;
  if (byte(0) != 0xE2) return 0;
  const bool is_in_20 = byte(1) == 0x80 && byte(2) >= 0xA8 && byte(2) <= 0xAE;
  const bool is_in_206 = byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9;
  return is_in_20 || is_in_206 ? 3 : 0;
}

}  // namespace

std::string_view control_character(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (const std::size_t length = length_of_control(text.substr(k)); length > 0) return text.substr(k, length);
  }
  return {};
}

std::string escaped(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
  return text;
}

std::string printable(std::string_view message) {
  constexpr std::size_t kLongest = 2000;
  const std::size_t more = message.size() - std::min(message.size(), kLongest);
  message = message.substr(0, kLongest);
  std::string text;
  for (auto control = control_character(message); !control.empty(); control = control_character(message)) {
    const auto at = static_cast<std::size_t>(control.data() - message.data());
    text.append(message, 0, at).append(escaped(control));
    message.remove_prefix(at + control.size());
  }
  text += message;
  return more == 0 ? text : fmt::format("{} ... ({} characters more)", text, more);
}

}  // namespace paracal

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "paracal/error.hpp"
#include "paracal/mechanism/catalogue.hpp"

namespace paracal::fuzz {

/// What a fuzzer made: its first byte chooses, the rest is the text.
struct Input {
  unsigned choice = 0;
  std::string text;
};

inline Input input_of(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return {};
  return {data[0], std::string(reinterpret_cast<const char*>(data + 1), size - 1)};
}

/// Reads an input: anything that it throws but a complaint of the library is a finding.
template <typename Read>
void may_complain(Read&& read) {
  try {
    read();
  } catch (const Error&) {  // the input is wrong, and was told so
  }
}

/// What does not hold is a finding.
inline void require(bool holds) {
  if (!holds) std::abort();
}

/// One run of a target whose input is a choice and a text.
/// @returns 0, as libFuzzer wants it.
template <typename Read>
int run(const std::uint8_t* data, std::size_t size, Read&& read) {
  const Input input = input_of(data, size);
  may_complain([&] { read(input); });
  return 0;
}

/// Reads what the library wrote itself: a complaint is a finding, too.
template <typename Read>
void must_read(Read&& read) {
  try {
    read();
  } catch (const Error&) {
    std::abort();
  }
}

/// A robot of the catalogue, made once.
inline const Robot& robot(unsigned choice) {
  static const std::array robots{catalogue::huang2016(), catalogue::rotary_delta(), catalogue::linear_delta()};
  return robots[choice % robots.size()];
}

}  // namespace paracal::fuzz

#pragma once

// Private: the words of enumerations in files, options and keywords.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace paracal::io {

/// The words of an enumeration, in its order.
template <typename Enum>
inline constexpr std::array<std::string_view, 0> kWords{};
template <typename T>
concept Worded = std::is_enum_v<T> && !kWords<T>.empty();
/// How many there are, of an enumeration whose words the library's name() says.
template <typename Enum>
inline constexpr std::size_t kNames = 0;
template <typename T>
concept Named = std::is_enum_v<T> &&(kNames<T> > 0);

template <typename T>
std::string_view word_of(T value) {
  if constexpr (Worded<T>) {
    return kWords<T>[static_cast<std::size_t>(value)];
  } else {
    return name(value);
  }
}

template <typename T>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  constexpr std::size_t kCount = Worded<T> ? kWords<T>.size() : kNames<T>;
  for (std::size_t k = 0; k < kCount; ++k) words.emplace_back(word_of(static_cast<T>(k)));
  return words;
}

/// Empty: no such word.
template <typename T>
std::optional<T> value_of(std::string_view word) {
  const std::vector<std::string> words = words_of<T>();
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == word) return static_cast<T>(k);
  }
  return std::nullopt;
}

template <typename T>
inline constexpr bool is_optional = false;
template <typename T>
inline constexpr bool is_optional<std::optional<T>> = true;

}  // namespace paracal::io

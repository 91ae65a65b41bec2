#pragma once

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <compare>
#include <range/v3/algorithm.hpp>
#include <string_view>

// What C++20 has and the standard library of Debian's emscripten (libc++ 13) has not: the algorithms over ranges, from
// the library that they come from, decimal numbers in <charconv>, three-way comparison of text, std::bit_cast. Included
// before every file by the compiler (emscripten.cmake).

namespace std {  // NOLINT(cert-dcl58-cpp): where programs expect it

namespace ranges {
using ::ranges::adjacent_find;
using ::ranges::all_of;
using ::ranges::any_of;
using ::ranges::binary_search;
using ::ranges::copy;
using ::ranges::copy_if;
using ::ranges::count;
using ::ranges::count_if;
using ::ranges::equal;
using ::ranges::find;
using ::ranges::find_if;
using ::ranges::find_if_not;
using ::ranges::for_each;
using ::ranges::is_sorted;
using ::ranges::lower_bound;
using ::ranges::max;
using ::ranges::max_element;
using ::ranges::min;
using ::ranges::min_element;
using ::ranges::minmax;
using ::ranges::move;
using ::ranges::none_of;
using ::ranges::nth_element;
using ::ranges::partial_sort;
using ::ranges::replace;
using ::ranges::replace_if;
using ::ranges::sort;
using ::ranges::stable_sort;
using ::ranges::transform;
using ::ranges::upper_bound;

template <typename Range>
auto next_permutation(Range& range) {
  struct Result {
    bool found;
  };
  return Result{::ranges::next_permutation(range)};  // which says it without a struct
}
}  // namespace ranges

inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const fast_float::from_chars_result result = fast_float::from_chars(first, last, value);
  return {result.ptr, result.ec};
}

inline to_chars_result to_chars(char* first, char* last, double value, chars_format /*fixed*/, int decimals) {
  const auto [end, size] = fmt::format_to_n(first, last - first, "{:.{}f}", value, decimals);
  if (size > static_cast<size_t>(last - first)) return {last, errc::value_too_large};
  return {end, {}};
}

inline strong_ordering operator<=>(string_view one, string_view other) noexcept { return one.compare(other) <=> 0; }

template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

}  // namespace std

// A file system that cannot exchange two files, as there are others: io/file.cpp then replaces one by the other.
enum { RENAME_EXCHANGE = 2 };
inline int renameat2(int /*from*/, const char* /*old_name*/, int /*to*/, const char* /*new_name*/, unsigned /*how*/) {
  errno = EINVAL;
  return -1;
}

#pragma once

// Private to the filter: why the place of an axis is not known.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace paracal::io {

enum class Loss : std::uint8_t {
  unstated,  ///< since the program began
  tool,
  motors,
  elsewhere,  ///< a motion that ends where the program does not say
  origin,
  tool_length,
  unread,  ///< what may do anything
  passed,  ///< a line that stated it could not be corrected
};

/// A sentence that names the axis and the cause; it stays.
std::string_view sentence_of(Loss loss, std::size_t axis);

}  // namespace paracal::io

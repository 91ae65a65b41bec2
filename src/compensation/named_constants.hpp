#pragma once

// What recorded machines share: their inputs and constants as symbols.

#include <array>
#include <cstddef>
#include <string_view>

#include "expression.hpp"

namespace paracal::compensation_detail {

inline Expression input(std::string_view name, std::size_t index) {
  return Expression(Symbol{.name = name, .limb = -1, .index = static_cast<int>(index)});
}

/// Constants of one limb under their names; of those that are 0, 1 or -1 much of the arithmetic is not needed.
class NamedConstants {
 public:
  explicit NamedConstants(std::size_t limb) : limb_(static_cast<int>(limb)) {}

  Expression named(std::string_view name, double value, int index = -1) const {
    if (value == 0.0 || value == 1.0 || value == -1.0) return Expression(value);
    return Expression(Symbol{.name = name, .limb = limb_, .index = index, .value = value});
  }

  template <std::size_t Size>
  std::array<Expression, Size> named(std::string_view name, const std::array<double, Size>& values) const {
    std::array<Expression, Size> expressions;
    for (std::size_t k = 0; k < Size; ++k) expressions[k] = named(name, values[k], static_cast<int>(k));
    return expressions;
  }

 private:
  int limb_;
};

}  // namespace paracal::compensation_detail

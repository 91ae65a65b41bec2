#include "rounded.hpp"

#include <cmath>

namespace paracal::report::detail {

io::Json rounded(double value) {
  constexpr int kDigits = 6;
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, kDigits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return std::isfinite(unit) ? std::round(value * unit) / unit : value;
}

io::Json rounded(const Eigen::Vector3d& vector) {
  return {rounded(vector.x()), rounded(vector.y()), rounded(vector.z())};
}

}  // namespace paracal::report::detail

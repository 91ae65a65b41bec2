#include "paracal/mechanism/random.hpp"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

namespace paracal {
namespace {

/// 53 random bits as a number in (0, 1).
double open_unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32 | low) >> 11;
  return (static_cast<double>(bits) + 0.5) * 0x1p-53;
}

double standard_draw(Distribution distribution, RandomStream& random) {
  if (distribution == Distribution::uniform) return 2.0 * random.uniform() - 1.0;
  double z = random.normal();
  while (distribution == Distribution::truncated_normal && std::abs(z) > 3.0) z = random.normal();
  return z / 3.0;
}

}  // namespace

double RandomStream::uniform() {
  if (uniforms_left_ == 0) {
    const auto half = [](std::uint64_t value, int shift) { return static_cast<std::uint32_t>(value >> shift); };
    const r123::Philox4x32::ctr_type counter{
        {half(counter_, 0), half(counter_, 32), half(stream_, 0), half(stream_, 32)}};
    const r123::Philox4x32::key_type key{{half(seed_, 0), half(seed_, 32)}};
    const auto bits = r123::Philox4x32()(counter, key);
    uniforms_ = {open_unit(bits[2], bits[3]), open_unit(bits[0], bits[1])};
    uniforms_left_ = 2;
    ++counter_;
  }
  return uniforms_[static_cast<std::size_t>(--uniforms_left_)];
}

double RandomStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

SourceErrors draw_errors(const Tolerances& tolerances, std::size_t limb_count, RandomStream& random) {
  SourceErrors errors;
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : all_sources()) {
      errors(limb, source) = tolerances[source] * standard_draw(tolerances.distribution, random);
    }
  }
  return errors;
}

}  // namespace paracal

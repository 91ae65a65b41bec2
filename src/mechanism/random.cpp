#include "paracal/mechanism/random.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "numerics/distributions.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {
namespace {

using detail::normal_probability;

/// 53 random bits as a number in (0, 1).
double open_unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32 | low) >> 11;
  return (static_cast<double>(bits) + 0.5) * 0x1p-53;
}

/// Block k of a stream as two numbers in (0, 1).
std::array<double, 2> uniform_pair(std::uint64_t seed, std::uint64_t stream, std::uint64_t k) {
  const auto half = [](std::uint64_t value, int shift) { return static_cast<std::uint32_t>(value >> shift); };
  const r123::Philox4x32::ctr_type counter{{half(k, 0), half(k, 32), half(stream, 0), half(stream, 32)}};
  const r123::Philox4x32::key_type key{{half(seed, 0), half(seed, 32)}};
  const auto bits = r123::Philox4x32()(counter, key);
  return {open_unit(bits[0], bits[1]), open_unit(bits[2], bits[3])};
}

std::array<double, 2> box_muller(double first, double second) {
  const double radius = std::sqrt(-2.0 * std::log(first));
  const double angle = 2.0 * std::numbers::pi * second;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// The same quantile of a normal distribution cut off at +-3.
double cut_off(double z) {
  const double tail = normal_probability(-3.0);
  const double probability = tail + (1.0 - 2.0 * tail) * normal_probability(z);
  return detail::normal_quantile(probability);
}

double one_of(const std::vector<double>& values, double probability) {
  const auto place = static_cast<std::size_t>(probability * static_cast<double>(values.size()));
  return values[std::min(place, values.size() - 1)];
}

}  // namespace

std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::uint64_t k) {
  const auto [first, second] = uniform_pair(seed, stream, k);
  return box_muller(first, second);
}

double RandomStream::uniform() {
  if (uniforms_left_ == 0) {
    uniforms_ = uniform_pair(seed_, stream_, counter_++);
    uniforms_left_ = 2;
  }
  return uniforms_[static_cast<std::size_t>(2 - uniforms_left_--)];
}

double RandomStream::normal() {
  const std::uint64_t number = normals_++;
  if (given_) return number < given_->size() ? (*given_)[number] : 0.0;
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double first = uniform();
  const std::array<double, 2> pair = box_muller(first, uniform());
  spare_normal_ = pair[1];
  has_spare_ = true;
  return pair[0];
}

std::uint64_t number_of(std::size_t limb, Source source) {
  if (const auto reserved = source.reserved()) return kReservedNumbers * limb + *reserved;
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40, kPrime = 1099511628211ULL;
  std::uint64_t hash = 14695981039346656037ULL + limb;  // FNV-1a
  for (const char letter : source.name()) hash = (hash ^ static_cast<unsigned char>(letter)) * kPrime;
  return kFar + hash % kFar;
}

double source_error(const Tolerances& tolerances, Source source, double standard_normal) {
  const std::vector<double>& measured = tolerances.measured[source];
  if (!measured.empty()) return one_of(measured, normal_probability(standard_normal));
  switch (tolerances.distribution) {
    case Distribution::normal:
      return tolerances[source] * (standard_normal / 3.0);
    case Distribution::uniform:
      return tolerances[source] * (2.0 * normal_probability(standard_normal) - 1.0);
    case Distribution::truncated_normal:
      return tolerances[source] * std::clamp(cut_off(standard_normal) / 3.0, -1.0, 1.0);
  }
  return 0.0;
}

double RandomStream::normal_at(std::uint64_t number) const {
  if (given_) return number < given_->size() ? (*given_)[number] : 0.0;
  return normal_pair(seed_, stream_, number / 2)[number % 2];
}

SourceErrors draw_errors(const Robot& robot, const Tolerances& tolerances, RandomStream& random) {
  std::vector<double> reserved(kReservedNumbers * robot.limb_count());
  std::ranges::generate(reserved, [&] { return random.normal(); });
  SourceErrors errors;
  for (const Parameter& one : robot.parameters()) {
    const double normal = one.number < reserved.size() ? reserved[one.number] : random.normal_at(one.number);
    errors(one.limb, one.source) = source_error(tolerances, one.source, normal);
  }
  return errors;
}

}  // namespace paracal

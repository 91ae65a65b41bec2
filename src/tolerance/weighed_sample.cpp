#include "weighed_sample.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "numerics/distributions.hpp"
#include "paracal/interruption.hpp"

namespace paracal::detail {
namespace {

constexpr std::uint64_t kWeighedChunk = 64;    // machines that are added up together
constexpr std::uint64_t kFirstWeighed = 1024;  // machines before the first look at how well the share is known
constexpr double kGrowth = 3.0;                // of a round over all before it: the first estimates are rough

void add_linear(const WeighedSample::Machines& drawn, Weights& sums) {
  const Eigen::ArrayXd failing = (drawn.used_up > 1.0).select(drawn.weights, 0.0);
  sums.machines += static_cast<std::uint64_t>(failing.size());
  sums.failures += static_cast<std::uint64_t>((drawn.used_up > 1.0).count());
  sums.linear += failing.sum();
  sums.linear_squares += failing.square().sum();
}

}  // namespace

void Weights::add(const Weights& other) {
  machines += other.machines;
  failures += other.failures;
  tried += other.tried;
  not_closed += other.not_closed;
  linear += other.linear;
  linear_squares += other.linear_squares;
  exact += other.exact;
  exact_squares += other.exact_squares;
  both_squares += other.both_squares;
  outer += other.outer;
}

double Weights::linear_error() const {
  if (!(linear > 0.0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(linear_squares - linear * linear / static_cast<double>(machines), 0.0)) / linear;
}

double Weights::ratio_error() const {
  if (!(linear > 0.0) || !(exact > 0.0)) return std::numeric_limits<double>::infinity();
  const double ratio = exact / linear;
  const double scatter = exact_squares - 2.0 * ratio * both_squares + ratio * ratio * linear_squares;
  return std::sqrt(std::max(scatter, 0.0)) / exact;
}

WeighedSample::WeighedSample(const Limits& limits, TiltedMixture mixture, std::uint64_t first_stream,
                             const FailureOptions& options)
    : limits_(limits),
      mixture_(std::move(mixture)),
      first_stream_(first_stream),
      options_(options),
      arena_(options.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(options.threads)) {}

template <typename Chunk>
void WeighedSample::add_up(Weights& sums, std::uint64_t more, const Chunk& chunk) {
  const std::uint64_t chunks = (more + kWeighedChunk - 1) / kWeighedChunk, first = sums.machines;
  std::vector<Weights> parts(chunks);
  arena_.execute([&] {
    tbb::parallel_for(std::uint64_t{0}, chunks, [&](std::uint64_t k) {
      parts[k] = chunk(first + k * kWeighedChunk, std::min(kWeighedChunk, more - k * kWeighedChunk));
    });
  });
  for (const Weights& part : parts) sums.add(part);  // in order: the same sum for any number of threads
}

/// Rounds of machines until the error is what was asked or the effort was made.
template <typename Error, typename Effort, typename Chunk>
bool WeighedSample::repeat(double relative_error, std::uint64_t most, const Progress& progress, Weights& sums,
                           const Error& error, const Effort& effort, const Chunk& chunk) {
  const double wanted = relative_error / two_sided_quantile(options_.confidence);
  std::uint64_t more = std::min(kFirstWeighed, most);
  while (more > 0) {
    add_up(sums, more, chunk);
    const auto machines = static_cast<double>(sums.machines);
    const auto next = static_cast<std::uint64_t>(
        std::min(std::ceil(machines * std::pow(error(sums) / wanted, 2)), (1.0 + kGrowth) * machines));
    if (progress && !progress(sums.machines, std::max(next, sums.machines))) return false;
    const std::uint64_t left = most - std::min(most, effort(sums));
    more = std::min(next - std::min(next, sums.machines), left);
  }
  return true;
}

bool WeighedSample::draw(double relative_error, std::uint64_t most, const Progress& progress) {
  return repeat(
      relative_error, most, progress, sums_, [](const Weights& all) { return all.linear_error(); },
      [](const Weights& all) { return all.machines; },
      [&](std::uint64_t first, std::uint64_t count) { return linear_chunk(first, count); });
}

std::optional<Weights> WeighedSample::try_exactly(double band, double relative_error, const Progress& progress) {
  Weights sums;
  const bool done = repeat(
      relative_error, options_.max_exact, progress, sums, [](const Weights& all) { return all.ratio_error(); },
      [](const Weights& all) { return all.tried; },
      [&](std::uint64_t first, std::uint64_t count) { return exact_chunk(first, count, band); });
  return done ? std::optional(sums) : std::nullopt;
}

WeighedSample::Machines WeighedSample::machines(std::uint64_t first, std::uint64_t count) const {
  let_interrupt();
  const auto columns = static_cast<Eigen::Index>(count);
  Machines drawn{Eigen::MatrixXd(limits_.errors().size(), columns), Eigen::ArrayXd(columns), {}};
  mixture_.draw(options_.seed, first_stream_ + first, drawn.errors, drawn.weights);
  drawn.weights = drawn.weights.exp();
  drawn.used_up = limits_.used_up(drawn.errors);
  return drawn;
}

Weights WeighedSample::linear_chunk(std::uint64_t first, std::uint64_t count) const {
  Weights sums;
  add_linear(machines(first, count), sums);
  return sums;
}

Weights WeighedSample::exact_chunk(std::uint64_t first, std::uint64_t count, double band) const {
  const Machines drawn = machines(first, count);
  Weights sums;
  add_linear(drawn, sums);
  for (Eigen::Index m = 0; m < drawn.used_up.size(); ++m) {
    if (drawn.used_up(m) <= 1.0 - band) continue;
    let_interrupt();
    ++sums.tried;
    const std::uint64_t stream = first_stream_ + first + static_cast<std::uint64_t>(m);
    const Limits::Trial trial = limits_.try_exactly(drawn.errors.col(m), 1.0 - band, options_.seed, stream);
    if (!trial.closes) ++sums.not_closed;
    if (!trial.fails) continue;
    const double weight = drawn.weights(m), square = weight * weight;
    sums.exact += weight;
    sums.exact_squares += square;
    if (drawn.used_up(m) > 1.0) sums.both_squares += square;
    if (trial.linear <= 1.0 - 0.5 * band) sums.outer += weight;
  }
  return sums;
}

}  // namespace paracal::detail

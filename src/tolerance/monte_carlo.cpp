#include "paracal/tolerance/monte_carlo.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "drawing.hpp"
#include "numerics/distributions.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"

namespace paracal {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kChunk = 128;        // machines: their responses stay in the cache
constexpr std::uint64_t kFirstRound = 1024;  // machines before the first look at the spread

/// Machines between two looks at whether to go on: about a second of either model.
constexpr std::uint64_t slice_of(Model model) { return (model == Model::exact ? 64 : 4096) * kChunk; }

/// Sums over the machines of a chunk, a column a requirement: they depend on the order of adding, so every chunk keeps
/// its own and the chunks are added in order.
struct Sums {
  Eigen::ArrayXd components;               ///< of every component
  Eigen::ArrayXXd squares, fourth_powers;  ///< of the length, to the 2nd and 4th power; a row a pose

  Sums(Eigen::Index rows, Eigen::Index poses, Eigen::Index requirements)
      : components(Eigen::ArrayXd::Zero(rows)),
        squares(Eigen::ArrayXXd::Zero(poses, requirements)),
        fourth_powers(Eigen::ArrayXXd::Zero(poses, requirements)) {}

  void add(const Sums& other) {
    components += other.components;
    squares += other.squares;
    fourth_powers += other.fourth_powers;
  }
};

/// What is counted in whole numbers, and so adds up the same in any order.
struct Counts {
  std::vector<Histogram> largest;
  std::vector<std::uint64_t> passed;
  std::uint64_t passed_all = 0, not_closed = 0;

  explicit Counts(std::size_t requirements) : largest(requirements), passed(requirements, 0) {}

  void add(const Counts& other) {
    for (std::size_t k = 0; k < passed.size(); ++k) {
      largest[k].add(other.largest[k]);
      passed[k] += other.passed[k];
    }
    passed_all += other.passed_all;
    not_closed += other.not_closed;
  }
};

class Sampler {
 public:
  Sampler(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
          const std::vector<Pose>& poses, const MonteCarloOptions& options)
      : robot_(robot),
        tolerances_(tolerances),
        requirements_(requirements),
        options_(options),
        response_(robot, characteristics_of(requirements), poses),
        drawing_(robot, response_.linear(), tolerances),
        sums_(empty_sums()),
        counts_(requirements.size()),
        arena_(options.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(options.threads)) {}

  std::uint64_t machines() const { return machines_; }

  /// Draws so many machines more by a long job.
  /// @returns false when that was stopped; then there are as many as before.
  bool draw(std::uint64_t more, LongJob& job, const std::function<bool()>& goes_on) {
    const std::uint64_t chunks = (more + kChunk - 1) / kChunk;
    const auto results = compute_each(
        job, fmt::format("machines-{:012}", machines_), 0, chunks,
        [&](std::uint64_t chunk) -> std::optional<std::string> {
          if (!goes_on()) return std::nullopt;
          Sums sums = empty_sums();
          Counts counts(requirements_.size());
          const std::uint64_t first = chunk * kChunk, last = std::min(first + kChunk, more);
          arena_.execute([&] { run_chunk(machines_ + first, last - first, sums, counts); });
          return as_json(sums, counts).dump();
        },
        [&](std::uint64_t chunk, const std::string& result) {
          Sums sums = empty_sums();
          Counts counts(requirements_.size());
          const std::uint64_t machines = std::min(kChunk, more - chunk * kChunk);
          add_json(Json::parse(result), machines, sums, counts);
          const auto is_whole = [&](const Histogram& one) { return one.total() == machines - counts.not_closed; };
          if (!std::ranges::all_of(counts.largest, is_whole)) throw Error("expected a value of each machine");
        });
    if (!results) return false;
    for (const std::string& result : *results) add_json(Json::parse(result), more, sums_, counts_);
    machines_ += more;
    return true;
  }

  /// Draws so many machines more.
  void draw(std::uint64_t more) {
    const std::uint64_t chunks = (more + kChunk - 1) / kChunk;
    std::vector<Sums> sums(chunks, empty_sums());
    tbb::enumerable_thread_specific<Counts> counts(Counts(requirements_.size()));
    arena_.execute([&] {
      tbb::parallel_for(std::uint64_t{0}, chunks, [&](std::uint64_t chunk) {
        const std::uint64_t first = chunk * kChunk, last = std::min(first + kChunk, more);
        run_chunk(machines_ + first, last - first, sums[chunk], counts.local());
      });
    });
    for (const Sums& one : sums) sums_.add(one);
    for (const Counts& one : counts) counts_.add(one);
    machines_ += more;
  }

  /// Machines after which every sigma should be known as well as asked.
  std::uint64_t expected() const {
    double largest = 0.0;
    for (std::size_t k = 0; k < requirements_.size(); ++k) {
      const SigmaAtPose worst = worst_of(k).second;
      if (worst.sigma > 0.0) largest = std::max(largest, half_width(worst) / worst.sigma);
    }
    const double share = largest / options_.sigma_error;
    return static_cast<std::uint64_t>(std::ceil(static_cast<double>(machines_) * share * share));
  }

  MonteCarlo result() const {
    MonteCarlo result{.model = options_.model,
                      .machines = machines_,
                      .converged = expected() <= machines_,
                      .not_closed = counts_.not_closed,
                      .passed = counts_.passed_all};
    for (std::size_t k = 0; k < requirements_.size(); ++k) {
      RequirementStatistics statistics{
          .requirement = requirements_[k], .largest = counts_.largest[k], .passed = counts_.passed[k]};
      for (Eigen::Index p = 0; p < pose_count(); ++p) statistics.poses.push_back(at_pose(k, p));
      statistics.worst = static_cast<std::size_t>(worst_of(k).first);
      result.requirements.push_back(std::move(statistics));
    }
    return result;
  }

 private:
  Eigen::Index pose_count() const { return static_cast<Eigen::Index>(response_.poses().size()); }

  Sums empty_sums() const { return {response_.rows(), pose_count(), static_cast<Eigen::Index>(requirements_.size())}; }

  void run_chunk(std::uint64_t first, std::uint64_t count, Sums& sums, Counts& counts) const {
    Eigen::MatrixXd components(response_.rows(), static_cast<Eigen::Index>(count));
    std::vector<char> closed(count, 1);
    let_interrupt();
    if (options_.model == Model::linear) {
      Eigen::MatrixXd errors(drawing_.matrix().cols(), components.cols());
      drawing_.draw(options_.seed, first, errors);
      components.noalias() = drawing_.matrix() * errors;
    } else {
      tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t m) {
        let_interrupt();
        RandomStream random(options_.seed, first + m);
        auto column = components.col(static_cast<Eigen::Index>(m));
        closed[m] = response_.exact(draw_errors(robot_, tolerances_, random), column) ? 1 : 0;
        if (closed[m] == 0) column.setZero();
      });
    }
    add_up(components, closed, sums, counts);
  }

  void add_up(const Eigen::MatrixXd& components, const std::vector<char>& closed, Sums& sums, Counts& counts) const {
    std::vector<char> good = closed;
    sums.components += components.rowwise().sum().array();
    for (std::size_t k = 0; k < requirements_.size(); ++k) {
      const Eigen::ArrayXXd squared = response_.squared_lengths(k, components);
      sums.squares.col(static_cast<Eigen::Index>(k)) += squared.rowwise().sum();
      sums.fourth_powers.col(static_cast<Eigen::Index>(k)) += squared.square().rowwise().sum();
      const Eigen::ArrayXd largest = squared.colwise().maxCoeff().sqrt();
      for (std::size_t m = 0; m < closed.size(); ++m) {
        if (closed[m] == 0) continue;
        const double value = largest(static_cast<Eigen::Index>(m));
        counts.largest[k].add(value);
        const bool keeps = value <= requirements_[k].limit;
        if (keeps) ++counts.passed[k];
        good[m] = good[m] != 0 && keeps ? 1 : 0;
      }
    }
    counts.passed_all += static_cast<std::uint64_t>(std::ranges::count(good, 1));
    counts.not_closed += static_cast<std::uint64_t>(std::ranges::count(closed, 0));
  }

  // ---- a chunk as a long job keeps it: numbers to the last bit

  static Json numbers(const Eigen::ArrayXXd& array) {
    return std::vector<double>(array.data(), array.data() + array.size());
  }

  template <typename Array>
  static void add_numbers(const Json& json, Array& array) {
    std::vector<double> values;
    for (const Json& value : json.get_ref<const Json::array_t&>()) values.push_back(value.get_ref<const double&>());
    if (static_cast<Eigen::Index>(values.size()) != array.size()) throw Error("expected sums over the same poses");
    array += Eigen::Map<const Array>(values.data(), array.rows(), array.cols());
  }

  static const Json::array_t& list_of(const Json& json, std::size_t size) {
    const auto& list = json.get_ref<const Json::array_t&>();
    if (list.size() != size) throw Error("expected a list with an entry for each requirement");
    return list;
  }

  /// Whole, and at most so large.
  static std::uint64_t count_of(const Json& json, std::uint64_t most) {
    const auto& count = json.get_ref<const std::uint64_t&>();
    if (count > most) throw Error("expected a smaller count");
    return count;
  }

  static Json as_json(const Sums& sums, const Counts& counts) {
    Json json{{"components", numbers(sums.components)},
              {"squares", numbers(sums.squares)},
              {"fourth_powers", numbers(sums.fourth_powers)},
              {"passed", counts.passed},
              {"passed_all", counts.passed_all},
              {"not_closed", counts.not_closed},
              {"largest", Json::array()}};
    for (const Histogram& largest : counts.largest) {
      Json bins = Json::array();
      for (const auto& [bin, count] : largest.counts()) bins.push_back({bin, count});
      json["largest"].push_back(std::move(bins));
    }
    return json;
  }

  /// @param machines  at least those of the chunk.
  /// @throws std::exception for what as_json() has not made.
  static void add_json(const Json& json, std::uint64_t machines, Sums& sums, Counts& counts) {
    add_numbers(json.at("components"), sums.components);
    add_numbers(json.at("squares"), sums.squares);
    add_numbers(json.at("fourth_powers"), sums.fourth_powers);
    counts.passed_all += count_of(json.at("passed_all"), machines);
    counts.not_closed += count_of(json.at("not_closed"), machines);
    const auto& passed = list_of(json.at("passed"), counts.passed.size());
    const auto& largest = list_of(json.at("largest"), counts.passed.size());
    for (std::size_t k = 0; k < counts.passed.size(); ++k) {
      counts.passed[k] += count_of(passed[k], machines);
      for (const Json& bin : largest[k].get_ref<const Json::array_t&>()) {
        const std::uint64_t number = count_of(bin.at(0), Histogram::kBins - 1);
        counts.largest[k].add(static_cast<std::uint32_t>(number), count_of(bin.at(1), machines));
      }
    }
  }

  SigmaAtPose at_pose(std::size_t k, Eigen::Index p) const {
    const auto column = static_cast<Eigen::Index>(k);
    const auto n = std::max(static_cast<double>(machines_ - counts_.not_closed), 1.0);
    double mean_square = 0.0;
    for (int j = 0; j < component_count(requirements_[k].characteristic.quantity); ++j) {
      const double mean = sums_.components(response_.first_row(k) + j * pose_count() + p) / n;
      mean_square += mean * mean;
    }
    const double square = sums_.squares(p, column) / n;
    // The mean of a length squared, less the square of the mean; without shift the second is noise of relative size
    // 1 / n.
    const double variance = std::max(square - mean_square, 0.0);
    const double scatter = std::sqrt(std::max(sums_.fourth_powers(p, column) / n - square * square, 0.0) / n);
    const double z = detail::two_sided_quantile(options_.confidence);
    return {response_.poses()[static_cast<std::size_t>(p)],
            std::sqrt(variance),
            std::sqrt(mean_square),
            {std::sqrt(std::max(variance - z * scatter, 0.0)), std::sqrt(variance + z * scatter)}};
  }

  std::pair<Eigen::Index, SigmaAtPose> worst_of(std::size_t k) const {
    std::pair<Eigen::Index, SigmaAtPose> worst{0, at_pose(k, 0)};
    for (Eigen::Index p = 1; p < pose_count(); ++p) {
      const SigmaAtPose one = at_pose(k, p);
      if (one.sigma > worst.second.sigma) worst = {p, one};
    }
    return worst;
  }

  static double half_width(const SigmaAtPose& at) { return 0.5 * (at.interval.high - at.interval.low); }

  const Robot& robot_;
  const Tolerances& tolerances_;
  const std::vector<Requirement>& requirements_;
  const MonteCarloOptions& options_;
  Response response_;
  detail::Drawing drawing_;
  std::uint64_t machines_ = 0;
  Sums sums_;
  Counts counts_;
  tbb::task_arena arena_;
};

}  // namespace

double RequirementStatistics::cpk() const { return (requirement.limit - at_worst().mean) / (3.0 * at_worst().sigma); }

MonteCarlo monte_carlo(const Robot& robot, const Tolerances& tolerances, const std::vector<Requirement>& requirements,
                       const std::vector<Pose>& poses, const MonteCarloOptions& options, const Progress& progress,
                       LongJob* job) {
  if (requirements.empty() || poses.empty()) throw InvalidArgument("Monte Carlo: expected requirements and poses");
  if (!(options.sigma_error > 0.0) || !(options.confidence > 0.0) || !(options.confidence < 1.0)) {
    throw InvalidArgument("Monte Carlo: expected an error above 0 and a confidence between 0 and 1");
  }
  Sampler sampler(robot, tolerances, requirements, poses, options);
  std::uint64_t wanted = std::min(kFirstRound, options.max_machines);
  while (sampler.machines() < wanted) {
    // At most four times as many before the next look: the first estimate of what is needed is rough.
    const std::uint64_t next = std::min(wanted, 4 * std::max(sampler.machines(), kFirstRound));
    while (sampler.machines() < next) {
      const std::uint64_t more = std::min(next - sampler.machines(), slice_of(options.model));
      const auto goes_on = [&] { return !progress || progress(sampler.machines(), wanted); };
      if (job == nullptr || options.model == Model::linear) {
        sampler.draw(more);
      } else if (!sampler.draw(more, *job, goes_on)) {
        return sampler.result();
      }
      if (!goes_on()) return sampler.result();
    }
    wanted = std::min(std::max(sampler.expected(), sampler.machines()), options.max_machines);
  }
  return sampler.result();
}

}  // namespace paracal

// The compensator of a controller: its time compared with the nominal inverse, its slowest calls, and the remaining
// error of each method; and the speed of the filter that corrects programs.
//
// It only reports: the exit status is always 0. Candidates run in turn in many short rounds, as in
// kinematics_benchmark.cpp. The slowest calls are timed individually and include interruptions by the operating system.
// An empty call, timed in the same way, shows the part of the clock.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "comparison.hpp"
#include "filter_report.hpp"
#include "host.hpp"
#include "interleaved_timing.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/path.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "rotarydeltakins.hpp"
#include "support/virtual_machines.hpp"
#include "task.hpp"

namespace {

using namespace paracal;
using namespace paracal::benchmark;

constexpr std::size_t kPoses = 1000;
constexpr int kRounds = 200;

struct Candidate {
  std::string name;
  Pass pass;
};

/// One call of a compensator; joints live outside, as in a controller.
template <typename Scalar>
struct Call {
  Compensator<Scalar> compensator;
  std::vector<CompensatorPose<Scalar>> poses;
  CompensatorJoints<Scalar> joints{};

  Call(const Task& task, const SourceErrors& errors, CompensationWay way)
      : compensator(compensator_parameters<Scalar>(task.robot, errors), way) {
    for (const Pose& pose : task.poses) poses.push_back(closure_pose<Scalar>(pose));
  }
  void operator()(std::size_t k) {
    keep(compensator.compensate(poses[k], joints));
    keep(joints);
  }
};

template <typename One>
Pass each_pose(One one) {
  return [one]() mutable {
    for (std::size_t k = 0; k < kPoses; ++k) one(k);
  };
}

/// U of each pose, whatever the covariance.
Pass uncertainty_pass(const Task& task) {
  std::vector<CompensatorPose<double>> poses;
  for (const Pose& pose : task.poses) poses.push_back(closure_pose(pose));
  CompensatorCovariance<double> covariance{};
  for (std::size_t k = 0; k < covariance.size(); ++k) covariance[k][k] = 1e-6;
  return [parameters = compensator_parameters(task.robot, task.errors), poses,
          covariance = std::make_shared<const CompensatorCovariance<double>>(covariance)] {
    CompensatorUncertainty<double> uncertainty;
    for (const CompensatorPose<double>& pose : poses) {
      keep(stated_uncertainty(parameters, *covariance, pose, uncertainty));
      keep(uncertainty);
    }
  };
}

/// All poses of the task by one call, in the lanes of vector registers.
Pass path_pass(const Task& task, const SourceErrors& errors) {
  std::vector<CompensatorPose<double>> poses;
  for (const Pose& pose : task.poses) poses.push_back(closure_pose(pose));
  return [parameters = compensator_parameters(task.robot, errors), poses,
          joints = std::vector<CompensatorJoints<double>>(kPoses),
          statuses = std::vector<CompensationStatus>(kPoses)]() mutable {
    compensate_path(parameters, poses, joints, statuses);
    keep(joints);
  };
}

/// Both must mean the same robot: on its axis all joints are equal, however they are numbered.
void check_opponent(const Robot& robot, const RotaryDeltaKins& opponent) {
  const double z = robot.workspace().centre().z();
  const double ours = to_degrees(inverse(robot.nominal(), {{0.0, 0.0, z}, 0.0}).joints(0));
  const double theirs = opponent.inverse(0.0, 0.0, z)[0];
  fmt::print("joints on the axis at z = {} mm: ours {:.9f} deg, rotarydeltakins {:.9f} deg\n\n", z, ours, theirs);
}

std::vector<std::array<double, 3>> joints_of(const Task& task, const RotaryDeltaKins& opponent) {
  std::vector<std::array<double, 3>> joints;
  for (const Pose& pose : task.poses) {
    joints.push_back(opponent.inverse(pose.position.x(), pose.position.y(), pose.position.z()));
  }
  return joints;
}

/// Places among the candidates.
enum : std::size_t { kNominal, kExactLevel, kExact = 5, kLanesLevel = 7, kLanes, kForward = 11 };

void report_times(const Task& task) {
  const SourceErrors level = without_tilt_group(task.errors);
  const auto nominal_inverse = [&task](std::size_t k) { keep(inverse(task.robot.nominal(), task.poses[k])); };
  const auto tilted_inverse = [&task](std::size_t k) { keep(inverse(task.machine, task.poses[k])); };
  const auto nominal_forward = [&task](std::size_t k) { keep(forward(task.robot.nominal(), task.joints[k])); };
  std::vector<Candidate> candidates{
      {"nominal inverse of the library", each_pose(nominal_inverse)},
      {"exact, position group", each_pose(Call<double>(task, level, CompensationWay::exact))},
      {"exact, position group, float", each_pose(Call<float>(task, level, CompensationWay::exact))},
      {"linear (Eq. 23)", each_pose(Call<double>(task, level, CompensationWay::linear))},
      {"tilt-aware (Eq. 8), all errors", each_pose(Call<double>(task, task.errors, CompensationWay::tilt_aware))},
      {"exact, all errors", each_pose(Call<double>(task, task.errors, CompensationWay::exact))},
      {"exact, all errors, float", each_pose(Call<float>(task, task.errors, CompensationWay::exact))},
      {"path in lanes, position group", path_pass(task, level)},
      {"path in lanes, all errors", path_pass(task, task.errors)},
      {"stated uncertainty", uncertainty_pass(task)},
      {"inverse of the library, all errors", each_pose(tilted_inverse)},
      {"nominal forward of the library", each_pose(nominal_forward)},
  };
  std::vector<std::string> opponents;
  const std::size_t first = candidates.size();
  for (const LinuxcncBuild& build : linuxcnc_builds()) {
    if (task.robot.name() != "rotary_delta") break;
    const std::string title = "LinuxCNC rotarydeltakins " + build.title;
    const std::shared_ptr<RotaryDeltaKins> opponent = RotaryDeltaKins::of(task.robot, build);
    if (opponent == nullptr) {
      not_installed("kinematics of a Delta", title, "linuxcnc-uspace-dev");
      continue;
    }
    check_opponent(task.robot, *opponent);
    opponents.push_back(title);
    candidates.push_back({title, each_pose([&task, opponent](std::size_t k) {
                            const Eigen::Vector3d& at = task.poses[k].position;
                            keep(opponent->inverse(at.x(), at.y(), at.z()));
                          })});
    candidates.push_back({title + ", forward", each_pose([joints = joints_of(task, *opponent), opponent](
                                                             std::size_t k) { keep(opponent->forward(joints[k])); })});
  }
  std::vector<Pass> passes;
  passes.reserve(candidates.size());
  for (const Candidate& candidate : candidates) passes.push_back(candidate.pass);
  const auto seconds = interleave(passes, kRounds);
  fmt::print("{:<36}{:>10}{:>10}{:>24}\n", "one pose, ns", "median", "p99", "/ nominal inverse");
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Spread spread = spread_of(seconds[k]);
    const double to_ns = 1e9 / static_cast<double>(kPoses);
    fmt::print("{:<36}{:>10.0f}{:>10.0f}{:>24.2f}\n", candidates[k].name, spread.median * to_ns, spread.p99 * to_ns,
               median_ratio(seconds[k], seconds[0]));
  }
  if (task.robot.name() == "huang2016") {
    const std::vector<std::pair<std::size_t, const char*>> stated{{kExactLevel, "position errors, one pose per call"},
                                                                  {kExact, "all errors, one pose per call"},
                                                                  {kLanesLevel, "position errors, one path per call"},
                                                                  {kLanes, "all errors, one path per call"}};
    for (const auto& [k, what] : stated) {
      state(fmt::format("exact compensation of `huang2016`, {}", what), 1e9 / kPoses * spread_of(seconds[k]).median,
            "ns per pose");
    }
  }
  for (std::size_t k = 0; k < opponents.size(); ++k) {
    const auto against = [&](const char* task_name, std::size_t ours, std::size_t theirs, const char* note) {
      compare({.task = task_name, .opponent = opponents[k], .unit = "ns per pose", .note = note},
              {seconds[ours], kPoses}, {seconds[theirs], kPoses});
    };
    const std::size_t its_inverse = first + 2 * k, its_forward = its_inverse + 1;
    against("inverse kinematics of a Delta, nominal", kNominal, its_inverse, "");
    against("forward kinematics of a Delta, nominal", kForward, its_forward,
            "paracal iterates and handles all errors; rotarydeltakins has a closed form for the nominal robot");
    against("exact compensation of a Delta, position errors", kExactLevel, its_inverse,
            "rotarydeltakins computes the nominal inverse, without compensation");
    against("exact compensation of a Delta, all errors", kExact, its_inverse,
            "rotarydeltakins computes the nominal inverse, without compensation");
  }
}

// ---- the slowest calls

/// Times of single calls, counted by whole ns up to a limit; memory does not grow with the calls.
class CallTimes {
 public:
  void add(std::int64_t ns) {
    ++counts_[static_cast<std::size_t>(std::clamp<std::int64_t>(ns, 0, kLongest))];
    max_ = std::max(max_, ns);
    ++calls_;
  }
  std::int64_t quantile(double share) const {
    std::int64_t seen = 0;
    for (std::size_t ns = 0; ns < counts_.size(); ++ns) {
      seen += counts_[ns];
      if (static_cast<double>(seen) >= share * static_cast<double>(calls_)) return static_cast<std::int64_t>(ns);
    }
    return kLongest;
  }
  std::int64_t max() const { return max_; }

 private:
  static constexpr std::int64_t kLongest = 200'000;
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(kLongest + 1);
  std::int64_t calls_ = 0, max_ = 0;
};

template <typename One>
void report_slowest(std::string_view name, One one, std::int64_t calls) {
  using Clock = std::chrono::steady_clock;
  CallTimes times;
  for (std::int64_t call = 0; call < calls; ++call) {
    const Clock::time_point start = Clock::now();
    one(static_cast<std::size_t>(call) % kPoses);
    times.add(std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count());
  }
  fmt::print("{:<36}{:>10}{:>10}{:>10}{:>12}\n", name, times.quantile(0.5), times.quantile(0.99),
             times.quantile(0.9999), times.max());
}

void report_slowest_calls(const Task& task, std::int64_t calls) {
  fmt::print("{:<36}{:>10}{:>10}{:>10}{:>12}   over {:g} calls\n", "one call, ns", "median", "p99", "p99.99", "max",
             static_cast<double>(calls));
  report_slowest(
      "clock only", [](std::size_t) {}, calls);
  report_slowest("exact, position group", Call<double>(task, without_tilt_group(task.errors), CompensationWay::exact),
                 calls);
  report_slowest("exact, all errors", Call<double>(task, task.errors, CompensationWay::exact), calls);
}

// ---- what each way leaves over

/// What of the machine's errors a compensator knows.
enum class Known : std::uint8_t { nothing, offsets, all };

struct Way {
  const char* name;
  CompensationWay way;
  Known known;
};

constexpr std::array kWays{Way{"none (nominal inverse)", CompensationWay::exact, Known::nothing},
                           Way{"encoder offsets (Eq. 22)", CompensationWay::linear, Known::offsets},
                           Way{"linear (Eq. 23)", CompensationWay::linear, Known::all},
                           Way{"tilt-aware (Eq. 8)", CompensationWay::tilt_aware, Known::all},
                           Way{"exact", CompensationWay::exact, Known::all}};

/// Encoder offsets that rough calibration found on the prototype [huang2016, 5.2].
constexpr std::array kRoughOffsets{0.189, 0.862, 0.912, 0.344};  // deg

/// A machine before any calibration: these offsets on top of the errors of [huang2016, Table 4].
SourceErrors uncalibrated(const Robot& robot, int number) {
  SourceErrors errors = test::table4_machine(robot, number);
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    errors(limb, "theta_offset") += to_radians(kRoughOffsets[limb]);
  }
  return errors;
}

SourceErrors known_of(const SourceErrors& errors, Known known) {
  if (known == Known::all) return errors;
  SourceErrors offsets;
  for (std::size_t limb = 0; known == Known::offsets && limb < kMaxLimbs; ++limb) {
    offsets(limb, "theta_offset") = errors(limb, "theta_offset");
  }
  return offsets;
}

struct Left {
  double sum_of_squares = 0.0, max = 0.0, max_rotation = 0.0;
  int poses = 0;

  void add(const Machine& machine, const Pose& pose, const PlateState& plate) {
    const double position = (plate.position - pose.position).norm();
    sum_of_squares += position * position;
    max = std::max(max, position);
    max_rotation = std::max(max_rotation, std::abs(machine.rotation_of(plate.slide) - pose.rotation));
    ++poses;
  }
};

constexpr int kMachines = 100;

Left left_over(const Task& task, const Way& way) {
  Left left;
  for (int number = 0; number < kMachines; ++number) {
    const SourceErrors errors = uncalibrated(task.robot, number);
    const Machine machine = build(task.robot, errors);
    const auto parameters = compensator_parameters(task.robot, known_of(errors, way.known));
    for (const Pose& pose : task.poses) {
      CompensatorJoints<double> joints{};
      if (compensate(parameters, way.way, closure_pose(pose), joints) != CompensationStatus::ok) continue;
      left.add(machine, pose, forward(machine, compensated_joints(task.robot, joints)).plate);
    }
  }
  return left;
}

void report_left_over(const Task& task) {
  fmt::print("{:<36}{:>12}{:>14}{:>16}   {} machines, {} poses each\n", "remaining error of", "rms, um", "max, um",
             "max, deg", kMachines, kPoses);
  for (const Way& way : kWays) {
    const Left left = left_over(task, way);
    fmt::print("{:<36}{:>12.2g}{:>14.2g}{:>16.2g}\n", way.name,
               1e3 * std::sqrt(left.sum_of_squares / std::max(left.poses, 1)), 1e3 * left.max,
               to_degrees(left.max_rotation));
  }
}

}  // namespace

/// @param argv  optional: how many calls to time one by one; default 10^7.
int main(int argc, char** argv) {
  const std::int64_t calls = argc > 1 ? std::max(std::atoll(argv[1]), 1LL) : 10'000'000;
  fmt::print("{}", host_description());
  for (const std::string_view name : catalogue::names()) {
    const Task task = make_task(catalogue::find(name), kPoses);
    fmt::print("\n{}: {} limbs, {} random poses, {} rounds\n\n", name, task.robot.limb_count(), kPoses, kRounds);
    report_times(task);
    fmt::print("\n");
    report_slowest_calls(task, calls);
    fmt::print("\n");
    report_left_over(task);
    fmt::print("\n");
    report_filter(task);
  }
}

#include "filter_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <streambuf>

#include "comparison.hpp"
#include "interleaved_timing.hpp"
#include "paracal/filter/target_filter.hpp"
#include "peak_memory.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kRounds = 5;
constexpr double kMegabyte = 1e6;

constexpr int kLines = 1000;

/// A closed curve in steps of one or two mm, all axes a line, as post-processors write them.
std::string block_of_lines(const Robot& robot, std::string_view before) {
  const Workspace& workspace = robot.workspace();
  std::string text;
  for (int k = 0; k < kLines; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kLines, along = std::sin(angle);
    const Eigen::Vector3d r =
        Workspace::on_circle(0.4 * workspace.radius, angle, workspace.centre().z() + 20.0 * along);
    const double phi = robot.slide() ? 30.0 * along : 0.0;
    fmt::format_to(std::back_inserter(text), "{}G1 X{:.3f} Y{:.3f} Z{:.3f} C{:.3f} F6000\n", before, r.x(), r.y(),
                   r.z(), phi);
  }
  return text;
}

/// The same lines again and again, as a stream that takes no memory.
class Repeated : public std::streambuf {
 public:
  Repeated(std::string block, double bytes) : block_(std::move(block)), left_(bytes) {}

 protected:
  int_type underflow() override {
    if (left_ <= 0.0) return traits_type::eof();
    left_ -= static_cast<double>(block_.size());
    setg(block_.data(), block_.data(), block_.data() + block_.size());
    return traits_type::to_int_type(block_.front());
  }

 private:
  std::string block_;
  double left_;
};

/// @returns how many bytes came out.
std::size_t filter(const TargetCorrection& correction, const std::string& block, double bytes, unsigned threads) {
  Repeated source(block, bytes);
  std::istream stream(&source);
  std::size_t written = 0;
  keep(io::filter_gcode({"", stream}, [&](std::string_view text) { written += text.size(); }, correction,
                        {.threads = threads}));
  return written;
}

/// The same from a file to nowhere, as a program of its own does it.
void filter_file(const TargetCorrection& correction, const std::string& path) {
  std::ifstream source(path);
  std::ofstream nowhere("/dev/null");
  keep(io::filter_gcode({path, source}, [&](std::string_view text) { nowhere << text; }, correction, {.threads = 1}));
}

/// shift_targets.awk by mawk, a process a pass.
void compare_with_mawk(const TargetCorrection& all, const TargetCorrection& level, const std::string& lines) {
  const std::string task = "correction of a part program (`export --target gcode`), ";
  constexpr const char* kOpponent = "mawk, benchmarks/shift_targets.awk: adds a constant to each coordinate";
  if (std::system("mawk -W version >/dev/null 2>&1") != 0) return not_installed(task + "all errors", kOpponent, "mawk");
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("paracal-lines-{}.ngc", ::getpid())).string();
  constexpr int kBlocks = 100;
  {
    std::ofstream file(path);
    for (int k = 0; k < kBlocks; ++k) file << lines;
  }
  const std::string command = "mawk -f " PARACAL_BENCHMARK_FOLDER "/shift_targets.awk " + path + " >/dev/null";
  const auto seconds = interleave(
      {[&] { filter_file(all, path); }, [&] { filter_file(level, path); }, [&] { keep(std::system(command.c_str())); }},
      kRounds);
  std::filesystem::remove(path);
  const char* note =
      "paracal also inverts the machine with errors, follows the modes of the program, divides long blocks, adjusts "
      "feeds and refuses invalid programs; the awk program does not";
  constexpr double kCount = static_cast<double>(kBlocks) * kLines;
  const Work theirs{seconds[2], kCount};
  compare({.task = task + "all errors", .opponent = kOpponent, .unit = "us per line", .note = note},
          {seconds[0], kCount}, theirs);
  compare({.task = task + "position errors", .opponent = kOpponent, .unit = "us per line", .note = note},
          {seconds[1], kCount}, theirs);
}

}  // namespace

void report_filter(const Task& task) {
  const TargetCorrection all(task.robot, task.errors), level(task.robot, without_tilt_group(task.errors));
  const std::string lines = block_of_lines(task.robot, ""), comments = block_of_lines(task.robot, ";");
  const double line_size = static_cast<double>(lines.size()) / kLines;
  const double few = peak_memory([&] { keep(filter(all, lines, 2 * kMegabyte, 1)); });
  const double many = peak_memory([&] { keep(filter(all, lines, 100 * kMegabyte, 1)); });
  const auto pass = [](const TargetCorrection& correction, const std::string& block, unsigned threads) {
    return [&correction, &block, threads] { keep(filter(correction, block, 4 * kMegabyte, threads)); };
  };
  const auto seconds =
      interleave({pass(all, comments, 1), pass(level, lines, 1), pass(all, lines, 1), pass(all, lines, 0)}, kRounds);
  fmt::print("{:<36}{:>10}{:>12}   {:.0f} bytes per line\n", "filter of G-code", "MB/s", "us per line", line_size);
  constexpr std::array kNames{"the same lines as comments", "position group", "all errors", "all errors, all threads"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const double bytes_a_second = 4 * kMegabyte / spread_of(seconds[k]).median;
    fmt::print("{:<36}{:>10.1f}{:>12.2f}\n", kNames[k], bytes_a_second / kMegabyte, 1e6 * line_size / bytes_a_second);
  }
  fmt::print("{:<36}{:>10.1f} for 2 MB, {:.1f} for 100 MB\n", "memory of the process, MB", few, many);
  if (task.robot.name() == "huang2016") compare_with_mawk(all, level, lines);
}

}  // namespace paracal::benchmark

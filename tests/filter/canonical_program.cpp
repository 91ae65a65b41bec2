#include "canonical_program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <sstream>

namespace paracal::test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kAtRest = 1e-6;  // mm: what is left of places that were computed is no motion

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string one; std::getline(stream, one, ',');) numbers.push_back(std::strtod(one.c_str(), nullptr));
  return numbers;
}

/// Reads call by call; numbers of calls are in the program's coordinates and unit.
class Interpreter {
 public:
  Interpreter(CanonicalProgram& program, bool counts_tools) : program_(program) {
    program_.paths.emplace_back();
    if (counts_tools) first_tool_ = Eigen::Vector3d::Zero();
  }

  void take(int line, const std::string& name, const std::string& arguments) {
    if (line > 0) line_ = line;
    const std::vector<double> numbers = numbers_in(arguments);
    if (name == "STRAIGHT_TRAVERSE" || name == "STRAIGHT_FEED") {
      return move({place({numbers[0], numbers[1], numbers[2]}), numbers[5]},
                  {.feed = name == "STRAIGHT_FEED" ? feed_ : 0.0});
    }
    if (name == "SET_FEED_RATE") {
      feed_ = unit_ * numbers[0];
      turn_feed_ = numbers[0];
      return;
    }
    if (name == "ARC_FEED") return arc(numbers);
    if (name == "USE_LENGTH_UNITS") unit_ = arguments.find("INCHES") != std::string::npos ? 25.4 : 1.0;
    program_.rounding = std::max(program_.rounding, 1.5e-4 * unit_);
    if (name == "SET_G5X_OFFSET") system_ = unit_ * Eigen::Vector3d(numbers[1], numbers[2], numbers[3]);
    if (name == "SET_G92_OFFSET") shift_ = unit_ * Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    if (name == "USE_TOOL_LENGTH_OFFSET") {
      std::istringstream offsets(arguments);
      double x = 0.0, y = 0.0, z = 0.0;
      offsets >> x >> y >> z;
      tool_ = unit_ * Eigen::Vector3d(x, y, z);
    }
    if (name == "SELECT_PLANE") {
      normal_ = arguments.find("XY") != std::string::npos ? 2 : arguments.find("XZ") != std::string::npos ? 1 : 0;
    }
    std::string call = name + "(" + arguments + ")";
    for (std::size_t at = 0; (at = call.find("-0.0000", at)) != std::string::npos;) call.erase(at, 1);
    program_.others.push_back(call);
    program_.paths.emplace_back();
  }

 private:
  struct Place {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double rotation = 0.0;
  };

  /// In the coordinate system of the first motion.
  Eigen::Vector3d place(const Eigen::Vector3d& stated) {
    if (!first_system_) first_system_ = system_;
    if (!first_tool_) first_tool_ = tool_;
    return unit_ * stated + shift_ + tool_ - *first_tool_ + system_ - *first_system_;
  }

  void move(const Place& to, CanonicalMove how = {}) {
    how.from = here_.position;
    how.to = to.position;
    how.from_rotation = here_.rotation;
    how.to_rotation = to.rotation;
    how.line = line_;
    if (how.feed > 0.0 && how.length() <= kAtRest) how.feed = turn_feed_;
    here_ = to;
    program_.paths.back().push_back(how);
  }

  void arc(const std::vector<double>& numbers) {
    CanonicalMove how;
    how.first = (normal_ + 1) % 3;
    how.second = (normal_ + 2) % 3;
    Eigen::Vector3d end, centre = Eigen::Vector3d::Zero();
    end[how.first] = numbers[0];
    end[how.second] = numbers[1];
    end[normal_] = numbers[5];
    centre[how.first] = numbers[2];
    centre[how.second] = numbers[3];
    end = place(end);
    centre = place(centre);
    how.centre = {centre[how.first], centre[how.second]};
    const Eigen::Vector2d start(here_.position[how.first] - how.centre[0], here_.position[how.second] - how.centre[1]);
    const Eigen::Vector2d stop(end[how.first] - how.centre[0], end[how.second] - how.centre[1]);
    const double turns = numbers[4], sign = turns > 0.0 ? 1.0 : -1.0;
    const double turned = sign * (std::atan2(stop[1], stop[0]) - std::atan2(start[1], start[0]));
    double once = turned - kTurn * std::floor(turned / kTurn);
    if (once < 1e-5) once += kTurn;  // four decimals are printed
    how.sweep = sign * (once + kTurn * (std::abs(turns) - 1.0));
    how.feed = feed_;
    move({end, numbers[8]}, how);
  }

  CanonicalProgram& program_;
  Place here_;
  double unit_ = 1.0;
  double feed_ = 0.0, turn_feed_ = 0.0;
  int line_ = 0;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero(), system_ = shift_, tool_ = shift_;
  std::optional<Eigen::Vector3d> first_system_ = {}, first_tool_ = {};
  int normal_ = 2;
};

}  // namespace

Eigen::Vector3d CanonicalMove::at(double t) const {
  Eigen::Vector3d place = from + t * (to - from);
  if (sweep == 0.0) return place;
  const Eigen::Vector2d start(from[first] - centre[0], from[second] - centre[1]);
  const Eigen::Vector2d stop(to[first] - centre[0], to[second] - centre[1]);
  const double radius = start.norm() + t * (stop.norm() - start.norm());
  const double angle = std::atan2(start[1], start[0]) + t * sweep;
  place[first] = centre[0] + radius * std::cos(angle);
  place[second] = centre[1] + radius * std::sin(angle);
  return place;
}

double CanonicalMove::length() const {
  if (sweep == 0.0) return (to - from).norm();
  const Eigen::Vector2d start(from[first] - centre[0], from[second] - centre[1]);
  const int normal = 3 - first - second;
  return std::hypot(sweep * start.norm(), to[normal] - from[normal]);
}

double CanonicalMove::time() const {
  if (feed == 0.0) return 0.0;
  const double along = length();
  return (along > kAtRest ? along : std::abs(to_rotation - from_rotation)) / feed;
}

double CanonicalMove::distance(const Eigen::Vector3d& point) const {
  if (sweep == 0.0) {
    const Eigen::Vector3d along = to - from;
    const double squared = along.squaredNorm();
    const double t = squared == 0.0 ? 0.0 : std::clamp((point - from).dot(along) / squared, 0.0, 1.0);
    return (point - at(t)).norm();
  }
  const double start = std::atan2(from[second] - centre[1], from[first] - centre[0]);
  const double angle = std::atan2(point[second] - centre[1], point[first] - centre[0]);
  const double sign = sweep > 0.0 ? 1.0 : -1.0;
  double nearest = std::min((point - from).norm(), (point - to).norm());
  const double turned = sign * (angle - start);
  for (double past = turned - kTurn * std::floor(turned / kTurn); past <= std::abs(sweep); past += kTurn) {
    nearest = std::min(nearest, (point - at(past / std::abs(sweep))).norm());
  }
  return nearest;
}

CanonicalProgram interpreted(const std::string& interpreter, const std::filesystem::path& folder,
                             const std::filesystem::path& path, bool counts_tools) {
  CanonicalProgram program;
  Interpreter reader(program, counts_tools);
  FILE* const pipe =
      popen(("cd '" + folder.string() + "' && HOME=. '" + interpreter + "' -g '" + path.string() + "' 2>&1 < /dev/null")
                .c_str(),
            "r");
  if (pipe == nullptr) throw std::runtime_error("rs274 does not start");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
    const std::string line(buffer.data());
    const std::size_t open = line.find('('), close = line.rfind(')');
    const std::size_t name = open == std::string::npos ? open : line.find_last_of(' ', open);
    if (name == std::string::npos || close == std::string::npos || line.find(" N") == std::string::npos) {
      if (!line.starts_with("executing")) program.complaint += line;
      continue;
    }
    const int number = std::atoi(line.c_str() + line.find(" N") + 2);  // 0 for N.....
    reader.take(number, line.substr(name + 1, open - name - 1), line.substr(open + 1, close - open - 1));
  }
  program.is_accepted = pclose(pipe) == 0;
  return program;
}

}  // namespace paracal::test

#include "scipy_fit.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace paracal::benchmark {
namespace {

nlohmann::json numbers(const Eigen::MatrixXd& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

nlohmann::json robot_as_json(const Robot& robot) {
  const SharedDimensions geometry = *shared_dimensions(robot.limbs());
  return {{"base_radius", geometry.base_radius},
          {"plate_radius", geometry.plate_radius},
          {"arm", geometry.arm},
          {"rod", geometry.rod},
          {"parallelogram_width", geometry.parallelogram_width},
          {"limb_azimuth", geometry.limb_azimuth},
          {"slide_axis", numbers(robot.slide()->axis.transpose())[0]},
          {"slide_sign", robot.slide()->sign}};
}

/// Position and slide, mm.
nlohmann::json plate_as_json(const Robot& robot, const Pose& pose) {
  const Eigen::Vector3d& position = pose.position;
  return {position.x(), position.y(), position.z(), robot.nominal().slide_of(pose.rotation)};
}

nlohmann::json fit_as_json(const FineFit& fit, double cost) {
  nlohmann::json points, commanded, joints, start;
  for (std::size_t k = 0; k < fit.points.size(); ++k) {
    points.push_back(numbers(fit.points[k].transpose())[0]);
    joints.push_back(numbers(fit.joints[k].transpose())[0]);
    commanded.push_back(plate_as_json(fit.robot, fit.measurements.stations[k].commanded));
  }
  for (std::size_t k = 0; k < kSources; ++k)
    start.push_back(fit.start(k / sources_of(Actuator::revolute).size(),
                              sources_of(Actuator::revolute)[k % sources_of(Actuator::revolute).size()]));
  return {{"points", points},
          {"joints", joints},
          {"commanded", commanded},
          {"start", start},
          {"rotation", numbers(fit.frame.rotation)},
          {"translation", numbers(fit.frame.translation.transpose())[0]},
          {"squared_residuals", cost}};
}

std::string tasks_of(const std::vector<FineFit>& fits, const std::vector<double>& costs) {
  nlohmann::json all{{"robot", robot_as_json(fits.front().robot)},
                     {"sigma", fits.front().sigma},
                     {"prior_std", numbers(fits.front().prior_std.transpose())[0]}};
  for (std::size_t k = 0; k < fits.size(); ++k) all["fits"].push_back(fit_as_json(fits[k], costs[k]));
  return all.dump();
}

}  // namespace

ScipyFits::ScipyFits(const std::vector<FineFit>& fits, const std::vector<double>& costs)
    : tasks_((std::filesystem::temp_directory_path() / fmt::format("paracal-fits-{}.json", ::getpid())).string()) {
  std::ofstream(tasks_) << tasks_of(fits, costs);
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
  process_ = ::fork();
  if (process_ == 0) {
    ::dup2(ends[1], STDIN_FILENO);
    ::dup2(ends[1], STDOUT_FILENO);
    ::setenv("OPENBLAS_NUM_THREADS", "1", 1);
    ::setenv("MKL_NUM_THREADS", "1", 1);
    ::execl("/usr/bin/python3", "python3", PARACAL_BENCHMARK_FOLDER "/calibration_opponent.py", tasks_.c_str(),
            static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(ends[1]);
  stream_ = ends[0];
  versions_ = answer();
}

ScipyFits::~ScipyFits() {
  ::close(stream_);
  ::waitpid(process_, nullptr, 0);
  std::filesystem::remove(tasks_);
}

double ScipyFits::solve(const std::string& method) {
  const std::string line = method + "\n";
  if (::write(stream_, line.data(), line.size()) < 0) return std::nan("");
  return std::strtod(answer().c_str(), nullptr);
}

std::string ScipyFits::answer() const {
  std::string line;
  for (char next = 0; ::read(stream_, &next, 1) == 1 && next != '\n';) line += next;
  return line;
}

}  // namespace paracal::benchmark

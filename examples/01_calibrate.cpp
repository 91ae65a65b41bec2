// Calibrates the robot of Huang et al. (2016) from distances measured with a laser tracker, and computes the joint
// angles with which the actual machine reaches a pose.
//
//   01_calibrate data/huang2016/distances.csv data/huang2016/poses.csv

#include <cstdio>
#include <paracal/paracal.hpp>

using namespace paracal;

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("expected: 01_calibrate DISTANCES.csv POSES.csv\n", stderr), 2;
  const Robot robot = catalogue::huang2016();
  const Measurements measured = io::read_distances(argv[1], argv[2]);
  const Calibration calibration = calibrate(robot, measured);  // verdict, parameters, covariance, null space
  std::printf("%s", calibration.brief().c_str());
  if (!calibration.accepted()) return 1;
  const Machine machine = build(robot, calibration.errors());
  const auto joints = inverse(machine, {.position = {200, -130, -930}, .rotation = 0.5}).joints;  // mm, rad
  for (const double joint : joints) std::printf("%.4f deg\n", to_degrees(joint));
}

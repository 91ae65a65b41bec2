#include "mistakes.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "calibration/readings/body.hpp"
#include "paracal/kinematics/closure.hpp"
#include "reading_mistakes.hpp"

namespace paracal::detail {
namespace {

constexpr double kTurned = 0.02;   // rad, of mounts about their mean: less shows no place
constexpr double kLeast = 0.1;     // mm: a reflector is no better centred by hand
constexpr double kFarthest = 1e3;  // mm: farther than a plate is wide

Eigen::Matrix3d mount_of(const Station& station, ReflectorMount mount) {
  return plate_rotation(station.commanded.tilt).matrix *
         Eigen::AngleAxisd(turns_per_phi(mount) * station.commanded.rotation, Eigen::Vector3d::UnitZ());
}

/// How far from the plate's centre the nominal robot puts the reflector, mm; 0 where its mount does not turn.
double distance_from_centre(const Input& given, ReflectorMount mount) {
  const std::vector<Station>& stations = given.measurements.stations;
  double farthest = 0.0;
  for (const PointSeries& series : given.measurements.series) {
    std::vector<RigidMotion> carriers;
    std::vector<Eigen::Vector3d> read;
    Eigen::Matrix3d middle = Eigen::Matrix3d::Zero();
    for (const PointReading& one : series.readings) {
      const Station& station = stations[one.station];
      carriers.push_back({mount_of(station, mount), station.commanded.position});
      read.push_back(one.point);
      middle += carriers.back().rotation / static_cast<double>(series.readings.size());
    }
    const bool turns =
        std::ranges::any_of(carriers, [&](const RigidMotion& one) { return (one.rotation - middle).norm() > kTurned; });
    if (!turns || read.size() < 4) continue;
    const bool seeks_frame = given.options.frame == Frame::unknown;
    farthest = std::max(farthest, place_reflector(carriers, read, seeks_frame).body.translation.norm());
  }
  return farthest;
}

}  // namespace

std::vector<Mistake> reflector_mistakes(const Input& given) {
  if (given.measurements.series.empty() || reads_orientation(given.measurements) || reads_second(given.measurements)) {
    return {};
  }
  std::vector<Mistake> all;
  for (const ReflectorMount mount : kReflectorMounts) {
    const double distance = distance_from_centre(given, mount);
    if (!(distance > kLeast) || distance > kFarthest) continue;
    all.push_back({MistakeKind::usual, "reflector",
                   fmt::format("the reflector is about {} mm beside {} (centre it, or read its orientation, too)",
                               distance < 10.0 ? fmt::format("{:.1f}", distance) : fmt::format("{:.0f}", distance),
                               centre_of(mount)),
                   [mount](Input& input) {
                     input.options.reflector_is_at_centre = false;
                     input.options.reflectors = mount;
                   }});
  }
  return all;
}

}  // namespace paracal::detail

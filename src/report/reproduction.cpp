#include "paracal/report/reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"

namespace paracal::report {
namespace {

/// Where the machine goes when its controller, which believes the nominal robot, is sent to a pose.
PosePair uncompensated(const Robot& robot, const Machine& machine, const Pose& commanded) {
  const InverseResult believed = inverse(robot.nominal(), commanded);
  const ForwardResult actual = forward(machine, believed.joints);
  if (!believed.ok() || !actual.ok()) throw Error("a published pose is out of reach");
  return {commanded, {actual.plate.position, machine.rotation_of(actual.plate.slide)}};
}

void add_offsets(const Calibration& calibration, const SourceErrors& published, std::vector<ReproductionRow>& rows) {
  constexpr double kTolerance = 0.04;
  for (const ParameterEstimate& parameter : calibration.parameters) {
    rows.push_back({fmt::format("offsets.limb{}", parameter.limb + 1),
                    fmt::format("encoder offset of limb {} from the six distances", parameter.limb + 1), "deg",
                    to_degrees(published(parameter.limb, parameter.source)), to_degrees(parameter.value), kTolerance});
  }
}

/// The point whose published rotation disagrees with its own distances (docs/paper-slips.md).
constexpr std::string_view kOddPoint = "P1";

void add_table3(const Robot& robot, const io::PublishedHuang2016& published, std::vector<ReproductionRow>& rows) {
  constexpr double kDistance = 0.08, kVolumetric = 0.17, kRotation = 0.45, kRotationOfOddPoint = 1.6;
  const Machine machine = build(robot, published.offsets);
  const std::vector<Station>& stations = published.rough.stations;
  const PosePair home = uncompensated(robot, machine, stations.front().commanded);
  for (const io::PublishedHuang2016::Table3Row& row : published.before) {
    const auto station = std::ranges::find(stations, row.point, &Station::name);
    const PoseError ours = error_relative_to(home, uncompensated(robot, machine, station->commanded));
    const auto add = [&](const char* symbol, const char* words, const char* unit, double paper, double value,
                         double tolerance) {
      rows.push_back({fmt::format("table3.before.{}.{}", row.point, symbol),
                      fmt::format("{} at {} from the published offsets", words, row.point), unit, paper, value,
                      tolerance});
    };
    add("d_rho", "distance error", "mm", row.error.distance, ours.distance, kDistance);
    add("d_v", "volumetric error", "mm", row.error.volumetric, ours.volumetric, kVolumetric);
    add("d_phi", "rotational error", "deg", to_degrees(row.error.rotation), to_degrees(ours.rotation),
        row.point == kOddPoint ? kRotationOfOddPoint : kRotation);
  }
}

}  // namespace

bool ReproductionRow::ok() const { return std::abs(ours - paper) <= tolerance; }

bool Reproduction::ok() const { return std::ranges::all_of(rows, &ReproductionRow::ok); }

Reproduction reproduce_huang2016(const io::PublishedHuang2016& published) {
  const Robot robot = catalogue::huang2016();
  Reproduction reproduction{calibrate(robot, published.rough), {}};
  add_offsets(reproduction.calibration, published.offsets, reproduction.rows);
  add_table3(robot, published, reproduction.rows);
  return reproduction;
}

}  // namespace paracal::report

#include "reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/fit/as_given.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/tolerance/allocation.hpp"
#include "paracal/units.hpp"
#include "reproduction_rows.hpp"

namespace paracal::report {
namespace {

using detail::Rows;
using detail::Table;

constexpr int kOfLength = 3, kOfOffset = 3, kOfRotation = 1, kOfTolerance = 2, kOfCount = 0;  // printed decimals

/// Where the machine goes when its controller, which believes the nominal robot, is sent to a pose.
PosePair uncompensated(const Robot& robot, const Machine& machine, const Pose& commanded) {
  const InverseResult believed = inverse(robot.nominal(), commanded);
  const ForwardResult actual = forward(machine, believed.joints);
  if (!believed.ok() || !actual.ok()) throw Error("no solution: a published pose is out of reach");
  return {commanded, {actual.plate.position, machine.rotation_of(actual.plate.slide)}};
}

CalibrationOptions rough() { return {.stage = Stage::rough}; }

/// What the readings leave open in each offset, rad: each distance, which is made of two positions, moved in turn.
std::vector<double> offset_allowances(const Robot& robot, const Measurements& readings, const Calibration& found) {
  std::vector<double> squares(found.parameters.size(), 0.0);
  for (std::size_t k = 0; k < readings.distances.size(); ++k) {
    Measurements moved = readings;
    moved.distances[k].distance += combined(kPositionReading, 2);
    const Calibration other = paracal::detail::calibrate_as_given(robot, moved, rough(), paracal::detail::Told::errors);
    for (std::size_t p = 0; p < other.parameters.size(); ++p) {  // those that are sought come first
      squares[p] += std::pow(other.parameters[p].value - found.parameters[p].value, 2);
    }
  }
  for (double& square : squares) square = std::sqrt(square);
  return squares;
}

void add_offsets(const Robot& robot, const io::PublishedHuang2016& published, const Calibration& found, Rows& rows) {
  Table table(rows, "Encoder offsets from the six distances of Table 3",
              "the paper used 21 distances between its points and prints six of them");
  const std::vector<double> allowances = offset_allowances(robot, published.rough, found);
  for (std::size_t k = 0; k < found.parameters.size(); ++k) {
    const ParameterEstimate& parameter = found.parameters[k];
    if (parameter.held) continue;
    const double paper = to_degrees(published.offsets(parameter.limb, parameter.source));
    const double ours = to_degrees(parameter.value);
    table.add(fmt::format("offsets.limb{}", parameter.limb + 1),
              fmt::format("encoder offset of limb {}", parameter.limb + 1), "deg", paper, ours,
              rounding(kOfOffset) + to_degrees(allowances[k]));
  }
}

/// What the published offsets alone make of the points of Table 3, in its order.
std::vector<PoseError> explained(const Robot& robot, const io::PublishedHuang2016& published) {
  const Machine machine = build(robot, published.offsets);
  const std::vector<Station>& stations = published.rough.stations;
  const PosePair home = uncompensated(robot, machine, stations.front().commanded);
  std::vector<PoseError> errors;
  for (const io::PublishedHuang2016::Table3Row& row : published.before) {
    const auto station = std::ranges::find(stations, row.point, &Station::name);
    errors.push_back(error_relative_to(home, uncompensated(robot, machine, station->commanded)));
  }
  return errors;
}

/// What print and readings allow to a length and to a rotation that are made of so many printed numbers, each the
/// difference of two readings.
double of_lengths(int numbers) { return numbers * rounding(kOfLength) + combined(kPositionReading, 2 * numbers); }
double of_rotations(int numbers) { return numbers * rounding(kOfRotation) + combined(kRotationReading, 2 * numbers); }

void add_table3(const io::PublishedHuang2016& published, const std::vector<PoseError>& offsets, Rows& rows) {
  Table table(rows, "Table 3, before: from the published offsets",
              "the machine also has other errors, which the table does not state");
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const auto& [point, paper] = published.before[k];
    const PoseError& ours = offsets[k];
    const std::string id = "table3.before." + point;
    table.add(id + ".d_rho", "distance error at " + point, "mm", paper.distance, ours.distance, of_lengths(1));
    table.add(id + ".d_v", "volumetric error at " + point, "mm", paper.volumetric, ours.volumetric, of_lengths(1));
    const double rotation = to_degrees(paper.rotation), turned = to_degrees(ours.rotation);
    table.add(id + ".d_phi", "rotational error at " + point, "deg", rotation, turned, of_rotations(1));
  }
}

/// What the offsets leave of the errors measured before, beside what was measured after they had been compensated. Of
/// the volumetric error both are lengths of vectors whose directions are not printed: their difference is the least
/// that can have been left.
void add_table3_after(const io::PublishedHuang2016& published, const std::vector<PoseError>& offsets, Rows& rows) {
  Table table(rows, "Table 3, after: remaining error after the offsets are compensated",
              "the printed errors before and after do not agree under the printed offsets");
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const auto& [point, before] = published.before[k];
    const PoseError& paper = published.after[k].error;
    const std::string id = "table3.after." + point;
    const double distance = before.distance - offsets[k].distance;
    table.add(id + ".d_rho", "remaining distance error at " + point, "mm", paper.distance, distance, of_lengths(2));
    const double least = std::abs(before.volumetric - offsets[k].volumetric);
    table.add(id + ".d_v", "remaining volumetric error at " + point + ", at least", "mm", paper.volumetric, least,
              judge_least(paper.volumetric, least, of_lengths(2)));
    const double rotation = to_degrees(paper.rotation), left = to_degrees(before.rotation - offsets[k].rotation);
    table.add(id + ".d_phi", "remaining rotational error at " + point, "deg", rotation, left, of_rotations(2));
  }
}

/// Table 2 by the paper's reading of its bound.
/// @param key  of the rows, with its title.
void add_table2(const Robot& robot, const io::PublishedHuang2016& published, Bound bound, const std::string& key,
                const std::string& title, Rows& rows) {
  Table table(rows, title, "the paper does not state the points at which it takes the maxima of Eq. (12)");
  const Tolerances tolerances = allocate(robot, EqualInfluence{.bound = bound}).tolerances;
  const std::span<const Source> tilt_group = sources_of(robot.actuator()).last(ErrorModel::kTilt);
  for (std::size_t k = 0; k < tilt_group.size(); ++k) {
    const Source source = tilt_group[k];
    const double paper = 1e3 * published.table2[k];
    const double ours = 1e3 * tolerances[source] / paper_units(robot)(place(source));
    table.add(fmt::format("{}.{}", key, name(source)), fmt::format("tolerance of {}", name(source)), "1e-3 rad", paper,
              ours, rounding(kOfTolerance));
  }
}

/// Figure 5: which errors tilt the plate most, from the first to the third.
void add_figure5(const Robot& robot, const io::PublishedHuang2016::Figures& published, Rows& rows) {
  Table table(rows, "Figure 5: which errors tilt the plate most");
  const PerSource mean = global_sensitivity(robot, {Quantity::tilt}).mean * paper_units(robot);
  const std::array<Source, 3>& most = published.most_tilting;
  for (std::size_t k = 0; k < most.size(); ++k) {
    const auto paper = static_cast<double>(k + 1);
    const double ours = 1.0 + static_cast<double>((mean > mean(place(most[k]))).count());
    table.add(fmt::format("figure5.{}", name(most[k])), fmt::format("rank of {}", name(most[k])), "1", paper, ours,
              rounding(kOfCount));
  }
}

/// Figure 6: the bottom layer tilts most on its rim, and the workspace in its bottom layer. Places are told to half of
/// the steps between the circles and layers that were measured.
void add_figure6(const Robot& robot, const io::PublishedHuang2016::Figures& published, Rows& rows) {
  constexpr int kRadii = 5, kLayers = 3;
  Table table(rows, "Figure 6: where 3 sigma of the tilt is largest, as designed",
              "relative to home, as in the paper, the bottom is worse (row tilt.bottom)");
  const Workspace& workspace = robot.workspace();
  std::vector<ValueAtPose> map = sigma_map(robot, {Quantity::tilt}, *robot.tolerances(),
                                           {.radii = kRadii, .azimuths = 8, .layers = kLayers}, false);
  const double bottom = workspace.top_z - workspace.height, rim = workspace.radius;
  const double depth = std::ranges::max_element(map, {}, &ValueAtPose::value)->pose.position.z();
  std::erase_if(map, [&](const ValueAtPose& point) { return point.pose.position.z() != bottom; });
  const ValueAtPose& worst = *std::ranges::max_element(map, {}, &ValueAtPose::value);
  const double radius = worst.pose.position.head<2>().norm();
  table.add("figure6.radius", "radius in the bottom layer", "mm", published.radius, radius, 0.5 * rim / kRadii);
  table.add("figure6.depth", "depth of all layers", "mm", published.depth, depth,
            0.5 * workspace.height / (kLayers - 1));
}

/// Figures 7 and 8: where O2 settles to 1 %.
void add_observability(const Robot& robot, const io::PublishedHuang2016::Figures& published, Rows& rows) {
  const auto add = [&](const char* id, const char* words, Stage stage, int points) {
    Table table(rows, words);
    const auto ours = static_cast<double>(paper_plan(robot, stage).n), paper = static_cast<double>(points);
    table.add(id, "points per circle", "points", paper, ours, rounding(kOfCount));
  };
  add("figure7.n", "Figure 7: rough calibration", Stage::rough, published.rough_points);
  add("figure8.n", "Figure 8: fine calibration", Stage::fine, published.fine_points);
}

}  // namespace

std::size_t Reproduction::count(Finding finding) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows, [&](const ReproductionRow& row) { return row.judgement.finding == finding; }));
}

Reproduction reproduce_huang2016(const io::PublishedHuang2016& published, unsigned threads) {
  const Robot robot = catalogue::huang2016();
  Reproduction reproduction{calibrate(robot, published.rough, rough()), {}};
  Rows& rows = reproduction.rows;
  const std::vector<PoseError> offsets = explained(robot, published);
  add_table2(robot, published, Bound::sum_of_maxima, "table2", "Table 2: tolerances (3 sigma), means over a grid",
             rows);
  add_table2(robot, published, Bound::sum_by_volume, "volume.table2",
             "Table 2: tolerances (3 sigma), by the paper's volume integral", rows);
  add_offsets(robot, published, reproduction.calibration, rows);
  add_table3(published, offsets, rows);
  add_table3_after(published, offsets, rows);
  add_figure5(robot, published.figures, rows);
  add_figure6(robot, published.figures, rows);
  add_observability(robot, published.figures, rows);
  detail::add_twins(robot, published, threads, rows);
  return reproduction;
}

}  // namespace paracal::report

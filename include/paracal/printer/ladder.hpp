#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// How much of its firmware's values an owner changes. Each rung holds those below it.
enum class Rung : std::uint8_t {
  saved,   ///< nothing
  height,  ///< the endstops, and of rotary deltas the height of the shoulders
  radius,  ///< and the delta radius
  towers,  ///< and the angles of towers A and B
  rods,    ///< and the lengths of the rods, and of rotary deltas of the arms
};

/// "saved", "height", "radius", "towers", "rods".
std::string_view name(Rung rung);

/// Standard deviations of printers and of what is read on them, the same for all printers.
struct LadderPriors {
  double endstop = 3.0;    ///< from the saved one, mm; also of the shoulders
  double radius = 0.5;     ///< likewise, mm
  double tower = 0.2;      ///< likewise, deg; with distances from the design angle
  double alike = 0.1;      ///< of a rod from the mean of the three, mm
  double length = 0.5;     ///< of that mean from the saved one, mm: as an owner types it
  double measured = 5.0;   ///< the same where distances determine it, mm
  double bow = 0.12;       ///< edge of the bed above its centre, mm: bent glass, uneven heat
  double wave = 0.01;      ///< of each further shape of the bed, mm: such shapes make neighbours err alike
  double bias = 0.2;       ///< of all distances, mm: walls too thick, zero of the calliper
  double height = 0.03;    ///< of a height, mm, before the readings show it: probe and unevenness of the bed
  double distance = 0.08;  ///< of a distance, mm, likewise
};

/// What is asked of a rung before it is advised, and of readings before they count.
struct LadderRules {
  double certain = 0.95;         ///< probability that the first layer is better
  double size = 5e-4;            ///< relative change of the size of prints that nobody notices
  double level = 0.15;           ///< first layer that cannot be printed, mm rms: the radius then follows the heights
  double safe = 0.9;             ///< probability that the nozzle is nowhere deeper than
  double deepest = 0.2;          ///< nozzle below the bed, mm: the thickness of a first layer
  double of_saved = 0.1;         ///< or this part of the depth with the saved values
  double gross = 6.0;            ///< standard deviations of a reading that is excluded,
  double gross_height = 0.4;     ///< at least, mm
  double gross_distance = 0.5;   ///< at least, mm
  double least_height = 0.02;    ///< standard deviation of a height: no probe is better, mm
  double least_distance = 0.05;  ///< of a distance: no calliper on a print is better, mm
};

struct LadderOptions {
  LadderPriors priors = {};
  LadderRules rules = {};
  double print_radius = 0.0;  ///< of the printable disk, mm
};

/// A figure with its 95 % interval.
struct LadderFigure {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// Values for the firmware, and what the readings say of them.
struct RungValues {
  Rung rung = Rung::saved;
  DeltaGeometry geometry;
  LadderFigure first_layer;          ///< height of the nozzle above the bed at z = 0, mm rms over the printable disk
  LadderFigure size;                 ///< relative error of the size of prints
  double chance = 0.0;               ///< that the first layer is better than with the saved values
  double chance_size = 0.0;          ///< that the size is worse than with them, by more than nobody notices
  std::vector<double> heights = {};  ///< of the nozzle above the bed over printable_disk(), expected, mm
  double depth = 0.0;                ///< of the nozzle below the bed at z = 0, mm: largest over the disk, 90 %
  bool holds_radius = false;         ///< the radius changes only as far as the size of prints is not worse
  bool is_allowed = false;           ///< every condition is met
};

/// Readings by number among those of their kind.
struct ReadingNumbers {
  std::vector<std::size_t> heights = {}, distances = {};
};

struct Ladder {
  std::vector<RungValues> rungs = {};               ///< from the saved values up
  std::size_t advised = 0;                          ///< among them
  double noise_height = 0.0, noise_distance = 0.0;  ///< standard deviations as the readings show them, mm
  ReadingNumbers gross = {};                        ///< excluded
  ReadingNumbers unchecked = {};                    ///< no other reading would show them to be gross

  const RungValues& saved() const { return rungs.front(); }
  const RungValues& best() const { return rungs.at(advised); }
};

/// The ladder of a printer. Each rung is the fit of its own numbers, the rest as saved:
///
///   \f[ min_x sum rho(residual / noise) + sum rho((x - prior) / std),    rho(u) = 18 (\sqrt{1 + u^2 / 9} - 1) \f]
///
/// The figures are those of the machine by the widest fit: all numbers within their priors, with bow and waves of the
/// bed and a bias of the distances. Advised is the highest rung that is allowed: its first layer is better than with
/// the saved values with probability 95 %, and not worse than on the rung below; its size is not worse by more than
/// nobody notices, with the same probability; and the nozzle at z = 0 is nowhere more than 0.2 mm below the bed.
///
/// From heights alone the rods stay. A bowed bed looks like another radius, so the radius then goes only as far as the
/// size of prints is not worse, unless the heights cannot be levelled without it.
/// @returns empty where the saved values do not close at the readings.
std::optional<Ladder> ladder(const DeltaGeometry& saved, const DeltaReadings& readings, const LadderOptions& options);

/// The fit of one rung, without what judges it. Empty where the saved values do not close at the readings.
std::optional<DeltaGeometry> fit_rung(const DeltaGeometry& saved, const DeltaReadings& readings, Rung rung,
                                      const LadderPriors& priors = {});

/// The readings without some of them.
DeltaReadings without(const DeltaReadings& readings, const ReadingNumbers& numbers);

/// Places of the printable disk at z = 0, centre first.
std::vector<Eigen::Vector3d> printable_disk(double radius);

}  // namespace paracal

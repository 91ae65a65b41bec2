#pragma once

// Private to calibration: what a kind of length is. One file a kind; adding one is another of these, its place in
// LengthKind and a line in length_kinds.cpp.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/length_kind.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/numerics/information_root.hpp"

namespace paracal::detail {

/// The unknowns of a set-up, without room on the heap.
using SetUp = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;
/// A length that an instrument shows of a plate centre, mm, and how it changes.
struct LengthShown {
  double length = 0.0;
  Eigen::RowVector3d by_place;                                                ///< of the plate centre
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 4> by_set_up;  ///< of the set-up's unknowns
};

/// Plate centres and the lengths read there.
struct LengthsRead {
  std::vector<Eigen::Vector3d> places;  ///< mm
  std::vector<double> lengths;          ///< mm
};

/// A set-up to begin from, and what had to be assumed for it; empty: nothing.
struct StartedSetUp {
  SetUp unknowns;
  std::string assumed = {};
};

/// A kind of length: what it shows of a place, and what of its set-up has to be found.
class LengthModel {
 public:
  LengthModel() = default;
  LengthModel(const LengthModel&) = delete;
  LengthModel& operator=(const LengthModel&) = delete;
  virtual ~LengthModel() = default;

  virtual LengthWords words() const = 0;
  /// Long enough to show the scale of the instrument.
  virtual bool shows_scale() const = 0;

  /// What set-ups may look like, each unknown's size: beside readings of hundredths of a mm these say little.
  virtual SetUp units(const CalibrationOptions& options) const = 0;
  /// As many as units() has.
  virtual LengthShown shown(const Eigen::Vector3d& place, const SetUp& set_up, const LengthSeries& series) const = 0;
  /// The set-up that fits best, in spite of some gross readings.
  virtual StartedSetUp start(const LengthsRead& read, const LengthSeries& series,
                             const CalibrationOptions& options) const = 0;
  /// What is known beforehand of the unknowns, which stand from `first` on, as rows.
  virtual void add_priors(const Eigen::VectorXd& unknowns, Eigen::Index first, const CalibrationOptions& options,
                          InformationRoot& root) const = 0;
  /// What was found, in the names and units of files.
  virtual std::vector<std::pair<std::string_view, double>> told(const SetUp& set_up,
                                                                const LengthSeries& series) const = 0;

  /// A set-up to plan for, and any that an instrument may have.
  virtual SetUp typical(const Robot& robot, const LengthSeries& series) const = 0;
  virtual SetUp random(const Robot& robot, const LengthSeries& series, RandomStream& random) const = 0;
};

const LengthModel& length_model(LengthKind kind);

// The kinds, each in the file of its name.
const LengthModel& heights();
const LengthModel& ball_bar();
const LengthModel& dial();

}  // namespace paracal::detail

#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/json.hpp"

namespace paracal::app {

/// Tables of readings, and what they do not say of themselves.
struct MeasuringOptions {
  std::vector<std::string> files;
  std::vector<std::string> poses;  ///< one table for all files that name poses, or one for each of them in their order
  std::string columns, unit, match = "name";
  io::TableStyle style;
  double expansion_ppm = 11.5, instrument_expansion_ppm = 0.0;
  std::optional<double> temperature_c;

  /// Files that may say which robot they are of.
  std::vector<std::string> tables() const;
  /// Every file by what its header says it is, all in one.
  Measurements read(const Robot& robot) const;
  /// What is known of lengths read against lengths of the machine at 20 deg C, m/m.
  double expansion() const;
};

/// @returns --measurements, which is required unless its taker says otherwise.
Option* add_measuring_options(Command& command, MeasuringOptions& options);

/// What commands that plan readings ask for.
struct PlanningOptions {
  PlannedReadings readings;
  std::vector<double> at;
  std::string rotation = "none";
  bool reads_rotation = false;  ///< as --rotation was asked for before

  RotationZero rotation_zero() const { return rotation == "absolute" ? RotationZero::known : RotationZero::unknown; }
  /// @throws WrongUsage for a second reflector or a rotation of what has none, and for --at where it says nothing or is
  /// missing.
  PlannedReadings planned() const;
};

/// --reflectors: what the second reflector, or a body, is mounted on.
Option* add_mount_option(Command& command, ReflectorMount& mount);

/// --measure, --at and --reflectors: what is measured at the poses of a plan.
/// @returns all.
std::array<Option*, 3> add_planning_options(Command& command, PlanningOptions& options);

/// --rotation: whether phi is read, and from which of these zeros.
/// @returns it, and --read-rotation, which --help does not show.
std::array<Option*, 2> add_rotation_options(Command& command, PlanningOptions& options,
                                            const std::vector<std::string>& zeros);

/// The instrument of commands that measure virtual machines.
struct InstrumentOptions {
  double noise_mm = 0.0, repeatability_mm = 0.0, rotation_noise_deg = 0.0;
  std::vector<double> tracker_um = {};
  int repeats = 1;
  std::vector<double> second = {};

  /// @throws WrongUsage for numbers that no instrument has.
  VirtualInstrument instrument(bool reads_rotation) const;
};

/// --noise-mm, --tracker-um, --repeatability-mm, --repeats, --rotation-noise-deg, --second, with the values of
/// `options` as defaults.
void add_instrument_options(Command& command, InstrumentOptions& options);

/// O1 ... O5.
void add_indices(io::Json& json, const Observability& indices);

/// Standard deviations over the workspace.
io::Json workspace_json(const WorkspaceUncertainty& spread);

/// Half-widths (TOML) that are to be priors.
/// @throws InputFileError where all are zero: there is then nothing that a fit could seek.
Tolerances read_priors(const io::TextFile& file, const Robot& robot);

/// A line each; tables take `mark` "#".
std::string assumed_lines(const std::vector<std::string>& assumed, std::string_view mark = " ");

}  // namespace paracal::app

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/tolerances.hpp"

namespace paracal {

/// Errors of a delivered machine: the largest over the validation poses (home first).
enum class ErrorKind : std::uint8_t {
  distance,            ///< |d_rho|, mm
  volumetric,          ///< d_v, mm
  volumetric_aligned,  ///< |dr| after the rigid motion that fits best has been removed, mm
  rotation,            ///< |d_phi|, or rotation from home with six degrees of freedom, rad; 0 for a rigid plate
  tilt,                ///< sqrt(tilt_x^2 + tilt_y^2) of the plate relative to the commanded tilt, rad
};

inline constexpr std::array kErrorKinds{ErrorKind::distance, ErrorKind::volumetric, ErrorKind::volumetric_aligned,
                                        ErrorKind::rotation, ErrorKind::tilt};

/// "distance", "volumetric", "volumetric_aligned", "rotation", "tilt".
std::string_view name(ErrorKind kind);

/// Millimetres or radians.
Unit unit(ErrorKind kind);

/// One value for each kind.
template <typename Value>
class PerErrorKind {
 public:
  Value& operator[](ErrorKind kind) { return values_[static_cast<std::size_t>(kind)]; }
  const Value& operator[](ErrorKind kind) const { return values_[static_cast<std::size_t>(kind)]; }
  bool operator==(const PerErrorKind&) const = default;

 private:
  std::array<Value, kErrorKinds.size()> values_{};
};

/// Largest errors of one machine, mm and rad.
using Accuracy = PerErrorKind<double>;

/// Production, measurement, calibration and validation of one machine of a batch.
struct ProductionPlan {
  Tolerances tolerances = {};           ///< of its parts
  std::vector<Station> stations = {};   ///< to measure; home first
  CalibrationOptions calibration = {};  ///< as the metrologist sets them
  VirtualInstrument instrument = {};
  std::vector<Station> validation = {};             ///< commanded poses, home first
  PerErrorKind<std::optional<double>> limits = {};  ///< of the errors after calibration, mm and rad; empty: none
};

/// Usual standard deviation of a coordinate: a third of the positioning repeatability in
/// [huang2016, section 5.2], mm.
inline constexpr double kUsualNoise = 0.017;

/// Whether ErrorKind::rotation applies to a robot.
bool turns(const Robot& robot);

/// The largest error divided by its limit; 0 without limits. A machine passes up to 1.
double used_up(const Accuracy& accuracy, const PerErrorKind<std::optional<double>>& limits);

/// Whether there are limits.
bool has_limits(const ProductionPlan& plan);

/// The paper's scheme: home and nine points on each of two rims measured with kUsualNoise, 120 poses to validate; the
/// tolerances are also the priors. Plates with six degrees of freedom: full poses at 30 stations from
/// select_stations(), and validation poses with all tilts (workspace_stations).
ProductionPlan paper_production(const Robot& robot, const Tolerances& tolerances);

/// The plan with its automatic choices, once for all machines: the kinds of readings determine the stage.
/// @throws Unreachable if the nominal robot cannot reach a station, InvalidArgument for invalid measurements or a plan
/// without stations to measure and to validate.
ProductionPlan settled(const Robot& robot, ProductionPlan plan);

/// Result for a machine.
enum class Fate : std::uint8_t {
  accepted,          ///< calibrated; its controller is compensated
  rejected,          ///< as Verdict; the controller stays nominal
  not_identifiable,  ///< likewise
  not_converged,     ///< likewise, or the numbers are out of range
  does_not_close,    ///< a pose is out of reach, before or after calibration: scrap
};

inline constexpr std::array kFates{Fate::accepted, Fate::rejected, Fate::not_identifiable, Fate::not_converged,
                                   Fate::does_not_close};

/// The enumerator as it is spelled.
std::string_view name(Fate fate);

struct [[nodiscard]] MachineOutcome {
  Fate fate = Fate::does_not_close;
  bool passes = false;  ///< keeps all limits; without limits: accepted
  Accuracy before;      ///< with a nominal controller; zero for scrap
  Accuracy after;       ///< with the controller that is delivered; zero for scrap

  bool operator==(const MachineOutcome&) const = default;
};

/// One simulated machine from tolerances to delivery: errors, measurements, calibration, compensated controller,
/// validation. Compensation is exact:
///
///   q = inverse(build(robot, identified errors), commanded pose),   pose taken = forward(build(robot, errors), q)
///
/// Everything random comes from stream `machine` of `seed`, so a machine does not depend on any other. Numerical
/// failures give a fate, not an exception.
/// @param plan  settled().
MachineOutcome produce(const Robot& robot, const ProductionPlan& plan, std::uint64_t seed, std::uint64_t machine);

}  // namespace paracal

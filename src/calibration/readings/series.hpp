#pragma once

// Private to calibration: what a fit knows of a kind of reading. One file a kind; adding one is another of these and a
// line in series.cpp.

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinematics/joint_gaps.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/closure.hpp"
#include "paracal/numerics/information_root.hpp"

namespace paracal::detail {

/// A reading's rows by the plate's motion at its station: rows x 7.
using ByPlate = Eigen::Matrix<double, Eigen::Dynamic, 7, 0, 7, 7>;

/// How the plate moves at one station.
struct StationMotions {
  PlateMotions jacobian;  ///< by the sought sources
  PlateMotions by_joint;  ///< by the joint coordinates: when a joint stands elsewhere than believed
  Eigen::MatrixXd gaps = {}, gaps_by_joint = {};  ///< how gaps of the joints open, by the same
};

/// Where the machine stands at one station, and how that changes.
struct StationState {
  PlateState plate;
  double rotation = 0.0;                           ///< phi, rad
  const DifferentiableMachine* machine = nullptr;  ///< which stands there, of the same answer
  Eigen::Vector3d derived_at = {};  ///< where the plate centre was when the motions were taken: here, or at the
                                    ///< nominal machine
  JointGaps gaps = {};              ///< only where joints are readings
  std::optional<StationMotions> motions = {};  ///< empty where there are too many stations to keep them all
};

/// The machine at every station, and the unknowns of the fit with which it stands there.
struct Placed {
  const std::vector<StationState>& stations;
  const Eigen::VectorXd& unknowns;
};

/// One reading of a series (small: half a million distances are no rarity) and what a fit makes of it.
struct Group {
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  double weight = 1.0;            ///< of its squared residuals, while a robust loss seeks gross errors
  std::uint32_t series = 0;       ///< place among all series
  std::uint32_t index = 0;        ///< into the series' readings
  std::uint32_t station = 0;      ///< where it was taken
  std::uint32_t from = kNowhere;  ///< the station that it is relative to, where it is
  bool stated = false;            ///< its standard deviation is known; its factor is that of stated noise
  bool active = true;             ///< takes part in the fit
  bool at_wrong_pose = false;     ///< left out with all readings of its pose

  /// Two stations have a share in it.
  bool is_relative() const { return from != kNowhere; }
};

/// What a standard deviation is of.
enum class Quantity : std::uint8_t { coordinate, distance, length, gap };

/// Predicted minus measured, unless said otherwise.
struct Residual {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> length;  ///< mm, one number or three
  std::optional<double> rotation = {};                       ///< rad
  std::optional<Eigen::Vector3d> orientation = {};           ///< rotation vector, rad

  /// Root mean square of a row, mm.
  double size() const { return length.norm() / std::sqrt(static_cast<double>(length.size())); }
  /// Measured minus predicted.
  Residual reversed() const {
    Residual other{-length, rotation, orientation};
    if (rotation) other.rotation = -*rotation;
    if (orientation) other.orientation = -*orientation;
    return other;
  }
};

/// All unknowns of a fit: the set-up, then the errors.
struct FoundUnknowns {
  const Eigen::VectorXd& values;
  const Eigen::MatrixXd& covariance;  ///< U = 2 std whatever the degrees of freedom; empty where none could be stated
  Eigen::Index errors = 0;            ///< how many of them are errors
};

/// Errors of the readings in use, as they come together over all series.
struct ErrorTally {
  /// Of squares, mm^2.
  struct Sum {
    double squares = 0.0;
    std::size_t count = 0;

    void add(double off) {
      squares += std::pow(off, 2);
      ++count;
    }
    double root_mean_square() const { return std::sqrt(squares / static_cast<double>(count)); }
  };

  PoseErrorSummary summary = {};  ///< largest ones so far
  Sum distances, joints;
  std::map<LengthKind, Sum> lengths;

  void widen_rotation(const std::optional<double>& residual);
  void widen_orientation(const std::optional<Eigen::Vector3d>& residual);
  /// With the root mean squares of all.
  PoseErrorSummary finished() const;
};

/// The readings of one kind from one set-up, and what of that set-up is sought with the source errors: everything that
/// a fit, its evidence and its messages know of the kind.
class ReadingSeries {
 public:
  explicit ReadingSeries(std::string name) : name_(std::move(name)) {}
  virtual ~ReadingSeries() = default;
  virtual std::unique_ptr<ReadingSeries> copy() const = 0;

  const std::string& name() const { return name_; }
  virtual std::size_t size() const = 0;
  /// Where a reading was taken, relative to what, and whether it states its standard deviation.
  virtual Group group(std::size_t index) const = 0;
  /// Standard deviation before any factor, mm; of a coordinate, as a mean over the three.
  virtual double sigma(std::size_t index) const = 0;
  /// The same of an orientation about each axis, rad; 0 where none was read.
  virtual double orientation_sigma(std::size_t /*index*/) const { return 0.0; }
  virtual Quantity quantity() const = 0;
  /// Where its readings are lengths: of which kind.
  virtual std::optional<LengthKind> length_kind() const { return std::nullopt; }

  /// Takes columns of the unknowns for its set-up, from `next` on.
  virtual void take_columns(Eigen::Index& /*next*/, bool /*seeks_scale*/) {}
  /// Sets them to what fits best at these stations; else they start from zero.
  virtual void start(const std::vector<StationState>& /*stations*/, Eigen::VectorXd& /*unknowns*/) {}
  /// Those that shift its readings and do nothing else.
  virtual std::vector<Eigen::Index> zero_columns() const { return {}; }
  /// What is known of them beforehand, as rows.
  virtual void add_priors(const Eigen::VectorXd& /*unknowns*/, InformationRoot& /*root*/) const {}
  /// Sets how large their unknowns may be where they have a size of their own.
  virtual void set_units(Eigen::VectorXd& /*unit*/) const {}
  /// Column of the instrument's scale; -1 where it is not sought.
  Eigen::Index scale_column() const { return scale_; }

  /// Sets the set-up's columns and the residual (the last) of `block`, rows x (unknowns + 1), divided by the standard
  /// deviations.
  /// @returns the derivative by the plate's motion at the reading's station, less that at what it is relative to.
  virtual ByPlate rows(std::size_t index, const Placed& at, Eigen::MatrixXd& block) const = 0;
  virtual Residual residual(std::size_t index, const Placed& at) const = 0;
  /// Its rows follow the gaps of the joints at its station, and not the plate: what rows() returns is by these.
  virtual bool follows_gaps() const { return false; }
  /// How many of a reading's rows, from the fourth on, are of an orientation.
  virtual Eigen::Index orientation_rows(std::size_t /*index*/) const { return 0; }
  /// How many of them, the last ones, are of a rotation.
  virtual Eigen::Index rotation_rows(std::size_t /*index*/) const { return 0; }

  /// What it is called in notes.
  virtual std::string label(std::size_t index, const std::vector<Station>& stations) const = 0;
  /// What may have happened to a reading that was left out; empty where nothing explains it.
  virtual std::string explanation(std::size_t /*index*/, const Placed& /*at*/,
                                  const std::vector<Station>& /*stations*/) const {
    return {};
  }
  /// start() finds the set-up in spite of gross readings, which then lie far off before any fit.
  virtual bool shows_gross_at_start() const { return false; }
  /// @param of_series  the groups of its readings; those in use count.
  virtual void add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const = 0;
  /// Lists a reading with its residuals, measured minus predicted, at the nominal and the calibrated machine.
  virtual void list(const Group& /*group*/, const std::vector<Station>& /*stations*/, const Residual& /*before*/,
                    const Residual& /*after*/, FitResiduals& /*all*/) const {}
  /// Adds what was found of the set-up, and what had to be assumed of it.
  virtual void add_set_up(const FoundUnknowns& /*found*/, FoundSetUps& /*all*/, Remarks& /*remarks*/) const {}

 protected:
  double scale(const Eigen::VectorXd& unknowns) const { return scale_ < 0 ? 1.0 : 1.0 + unknowns(scale_); }
  ReadingSeries(const ReadingSeries&) = default;
  ReadingSeries& operator=(const ReadingSeries&) = default;
  static Eigen::Index take(Eigen::Index& next, Eigen::Index count) { return std::exchange(next, next + count); }

  Eigen::Index scale_ = -1;

 private:
  std::string name_;
};

/// All series of the measurements: points, distances, lengths. They refer to both arguments.
std::vector<std::unique_ptr<ReadingSeries>> all_series(const Measurements& measurements,
                                                       const CalibrationOptions& options);

}  // namespace paracal::detail

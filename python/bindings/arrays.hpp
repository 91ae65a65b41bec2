#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <limits>
#include <string_view>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::python {

namespace py = pybind11;

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Doubles, row after row, as paracal/_arrays.py makes them of what a user has.
using Array = py::array_t<double, py::array::c_style>;
using Codes = py::array_t<std::uint8_t, py::array::c_style>;

/// A table of numbers as its owner in Python holds it; read while the interpreter does other things.
class Rows {
 public:
  /// @throws InvalidArgument unless the array is (n, columns).
  Rows(const Array& array, std::string_view what, std::size_t columns);

  std::size_t count() const { return count_; }
  const double* operator[](std::size_t row) const { return numbers_ + row * columns_; }

 private:
  const double* numbers_;
  std::size_t count_, columns_;
};

/// How many numbers a pose has: x, y, z in mm, phi in rad; of a plate with six freedoms x, y, z in mm, tilt_x, tilt_y,
/// tilt_z in rad.
inline constexpr std::size_t kLevelPose = 4, kTiltedPose = 6;
std::size_t pose_width(const Robot& robot);

/// @param width  kLevelPose or kTiltedPose.
Pose pose_of(const double* row, std::size_t width);
void write_pose(const Pose& pose, double* row, std::size_t width);
Array array_of(const Pose& pose, const Robot& robot);
Joints joints_of(const double* row, std::size_t count);

/// (names, (n, width)) of commanded poses.
/// @param robot  that they are of; none: tilted ones are of a plate with six freedoms.
/// @throws InvalidArgument for a pose that such a plate does not take.
py::tuple named_poses(const std::vector<Station>& stations, const Robot* robot);

/// (limbs, sources), mm, rad and mm/m; columns as sources_of(geometry); zero where a limb has no such error.
SourceErrors errors_of(const Array& array, const Robot& robot);
Array array_of(const SourceErrors& errors, const Robot& robot);
/// The numbers of a robot's own sources out of those of all places.
Array vector_of_sources(const Eigen::Ref<const Eigen::ArrayXd>& numbers, const Robot& robot);

/// Unit of what stands in arrays: "mm", "rad", "mm/m".
std::string array_unit(Unit unit);

Array array_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
Array vector_of(const Eigen::Ref<const Eigen::VectorXd>& vector);
Array vector_of(const std::vector<double>& numbers);

/// Names of files may hold bytes that are no UTF-8; Python keeps them as its file names do.
py::str text_of(std::string_view text);
py::list texts_of(const std::vector<std::string>& texts);

}  // namespace paracal::python

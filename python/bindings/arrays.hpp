#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <limits>
#include <string_view>
#include <vector>

#include "paracal/mechanism/pose.hpp"
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

/// (n, 4): x, y, z in mm, phi in rad.
Pose pose_of(const double* row);
void write_pose(const Pose& pose, double* row);
Joints joints_of(const double* row, std::size_t count);

/// (limbs, 14), mm and rad.
SourceErrors errors_of(const Array& array, std::size_t limb_count);
Array array_of(const SourceErrors& errors, std::size_t limb_count);

Array array_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
Array vector_of(const Eigen::Ref<const Eigen::VectorXd>& vector);
Array vector_of(const std::vector<double>& numbers);

/// Names of files may hold bytes that are no UTF-8; Python keeps them as its file names do.
py::str text_of(std::string_view text);
py::list texts_of(const std::vector<std::string>& texts);

}  // namespace paracal::python

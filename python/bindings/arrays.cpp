#include "arrays.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "paracal/error.hpp"

namespace paracal::python {

Rows::Rows(const Array& array, std::string_view what, std::size_t columns)
    : numbers_(array.data()), count_(0), columns_(columns) {
  if (array.ndim() != 2 || static_cast<std::size_t>(array.shape(1)) != columns) {
    std::string shape;
    for (py::ssize_t k = 0; k < array.ndim(); ++k) shape += fmt::format("{}{}", k == 0 ? "" : ", ", array.shape(k));
    throw InvalidArgument(fmt::format("{}: expected an array of shape (n, {}), got ({})", what, columns, shape));
  }
  count_ = static_cast<std::size_t>(array.shape(0));
}

Pose pose_of(const double* row) { return {{row[0], row[1], row[2]}, row[3]}; }

void write_pose(const Pose& pose, double* row) {
  std::ranges::copy(pose.position, row);
  row[3] = pose.rotation;
}

Joints joints_of(const double* row, std::size_t count) {
  return Eigen::Map<const Eigen::VectorXd>(row, static_cast<Eigen::Index>(count));
}

SourceErrors errors_of(const Array& array, std::size_t limb_count) {
  const Rows rows(array, "errors", kSourceCount);
  if (rows.count() != limb_count) {
    throw InvalidArgument(
        fmt::format("errors: expected a row a limb, ({}, {}), got {} rows", limb_count, kSourceCount, rows.count()));
  }
  SourceErrors errors;
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : all_sources()) errors(limb, source) = rows[limb][index(source)];
  }
  return errors;
}

Array array_of(const SourceErrors& errors, std::size_t limb_count) {
  Array array({limb_count, kSourceCount});
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : all_sources()) array.mutable_at(limb, index(source)) = errors(limb, source);
  }
  return array;
}

Array array_of(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Array array({matrix.rows(), matrix.cols()});
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
  return array;
}

Array vector_of(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  Array array(vector.size());
  std::ranges::copy(vector, array.mutable_data());
  return array;
}

Array vector_of(const std::vector<double>& numbers) {
  return vector_of(Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size())));
}

py::str text_of(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeFSDefaultAndSize(text.data(), static_cast<py::ssize_t>(text.size())));
}

py::list texts_of(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) list.append(text_of(text));
  return list;
}

}  // namespace paracal::python

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

std::size_t pose_width(const Robot& robot) { return robot.commands_tilt() ? kTiltedPose : kLevelPose; }

Pose pose_of(const double* row, std::size_t width) {
  Pose pose{{row[0], row[1], row[2]}};
  if (width == kLevelPose) {
    pose.rotation = row[3];
  } else {
    pose.tilt = {row[3], row[4], row[5]};
  }
  return pose;
}

void write_pose(const Pose& pose, double* row, std::size_t width) {
  row = std::ranges::copy(pose.position, row).out;
  if (width == kLevelPose) {
    *row = pose.rotation;
  } else {
    std::ranges::copy(pose.tilt, row);
  }
}

Array array_of(const Pose& pose, const Robot& robot) {
  Array array(static_cast<py::ssize_t>(pose_width(robot)));
  write_pose(pose, array.mutable_data(), pose_width(robot));
  return array;
}

Joints joints_of(const double* row, std::size_t count) {
  return Eigen::Map<const Eigen::VectorXd>(row, static_cast<Eigen::Index>(count));
}

namespace {

bool is_tilted(const Station& station) { return !station.commanded.tilt.isZero(0.0); }

/// A row would drop what such a plate does not have.
void check_row(const Station& station, std::size_t width) {
  if (width == kLevelPose && is_tilted(station)) {
    throw InvalidArgument(fmt::format("pose {}: expected no tilt, because the plate stays level", station.name));
  }
  if (width == kTiltedPose && station.commanded.rotation != 0.0) {
    throw InvalidArgument(fmt::format("pose {}: expected phi = 0, because tilt_z rotates the plate", station.name));
  }
}

}  // namespace

py::tuple named_poses(const std::vector<Station>& stations, const Robot* robot) {
  const std::size_t unsaid = std::ranges::any_of(stations, is_tilted) ? kTiltedPose : kLevelPose;
  const std::size_t width = robot != nullptr ? pose_width(*robot) : unsaid;
  py::list names;
  Array poses({stations.size(), width});
  double* row = poses.mutable_data();
  for (const Station& station : stations) {
    check_row(station, width);
    names.append(text_of(station.name));
    write_pose(station.commanded, row, width);
    row += width;
  }
  return py::make_tuple(names, poses);
}

SourceErrors errors_of(const Array& array, const Robot& robot) {
  const auto sources = sources_of(robot.limbs());
  const Rows rows(array, "errors", sources.size());
  if (rows.count() != robot.limb_count()) {
    throw InvalidArgument(fmt::format("errors: expected one row per limb, ({}, {}), got {} rows", robot.limb_count(),
                                      sources.size(), rows.count()));
  }
  SourceErrors errors;
  for (std::size_t limb = 0; limb < rows.count(); ++limb) {
    for (std::size_t k = 0; k < sources.size(); ++k) {
      errors(limb, sources[k]) = rows[limb][k];
      if (rows[limb][k] != 0.0) static_cast<void>(robot.parameter(limb, sources[k]));  // refused where there is none
    }
  }
  return errors;
}

Array array_of(const SourceErrors& errors, const Robot& robot) {
  const auto sources = sources_of(robot.limbs());
  Array array({robot.limb_count(), sources.size()});
  double* to = array.mutable_data();
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources) *to++ = errors(limb, source);
  }
  return array;
}

Array vector_of_sources(const Eigen::Ref<const Eigen::ArrayXd>& numbers, const Robot& robot) {
  std::vector<double> own;
  for (const Source source : sources_of(robot.limbs()))
    own.push_back(numbers(static_cast<Eigen::Index>(index(source))));
  return vector_of(own);
}

std::string array_unit(Unit unit) { return unit == Unit::rad ? "rad" : std::string(file_unit(unit)); }

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

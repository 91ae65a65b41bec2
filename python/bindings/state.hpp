#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/version.hpp"
#include "rooms.hpp"

namespace paracal::python {

// Objects as bytes and back, to the bit, for pickle: field after field, whatever is in them.

template <typename Type, template <typename...> typename Template>
inline constexpr bool is_a = false;
template <template <typename...> typename Template, typename... Of>
inline constexpr bool is_a<Template<Of...>, Template> = true;

/// References to all fields of a struct. One more or fewer than it has does not compile.
#define PARACAL_FIELDS(Struct, ...)         \
  inline auto fields_of(const Struct& of) { \
    const auto& [__VA_ARGS__] = of;         \
    return std::tie(__VA_ARGS__);           \
  }
PARACAL_FIELDS(PlateFreedoms, free)
PARACAL_FIELDS(Actuator, drive, rods, has_harmonics)
PARACAL_FIELDS(LimbDescription, base, plate, length, arm, axis, at_zero, behind, kind, width, azimuth, zero, gain,
               alpha0, beta0, pitch, turn_sine, turn_cosine)
PARACAL_FIELDS(Slide, axis, sign, pinion_radius)
PARACAL_FIELDS(Workspace::Box, x, y, z)
PARACAL_FIELDS(Workspace::Level, z, radius)
PARACAL_FIELDS(Workspace, radius, height, top_z, min_rotation, max_rotation, max_tilt, tilts_about, axis, box, levels)
PARACAL_FIELDS(JointLimits, speed, acceleration)
PARACAL_FIELDS(Tolerances, half_width, distribution, measured, origin, assumed)
PARACAL_FIELDS(RobotDescription, name, limbs, freedoms, slide, workspace, tolerances, controller_origin, joint_limits,
               hang)
PARACAL_FIELDS(TrackerModel, transverse, transverse_per_m, radial, radial_per_m)
PARACAL_FIELDS(NoiseModel, distance, height, point, body, rotation, tracker, distance_bias, dial_angle, joint)
PARACAL_FIELDS(SourceSelector, source, limb)
PARACAL_FIELDS(CommonError, text, direction, std)
PARACAL_FIELDS(AcceptanceLimits, distance, volumetric, rotation)
PARACAL_FIELDS(ControllerModel, evidence, source, robot)
PARACAL_FIELDS(Discrepancies, visits, poses, drives, length, tolerances, least_gain_of_drives)
PARACAL_FIELDS(OmittedPoses, rigid, with_drives, poses)
PARACAL_FIELDS(CauseSizes, error, tolerances, stated_noise, visits, poses, drives, drives_over_noise, far_too_small,
               other_machine)
PARACAL_FIELDS(CalibrationOptions, method, stage, noise, noise_is_known, frame, body, reflector_is_at_centre,
               rotation_zero, reflectors, tolerances, common, expected, plane_slope, plane_curvature, scale_std,
               discrepancies, seeks_discrepancies, largest_doubt, noise_to_tell, causes, tell_chance, limits,
               states_use, fixed, free, outlier_chance, largest_chance, largest_noise_factor, largest_unstated_noise,
               largest_absorbed, largest_use_ratio, exclude_outliers, diagnose, controller)
PARACAL_FIELDS(CalibratedRegion, low, high)
PARACAL_FIELDS(SplineKnot, centre, spacing)
PARACAL_FIELDS(SoughtSource, limb, source, prior_std, knot)
PARACAL_FIELDS(ParameterEstimate, limb, source, value, std, prior_std, expected, with_drives, data_share, dof, held)
PARACAL_FIELDS(Component, cause, text, probability, told)
PARACAL_FIELDS(UseQuantity, U, limit)
PARACAL_FIELDS(Use, distance, aligned, rotation)
PARACAL_FIELDS(NullDirection, text, direction, gauge)
PARACAL_FIELDS(DistanceResidual, from, to, distance, distance_before, distance_after, rotation, rotation_before,
               rotation_after, excluded)
PARACAL_FIELDS(PointResidual, series, station, before, after, rotation_before, rotation_after, excluded,
               orientation_before, orientation_after)
PARACAL_FIELDS(LengthResidual, series, station, kind, length, before, after, excluded)
PARACAL_FIELDS(Suspect, text, statistic, chance, excluded)
PARACAL_FIELDS(FoundSetUp, name, kind, unknowns, covariance, told)
PARACAL_FIELDS(StageReport, name, iterations, converged, rank, condition, rms_distance)
PARACAL_FIELDS(RigidMotion, rotation, translation)
PARACAL_FIELDS(SeriesFrame, name, frame, rotation_zero, second, body)
PARACAL_FIELDS(PoseErrorSummary, max_abs_distance, rms_distance, max_volumetric, max_volumetric_aligned,
               reads_distances, rms_lengths, rms_joints, max_abs_rotation, max_orientation)
PARACAL_FIELDS(InputFile, name, sha256)
PARACAL_FIELDS(FitSummary, stages, rank, null_space, readings, degrees_of_freedom, unit_weight_std, fit_probability)
PARACAL_FIELDS(FoundSetUps, frames, set_ups, distance_bias, distance_bias_std)
PARACAL_FIELDS(FitResiduals, before, after, distances, points, lengths, suspects, noise, orientation_noise, chance)
PARACAL_FIELDS(Posterior, expected, parameters, covariance, noise_covariance, noise_dof, joint_std, visit_std, drives,
               drive_covariance, drive_sizes, omitted_poses, region, components)
PARACAL_FIELDS(WorkspaceUse, use, use_mean)
PARACAL_FIELDS(Outcome, verdict, reasons)
PARACAL_FIELDS(Remarks, notes, assumed)
/// Its parts are its bases, which no structured binding names.
inline auto fields_of(const Calibration& of) {
  return std::tuple<const FitSummary&, const FoundSetUps&, const FitResiduals&, const Posterior&, const WorkspaceUse&,
                    const Outcome&, const Remarks&, const Robot&, const CalibrationOptions&,
                    const std::vector<InputFile>&>(of, of, of, of, of, of, of, of.robot, of.options, of.files);
}
PARACAL_FIELDS(Pose, position, rotation, tilt)
PARACAL_FIELDS(Station, name, commanded, believed, stated_in)
PARACAL_FIELDS(DistanceReading, from, to, distance, rotation, distance_sigma)
PARACAL_FIELDS(PointReading, station, point, second, rotation, sigma, orientation, orientation_sigma)
PARACAL_FIELDS(PointSeries, name, readings)
PARACAL_FIELDS(LengthReading, station, length, sigma)
PARACAL_FIELDS(LengthSeries, name, kind, readings, at)
PARACAL_FIELDS(Measurements, stations, distances, series, lengths, files, notes)
PARACAL_FIELDS(io::RobotStatement, robot, by, line, robot_file)
PARACAL_FIELDS(KnownErrors, errors, parameters, covariance, noise_covariance, noise_dof, joint_std, visit_std,
               drive_sizes, region)
PARACAL_FIELDS(GivenMeasurements, readings, stated, tables)
PARACAL_FIELDS(KnownMachine, robot, known, inputs, controller)
#undef PARACAL_FIELDS

class StateWriter {
 public:
  template <typename... Values>
  static std::string bytes_of(const Values&... values) {
    StateWriter writer;
    (writer.write(values), ...);
    return std::move(writer.bytes_);
  }

 private:
  void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  template <typename Value>
  void write(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      raw(&value, sizeof value);
    } else if constexpr (std::is_convertible_v<const Value&, std::string_view>) {
      write(std::string_view(value).size());
      raw(std::string_view(value).data(), std::string_view(value).size());
    } else if constexpr (std::same_as<Value, std::filesystem::path>) {
      write(value.native());
    } else if constexpr (std::derived_from<Value, Eigen::EigenBase<Value>>) {
      write(value.rows());
      write(value.cols());
      raw(value.data(), sizeof(double) * static_cast<std::size_t>(value.size()));
    } else if constexpr (std::derived_from<Value, Eigen::QuaternionBase<Value>>) {
      write(value.coeffs());
    } else if constexpr (is_a<Value, std::optional>) {
      write(value.has_value());
      if (value) write(*value);
    } else if constexpr (is_a<Value, std::vector> || is_a<Value, std::map>) {
      write(value.size());
      for (const auto& one : value) write(one);
    } else if constexpr (is_a<Value, std::pair>) {
      write(value.first);
      write(value.second);
    } else if constexpr (requires { std::tuple_size<Value>::value; }) {  // an array
      for (const auto& one : value) write(one);
    } else if constexpr (std::same_as<Value, Source>) {
      write(value.index());
    } else if constexpr (requires { value.values[Source("e_x").index()]; }) {  // BySource
      write(value.values);
    } else if constexpr (std::same_as<Value, SourceErrors>) {
      for_each_source([&](std::size_t limb, Source source) { write(value(limb, source)); });
    } else if constexpr (std::same_as<Value, Robot>) {
      write(value.description());
    } else {
      std::apply([&](const auto&... fields) { (write(fields), ...); }, fields_of(value));
    }
  }

  std::string bytes_;

 public:
  template <typename Take>
  static void for_each_source(Take&& take) {
    for (std::size_t limb = 0; limb < kMaxLimbs; ++limb) {
      for (const Source source : all_sources()) take(limb, source);
    }
  }
};

/// @throws Error for bytes that end too soon or too late.
class StateReader {
 public:
  template <typename Value>
  static Value value_of(std::string_view bytes) {
    StateReader reader(bytes);
    Value value = reader.read<Value>();
    if (!reader.left_.empty()) fail("fewer");
    return value;
  }

 private:
  explicit StateReader(std::string_view bytes) : left_(bytes) {}

  template <typename Value>
  Value read() {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      Value value;
      std::memcpy(&value, raw(sizeof value), sizeof value);
      return value;
    } else if constexpr (std::same_as<Value, std::string>) {
      const auto size = read<std::size_t>();
      return {raw(size), size};
    } else if constexpr (std::same_as<Value, std::string_view>) {  // of texts that live as long as the program
      static std::set<std::string> texts;                          // under the interpreter's lock
      return *texts.insert(read<std::string>()).first;
    } else if constexpr (std::same_as<Value, std::filesystem::path>) {
      return read<std::string>();
    } else if constexpr (std::derived_from<Value, Eigen::EigenBase<Value>>) {
      const auto rows = read<Eigen::Index>(), columns = read<Eigen::Index>();
      const auto room = static_cast<Eigen::Index>(left_.size());
      const bool fits = (Value::RowsAtCompileTime == Eigen::Dynamic || Value::RowsAtCompileTime == rows) &&
                        (Value::ColsAtCompileTime == Eigen::Dynamic || Value::ColsAtCompileTime == columns);
      if (!fits || rows < 0 || columns < 0 || (columns > 0 && rows > room / columns)) fail("other");
      Value value(rows, columns);
      const std::size_t size = sizeof(double) * static_cast<std::size_t>(value.size());
      std::memcpy(value.data(), raw(size), size);
      return value;
    } else if constexpr (std::derived_from<Value, Eigen::QuaternionBase<Value>>) {
      return Value(read<Eigen::Vector4d>());
    } else if constexpr (is_a<Value, std::optional>) {
      return read<bool>() ? Value(read<typename Value::value_type>()) : Value();
    } else if constexpr (is_a<Value, std::vector>) {
      Value value;
      for (auto left = read<std::size_t>(); left > 0; --left) value.push_back(read<typename Value::value_type>());
      return value;
    } else if constexpr (is_a<Value, std::map>) {
      Value value;
      for (auto left = read<std::size_t>(); left > 0; --left) {
        value.insert(read<std::pair<typename Value::key_type, typename Value::mapped_type>>());
      }
      return value;
    } else if constexpr (is_a<Value, std::pair>) {
      return Value{read<typename Value::first_type>(), read<typename Value::second_type>()};
    } else if constexpr (requires { std::tuple_size<Value>::value; }) {
      Value value;
      for (auto& one : value) one = read<typename Value::value_type>();
      return value;
    } else if constexpr (std::same_as<Value, Source>) {
      return all_sources()[std::min(read<std::size_t>(), kSourceNames - 1)];
    } else if constexpr (requires(Value value) { value.values[Source("e_x").index()]; }) {  // BySource
      return {read<decltype(Value::values)>()};
    } else if constexpr (std::same_as<Value, SourceErrors>) {
      Value value;
      StateWriter::for_each_source([&](std::size_t limb, Source source) { value(limb, source) = read<double>(); });
      return value;
    } else if constexpr (std::same_as<Value, Robot>) {
      return Robot(read<RobotDescription>());
    } else {
      return struct_of<Value>(static_cast<decltype(fields_of(std::declval<const Value&>()))*>(nullptr));
    }
  }

  template <typename Struct, typename... Fields>
  Struct struct_of(std::tuple<const Fields&...>* /*of these*/) {
    return Struct{read<Fields>()...};  // in order, since in braces
  }

  const char* raw(std::size_t size) {
    if (size > left_.size()) fail("more");
    const char* data = left_.data();
    left_.remove_prefix(size);
    return data;
  }

  [[noreturn]] static void fail(std::string_view which) {
    throw Error(fmt::format("state: expected {} bytes; it is of another version, or was changed", which));
  }

  std::string_view left_;
};

/// A class whose objects functions of the module make, and pickle and copy. Its __new__ would make one of nothing.
template <typename Object>
py::class_<Object> class_of_results(py::module_& module, const char* name) {
  return {module, name, py::custom_type_setup([](PyHeapTypeObject* type) {
            type->ht_type.tp_new = [](PyTypeObject* of, PyObject* /*args*/, PyObject* /*keywords*/) -> PyObject* {
              PyErr_Format(PyExc_TypeError, "%s: expected a call of a function of paracal, which makes such objects",
                           of->tp_name);
              return nullptr;
            };
          })};
}

/// What __reduce__ returns of an object that a function of the module makes.
template <typename... Arguments>
py::tuple made_by(const char* function, Arguments&&... arguments) {
  return py::make_tuple(py::module_::import("paracal._state").attr("made_by"),
                        py::make_tuple(function, std::forward<Arguments>(arguments)...));
}

/// The same with pickle and copy, to the bit. A hash tells changed bytes: what a field may hold is not checked again.
template <typename Object>
py::class_<Object> class_of_states(py::module_& module, const char* name) {
  const std::string restored = std::string("_restored_").append(name);
  const auto restore = [](const std::string& of, const std::string& bytes, const std::string& sha256) {
    if (of != version()) {
      throw Error(fmt::format("pickle: expected an object of paracal {}, got one of {}", version(), of));
    }
    if (sha256 != io::sha256(bytes)) throw Error("pickle: expected bytes with their hash, got changed ones");
    return StateReader::value_of<Object>(bytes);
  };
  module.def(restored.c_str(), restore, py::arg("version"), py::arg("state"), py::arg("sha256"));
  auto made = class_of_results<Object>(module, name);
  made.def("__reduce__", [restored](const Object& object) {
    const std::string bytes = StateWriter::bytes_of(object);
    return made_by(restored.c_str(), version(), py::bytes(bytes), io::sha256(bytes));
  });
  return made;
}

}  // namespace paracal::python

#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/option_limits.hpp"

namespace paracal::python {

namespace py = pybind11;

/// The number itself.
/// @throws InvalidArgument unless it is in the range.
double checked(const char* name, double number, const plausible::Range& range);
std::uint64_t checked(const char* name, std::int64_t number, const option_limits::Whole& range);

/// What keywords of a call say; None and what is not there leave the default of the library.
class Keywords {
 public:
  explicit Keywords(py::dict given) : given_(std::move(given)) {}

  bool has(const char* key) const { return given_.contains(key) && !given_[key].is_none(); }

  /// @throws TypeError for what is none.
  template <typename Value>
  Value get(const char* key, std::string_view expected) const {
    try {
      return given_[key].cast<Value>();
    } catch (const py::cast_error&) {
      throw py::type_error(
          fmt::format("{}: expected {}, got {}", key, expected, std::string(py::str(py::repr(given_[key])))));
    }
  }

  template <typename Value>
  void take(const char* key, std::string_view expected, Value& into) const {
    if (has(key)) into = get<Value>(key, expected);
  }

  /// A number times `factor`, into a double or an optional one.
  /// @throws InvalidArgument unless it is in the range.
  template <typename Number>
  void take_number(const char* key, const plausible::Range& range, Number& into, double factor = 1.0) const {
    if (has(key)) into = factor * checked(key, get<double>(key, "a number"), range);
  }

  template <typename Value>
  void choose(const char* key, std::initializer_list<std::pair<std::string_view, Value>> choices, Value& into) const {
    if (!has(key)) return;
    const auto wanted = get<std::string>(key, "a text");
    std::string known;
    for (const auto& [name, value] : choices) {
      if (name == wanted) return void(into = value);
      known.append(known.empty() ? "" : ", ").append(name);
    }
    throw InvalidArgument(fmt::format("{}: expected one of {}, got \"{}\"", key, known, wanted));
  }

 private:
  py::dict given_;
};

/// The keywords of noise (io/calibrations/calibration_settings.hpp).
NoiseModel noise_of(const Keywords& given);

/// The keywords of paracal.calibrate().
CalibrationOptions calibration_options(const Robot& robot, const Keywords& given);

/// The keywords of paracal.validate().
ValidationOptions validation_options(const Keywords& given);

/// measure, at, read_rotation, second, reflectors.
PlannedReadings planned_readings(const Keywords& given);

}  // namespace paracal::python

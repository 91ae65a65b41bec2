#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/interruption.hpp"
#include "paracal/io/robot_statement.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::python {

namespace py = pybind11;

/// Takes the interpreter's lock by `take`. Once the interpreter ends it would rather end the thread that asks, in the
/// middle of C++, which aborts the process: such a thread sleeps until the process has ended.
void take_lock(const std::function<void()>& take);

/// To be called when the interpreter begins to end, with its lock.
void end_threads();

/// Other threads of Python run while the library computes, and Ctrl-C ends what the main thread has asked for.
class Released {
 public:
  Released() : state_(PyEval_SaveThread()), interruptible_(&check_signals) {}
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;
  ~Released() {
    take_lock([this] { PyEval_RestoreThread(state_); });
  }

 private:
  static void check_signals() {
    std::optional<py::gil_scoped_acquire> acquired;
    take_lock([&] { acquired.emplace(); });
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

  PyThreadState* state_;
  Interruptible interruptible_;
};

/// A robot with the source errors that it was built with.
struct BuiltMachine {
  Robot robot;
  SourceErrors errors;
  Machine machine;
};

/// What tables hold, and which robot they say they are of.
struct GivenMeasurements {
  Measurements readings;
  std::optional<io::RobotStatement> stated = {};
  std::vector<std::string> tables = {};  ///< that hold readings, not poses
};

/// A calibrated machine: what validation, prediction and compensation need to know.
struct KnownMachine {
  Robot robot;
  KnownErrors known;
  std::vector<InputFile> inputs = {};  ///< that it was calibrated from
  ControllerModel controller = {};     ///< that commanded what it was calibrated from
};

/// The robot that is asked for, which the tables must be of.
/// @throws InputFileError where they say something else.
void require_robot(const Robot& robot, const GivenMeasurements& given);

/// One function a room.
void add_robots(py::module_& module);
void add_kinematics(py::module_& module);
void add_measurements(py::module_& module);
void add_calibration(py::module_& module);
void add_plans(py::module_& module);
void add_tolerance(py::module_& module);
void add_compensation(py::module_& module);

}  // namespace paracal::python

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "arrays.hpp"
#include "paracal/error.hpp"
#include "paracal/io/store.hpp"
#include "paracal/version.hpp"
#include "rooms.hpp"

namespace paracal::python {
namespace {

/// Raises an exception of paracal/errors.py.
template <typename... Details>
void raise(const char* name, const std::exception& error, Details&&... details) {
  const py::object type = py::module_::import("paracal.errors").attr(name);
  const py::object raised = type(text_of(error.what()), std::forward<Details>(details)...);
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param): as pybind11 calls it
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputFileError& error) {
    raise("InputFileError", error, text_of(error.file()), error.line());
  } catch (const InvalidArgument& error) {
    raise("InvalidArgument", error);
  } catch (const Unreachable& error) {
    raise("Unreachable", error);
  } catch (const Error& error) {
    raise("Error", error);
  }
}

std::atomic<bool> ends = false;
std::atomic<int> taking = 0;  // threads that wait for the lock, or are about to
std::thread::id ending_thread;

}  // namespace

void take_lock(const std::function<void()>& take) {
  ++taking;
  if (ends && std::this_thread::get_id() != ending_thread) {
    --taking;
    for (;;) pause();
  }
  take();
  --taking;
}

void end_threads() {
  ending_thread = std::this_thread::get_id();
  ends = true;
  PyThreadState* const state = PyEval_SaveThread();
  while (taking > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  PyEval_RestoreThread(state);
}

}  // namespace paracal::python

PYBIND11_MODULE(_paracal, module) {
  using namespace paracal::python;
  module.doc() = "The compiled module of the package paracal: plain arrays, mm and rad.";
  module.attr("version") = std::string(paracal::version());
  module.attr("build") = std::string(paracal::build());
  py::register_exception_translator(&translate);
  module.def(
      "write_file", [](const std::string& path, const std::string& text) { paracal::io::write_file(path, text); },
      py::arg("path"), py::arg("text"), py::call_guard<Released>());
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_threads));
  add_robots(module);
  add_kinematics(module);
  add_measurements(module);
  add_calibration(module);
  add_plans(module);
  add_tolerance(module);
  add_compensation(module);
}

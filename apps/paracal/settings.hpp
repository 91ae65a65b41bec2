#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "arguments.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::io {
struct CalibrationSettings;
struct NoiseSettings;
struct PlanSettings;
struct ValidationSettings;
}  // namespace paracal::io

namespace paracal::app {

/// Options of a command from a list of settings (io/calibrations/calibration_settings.hpp). What was given is put into
/// the options of the library once the robot is known.
template <typename List>
class Settings {
 public:
  void declare(Command& command);
  bool is_given(std::string_view option) const;
  Option* option(std::string_view name) const { return options_.find(name)->second; }
  /// Changes what was given, and nothing else.
  /// @throws WrongUsage for names that the robot does not have, and InputFileError for a file of tolerances.
  template <typename Options>
  void put_into(Options& options, const Robot& robot) const;

 private:
  std::map<std::string, Option*, std::less<>> options_;
};

}  // namespace paracal::app

#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "controller.hpp"
#include "inputs.hpp"
#include "measuring.hpp"
#include "paracal/calibration/validation.hpp"
#include "paracal/io/json.hpp"
#include "settings.hpp"

namespace paracal::app {

/// What commands that judge a calibration by measurements ask for.
struct ValidatingOptions {
  MeasuringOptions measuring;
  ControllerOptions controller;
  std::string calibration;
  Settings<io::ValidationSettings> settings;

  RobotSources robot_sources() const { return {.calibrations = {calibration}, .tables = measuring.tables()}; }
  CommandedReadings read(const io::CalibratedMachine& machine, const Robot& robot) const {
    return read_commanded(measuring, controller, machine.controller, robot);
  }
  ValidationOptions options(const CommandedReadings& read, const Robot& robot) const;
  /// Of the files of readings, those that the calibration was made from: they confirm nothing.
  std::vector<std::string> own(const io::CalibratedMachine& machine, const Measurements& measurements) const;
};

/// --calibration, the measuring options and the settings of a validation.
/// @returns --measurements, which is required unless its taker says otherwise.
Option* add_validating_options(Command& command, ValidatingOptions& options);

}  // namespace paracal::app

#include "validating.hpp"

#include <algorithm>

#include "paracal/io/measurement_files.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// Whether options state the noise of all that was read, where readings do not.
bool states_noise_of(const Settings<io::ValidationSettings>& settings, const Measurements& measurements) {
  const bool sigma = settings.is_given("sigma-mm"), height_sigma = settings.is_given("height-sigma-mm");
  const auto states = [&](const LengthSeries& series) {
    return words(series.kind).sigma == &NoiseModel::height ? height_sigma : sigma;
  };
  return (measurements.series.empty() || sigma || settings.is_given("tracker-um")) &&
         (measurements.distances.empty() || sigma) && std::ranges::all_of(measurements.lengths, states);
}

}  // namespace

ValidationOptions ValidatingOptions::options(const CommandedReadings& read, const Robot& robot) const {
  ValidationOptions options{.noise_is_known = states_noise_of(settings, read.measurements),
                            .rotation_noise_is_known = settings.is_given("sigma-deg"),
                            .controller = read.controller};
  settings.put_into(options, robot);
  return options;
}

std::vector<std::string> ValidatingOptions::own(const io::CalibratedMachine& machine,
                                                const Measurements& measurements) const {
  return io::used_before(machine.inputs, measurements, measuring.files);
}

Option* add_validating_options(Command& command, ValidatingOptions& options) {
  command.add_option("--calibration", options.calibration, "calibration to check (JSON)")->required();
  Option* measurements = add_measuring_options(command, options.measuring);
  options.settings.declare(command);
  add_controller_options(command, options.controller);
  return measurements;
}

}  // namespace paracal::app

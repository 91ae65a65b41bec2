#pragma once

#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"
#include "paracal/printer/printer_calibration.hpp"

namespace paracal::test {

/// One entry of data/klipper-delta/sets.json.
struct KlipperSet {
  std::string id = {};
  DeltaGeometry geometry = {};  ///< as saved
  DeltaReadings readings = {};
  double saved_cost = 0.0, best_cost = 0.0;  ///< of the firmware's cost; the latter from SciPy
  bool saved_is_optimum = false;
  std::string config = {};  ///< the same as the text of a printer.cfg
};

std::vector<KlipperSet> klipper_sets();

/// What is said of a set, without trying what gross readings would do; once, for tests that ask several things of it.
const PrinterCalibration& calibrated(const KlipperSet& set);

}  // namespace paracal::test

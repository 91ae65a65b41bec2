#pragma once

#include <array>
#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::io {

/// The published measurements of the robot of [huang2016]; data/huang2016 says where each number stands in the paper.
struct PublishedHuang2016 {
  Measurements rough;    ///< the six distances to home of Table 3 'before', with the poses of section 5.2.1
  SourceErrors offsets;  ///< the encoder offsets of section 5.2.1

  struct Table3Row {
    std::string point;
    PoseError error;
  };
  std::vector<Table3Row> before, after;  ///< Table 3, relative to home

  std::array<double, kTiltSourceCount> table2;  ///< optimized tolerances of the tilt group, rad

  SourceErrors table4;                    ///< identified source errors; zero where Eq. (15) sets them to zero
  PoseError table5_before, table5_after;  ///< largest errors over the validation poses
};

PublishedHuang2016 published_huang2016();

}  // namespace paracal::io

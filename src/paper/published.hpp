#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::io {

/// Of the validation poses of [huang2016].
enum class Layer : std::uint8_t { top, middle, bottom };

/// The published measurements of the robot of [huang2016]; data/huang2016 states where each number is in the paper.
struct PublishedHuang2016 {
  Measurements rough;    ///< the six distances to home of Table 3 'before', with the poses of section 5.2.1
  SourceErrors offsets;  ///< the encoder offsets of section 5.2.1

  struct Table3Row {
    std::string point;
    PoseError error;
  };
  std::vector<Table3Row> before, after;  ///< Table 3, relative to home

  std::array<double, ErrorModel::kTilt> table2;  ///< optimized tolerances of the tilt group, rad

  /// Values from the figures and the text about them.
  struct Figures {
    std::array<Source, 3> most_tilting{"rod_difference", "alpha2", "alpha03"};  ///< 5, largest first
    double radius = 500.0,
           depth = -1013.0;                 ///< 6: where the tilt is largest in the bottom layer, and of all layers, mm
    int rough_points = 6, fine_points = 9;  ///< 7 and 8
    /// 9: layer with the largest errors after calibration, on its rim.
    Layer distance = Layer::bottom, volumetric = Layer::bottom, rotation = Layer::top;
    double tilt = 0.86e-3;              ///< largest, rad: 0.086/100 in sections 5.1 and 6
    Layer tilted_most = Layer::bottom;  ///< on whose rim
  };
  Figures figures = {};

  SourceErrors table4;                    ///< identified source errors; zero where Eq. (15) sets them to zero
  PoseError table5_before, table5_after;  ///< largest errors over the validation poses
};

PublishedHuang2016 published_huang2016();

}  // namespace paracal::io

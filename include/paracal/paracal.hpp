#pragma once

// The whole library but for JSON (paracal/io/json.hpp), which needs nlohmann-json.

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/error.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

#pragma once

#include "paracal/units.hpp"

namespace paracal::io {

using paracal::file_unit, paracal::to_file_unit, paracal::from_file_unit;

}  // namespace paracal::io

#pragma once

#include <string>
#include <vector>

#include "paracal/io/json.hpp"

namespace paracal::app {

/// Of all results: "calibration".
std::vector<std::string> schema_names();

/// What a result looks like, by itself: a JSON Schema (draft 2020-12) that refers to nothing outside of it. What its
/// file in schema/ takes from others stands under its `$defs`.
io::Json result_schema(const std::string& name);

}  // namespace paracal::app

#pragma once

// Private to io: files against the schemas of results, which `paracal schema` prints.

#include <span>
#include <string_view>

#include "json_node.hpp"

namespace paracal::io {

/// Refuses the first value that the schema forbids, with its line. Keys that are missing and keys that the schema does
/// not have are left to the reader: other versions of the program, and people, write fewer or more.
/// @param schema       file of the folder schema: "calibration.schema.json".
/// @param passed_over  keys of the node that the reader checks itself.
void require_schema(const JsonNode& node, std::string_view schema, std::span<const std::string_view> passed_over);

}  // namespace paracal::io

#pragma once

// Private to io: the [[limb]] tables of a robot whose limbs have one rod each.

#include <string>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// Whether the tables say what each limb is, rather than what it differs by from a [geometry].
bool define_limbs(const toml::table& document);

/// Limbs of one kind.
/// @throws InputFileError for a kind that is none or another, and for missing, unknown or wrongly typed keys.
Geometry limbs_geometry(Section& root);

std::string limbs_toml(const Geometry& geometry);
Json limbs_json(const Geometry& geometry);
/// ["x", "y"]
Json freedoms_json(const PlateFreedoms& freedoms);

}  // namespace paracal::io

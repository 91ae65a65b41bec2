#pragma once

// Private to io: the [[limb]] tables of a robot whose plate hangs on struts.

#include <string>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// Whether the tables say what each limb is, rather than what it differs by from a [geometry].
bool define_limbs(const toml::table& document);

/// @throws InputFileError for a kind that is none, and for missing, unknown or wrongly typed keys.
Geometry limbs_geometry(Section& root);

std::string struts_toml(const Geometry& geometry);
Json struts_json(const Geometry& geometry);

}  // namespace paracal::io

#pragma once

// Private to io: the [[limb]] tables of a robot whose limbs have their own dimensions.

#include <string>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "section.hpp"

namespace paracal::io {

/// Whether the tables say what each limb is, rather than what it differs by from a [geometry].
bool define_limbs(const toml::table& document);

/// Limbs with their own dimensions, and the degrees of freedom of the plate on them.
/// @throws InputFileError for a kind that is none or another, and for missing, unknown or wrongly typed keys.
void read_limbs(Section& root, RobotDescription& robot);

/// Of a screw or an encoder (LimbDescription::pitch), in a [[limb]] table or the [geometry]; 0 where they state none.
double pitch_of(Section& table, Actuator kind);
void add_pitch(Actuator kind, double pitch, Json& json);

std::string limbs_toml(const Limbs& limbs);
Json limbs_json(const Limbs& limbs);
/// ["x", "y"]
Json freedoms_json(const PlateFreedoms& freedoms);

}  // namespace paracal::io

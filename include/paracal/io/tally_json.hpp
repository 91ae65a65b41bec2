#pragma once

#include "paracal/batch/tally.hpp"
#include "paracal/io/json.hpp"

namespace paracal::io {

/// A tally as it stands in a chunk of a batch, and goes from rank to rank.
Json tally_json(const Tally& tally);

/// @throws Json::exception, std::out_of_range for what no tally says.
Tally tally_of(const Json& json);

}  // namespace paracal::io

#pragma once

#include "paracal/batch/tally.hpp"
#include "paracal/io/json.hpp"

namespace paracal::io {

/// A tally as stored in a chunk of a batch and sent between ranks.
Json tally_json(const Tally& tally);

/// @throws Json::exception, std::out_of_range for anything else.
Tally tally_of(const Json& json);

}  // namespace paracal::io

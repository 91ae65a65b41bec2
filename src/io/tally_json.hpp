#pragma once

// Private to io: a tally of machines as it stands in a chunk of a batch.

#include <cstdint>

#include "paracal/batch/tally.hpp"
#include "paracal/io/json.hpp"

namespace paracal::io {

Json tally_json(const Tally& tally);

/// @throws Json::exception, std::out_of_range for what no tally of so many machines says.
Tally tally_of(const Json& json, std::uint64_t machines);

}  // namespace paracal::io

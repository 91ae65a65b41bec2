#pragma once

#include <string>
#include <string_view>

#include "paracal/io/json.hpp"

namespace paracal::report {

/// A self-contained HTML page: the template with the data of a report in the place that it keeps for them.
///
/// The data stand in a script element of type application/json, every '<' of them as \u003c: whatever a name in a
/// measurement file holds, it can neither end that element nor become markup. Bytes that are no UTF-8 become U+FFFD.
///
/// @throws Error when the template keeps no place.
std::string page(std::string_view html_template, const io::Json& data);

}  // namespace paracal::report

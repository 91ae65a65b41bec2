#pragma once

#include <string>
#include <string_view>

#include "paracal/io/json.hpp"

namespace paracal::report {

/// A self-contained HTML page: the template with the data of a report.
///
/// The data are in a script element of type application/json, with every '<' as \u003c. So no name in a measurement
/// file can end that element or become markup. Bytes that are not UTF-8 become U+FFFD.
///
/// @throws Error if the template has no place for data.
std::string page(std::string_view html_template, const io::Json& data);

}  // namespace paracal::report

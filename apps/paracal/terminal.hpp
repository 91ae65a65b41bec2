#pragma once

#include <cstddef>
#include <string>

namespace paracal::app {

enum class Emphasis { strong, good, bad, warning };

/// The text with the colour or weight of an emphasis where the stream is a terminal that shows it. Nothing is added
/// where NO_COLOR is set (no-color.org) or TERM is dumb.
std::string emphasised(int stream, Emphasis emphasis, const std::string& text);

/// A result for standard output whose first line is its verdict, good or bad; notes are warnings.
std::string with_verdict(const std::string& text, bool is_met);

/// Columns of the terminal behind standard output; 80 where there is none.
std::size_t columns_of_output();

}  // namespace paracal::app

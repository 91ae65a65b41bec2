#pragma once

// Private to io: comments of RS-274 that a controller shows or does something with  [linuxcnc, comments].

#include <string>
#include <string_view>
#include <vector>

namespace paracal::io {

/// All comments of a line, a blank between them: "(MSG, part 2) ; note".
std::string comments_of(std::string_view line);

/// Parameters whose values the line shows, as they are written: #1 and #<depth> of (DEBUG, #1 of #<depth>). Of several
/// comments in brackets the last counts; PRINT and LOG show values, too.
std::vector<std::string_view> shown_parameters(std::string_view line);

}  // namespace paracal::io

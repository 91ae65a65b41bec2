#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// The known word that an unknown one probably means: the one with the fewest letters inserted, omitted, changed or
/// swapped with a neighbour. At most one such edit, or one per three letters; hyphens do not count.
/// Empty if no word is near enough.
std::optional<std::string> meant_by(std::string_view word, const std::vector<std::string>& known);

/// " (did you mean WORD?)" for the end of a message, or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace paracal

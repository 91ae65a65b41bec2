#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// The known word nearest to an unknown one, by letters inserted, omitted, changed or swapped with their neighbours. At
/// most one such change is allowed, or one per three letters of the word; hyphens do not count.
/// Empty if no word is that near.
std::optional<std::string> meant_by(std::string_view word, const std::vector<std::string>& known);

/// " (did you mean WORD?)", or nothing: what messages end with.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace paracal

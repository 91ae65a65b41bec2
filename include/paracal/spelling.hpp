#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// The known word that was probably meant by an unknown one: the nearest by letters inserted, left out, changed or
/// swapped with their neighbours, of which one is allowed, or one a third of the word's letters; hyphens are none.
/// Empty where no word is that near.
std::optional<std::string> meant_by(std::string_view word, const std::vector<std::string>& known);

/// " (did you mean WORD?)", or nothing: what messages end with.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace paracal

#pragma once

// Private to the filter: arcs of G-code, G2 and G3.

#include <array>
#include <optional>
#include <string_view>

#include "target_path.hpp"

namespace paracal::io {

/// The words of an arc, mm; of the program's frame where they are places.
struct ArcWords {
  std::array<std::optional<double>, 3> centre = {};  ///< I, J, K
  bool centre_is_place = false;                      ///< G90.1; else from the start of the arc
  std::optional<double> radius = {};                 ///< R; negative: the longer way
  double turns = 1.0;                                ///< P
};

/// The axis about which an arc turns: 2 (G17), 1 (G18), 0 (G19).
using ArcNormal = std::size_t;

/// Makes a path with ends an arc as RS-274 says [kramer2000, 3.5.3].
/// @returns what is wrong with it; else empty, and path.arc is filled.
std::string_view make_arc(const ArcWords& words, ArcNormal normal, bool clockwise, TargetPath& path);

}  // namespace paracal::io

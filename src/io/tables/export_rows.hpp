#pragma once

// Private to io: exports of inspection programs with one line per coordinate.

#include <optional>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// An export with one line per coordinate ("P1,X,nominal,measured,deviation", or names "P1.X") as one with a point per
/// line and a header row that names x, y and z. Each point stands in the line of its first coordinate, so that
/// messages name lines of the file. Lines of other values ("3D", "D") are left out. Empty: the file is no such export.
/// @throws InputFileError for a point without one of its coordinates.
std::optional<TextFile> joined_coordinates(const TextFile& file);

}  // namespace paracal::io

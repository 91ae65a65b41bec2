#pragma once

// Private to io: orientations of a body as tables and exports state them.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "export_header.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/points.hpp"

namespace paracal::io {

/// An orientation as a product of three rotations about axes, R = R_a(first) R_b(second) R_c(third).
struct AngleProduct {
  std::array<int, 3> axes{};           ///< 0 to 2 for x to z
  std::array<std::string, 3> names{};  ///< of the columns with the angles, in lower case, without their unit

  /// @param angles  rad, in the order of the product.
  Quaternion of(const std::array<double, 3>& angles) const;
  /// "Rz(rz) Ry(ry) Rx(rx)"
  std::string text() const;
};

/// The product that a comment of the file states: "# angles: Rz Ry Rx", with columns rz, ry, rx; or with other columns
/// "# angles: R = Rz(a) Ry(b) Rx(c)".
/// @throws InputFileError for a comment "angles:" that states anything else.
std::optional<AngleProduct> stated_angles(const TextFile& file);

/// The columns of an orientation in an export: a quaternion (qw, qx, qy, qz; q0 to q3; rotation w, x, y, z), or the
/// angles of a product that a comment states.
/// @throws InputFileError if the columns of a stated product are missing or have no unit.
std::optional<OrientationColumns> orientation_columns(const TextFile& file, const HeaderRow& row);

}  // namespace paracal::io

#include "orientation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "columns.hpp"
#include "io/files/letters.hpp"
#include "io/files/utf8.hpp"
#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kAngles = "angles:";

/// The text behind "angles:" of a comment.
std::optional<std::string> statement_of(std::string_view line) {
  line = trimmed(line);
  if (!line.starts_with('#') && !line.starts_with("//")) return std::nullopt;
  const std::string text = lower_case(trimmed(line, "#/ \t"));
  if (!text.starts_with(kAngles)) return std::nullopt;
  return text.substr(kAngles.size());
}

/// Takes "rz" or "rz(a)" off the front.
bool take_factor(std::string_view& rest, int& axis, std::string& name) {
  rest = trimmed(rest, " \t*\r");
  if (rest.size() < 2 || rest[0] != 'r' || rest[1] < 'x' || rest[1] > 'z') return false;
  axis = rest[1] - 'x';
  name = rest.substr(0, 2);
  rest.remove_prefix(2);
  if (!rest.starts_with('(')) return true;
  const std::size_t end = rest.find(')');
  if (end == std::string_view::npos) return false;
  name = trimmed(rest.substr(1, end - 1));
  rest.remove_prefix(end + 1);
  return !name.empty();
}

std::optional<AngleProduct> product_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('r') && trimmed(text.substr(1)).starts_with('=')) text.remove_prefix(text.find('=') + 1);
  AngleProduct product;
  for (std::size_t k = 0; k < product.axes.size(); ++k) {
    if (!take_factor(text, product.axes[k], product.names[k])) return std::nullopt;
    if (k > 0 && product.axes[k] == product.axes[k - 1]) return std::nullopt;
  }
  const bool all_differ = product.names[0] != product.names[1] && product.names[1] != product.names[2] &&
                          product.names[0] != product.names[2];
  return trimmed(text).empty() && all_differ ? std::optional(product) : std::nullopt;
}

struct AngleHeading {
  std::string name;
  double rad;  ///< per unit
};

/// "Rx [deg]", "rx_deg", "Rx (rad)".
std::optional<AngleHeading> angle_heading(std::string_view field) {
  const std::string whole = lower_case(field);
  const std::string_view text = trimmed(whole, " \t])");
  const std::size_t at = text.find_last_of("_[( ");
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view unit = text.substr(at + 1);
  const std::string name(trimmed(text.substr(0, at), " \t_[("));
  if (unit == "deg" || unit == "degrees" || unit == "\u00B0") return AngleHeading{name, to_radians(1.0)};
  if (unit == "rad" || unit == "radians") return AngleHeading{name, 1.0};
  return std::nullopt;
}

std::optional<OrientationColumns> columns_of(const TextFile& file, const HeaderRow& row, const AngleProduct& product) {
  OrientationColumns found{.axes = product.axes};
  for (std::size_t k = 0; k < product.names.size(); ++k) {
    for (std::size_t column = 0; column < row.fields.size(); ++column) {
      const auto heading = angle_heading(row.fields[column]);
      if (!heading || heading->name != product.names[k] || is_ignored(file, row.fields[column])) continue;
      found.columns.push_back(column + 1);
      found.rad_per_unit[k] = heading->rad;
    }
    if (found.columns.size() == k + 1) continue;
    throw InputFileError(file.name, row.line,
                         fmt::format("expected one column \"{0} [deg]\", {0}_deg or {0}_rad, as the comment \"angles: "
                                     "{1}\" says, got {2}",
                                     product.names[k], product.text(), found.columns.size() <= k ? "none" : "several"));
  }
  return found;
}

std::optional<OrientationColumns> quaternion_columns(const TextFile& file, const HeaderRow& row) {
  using Words = std::array<std::string_view, 4>;
  for (const Words& words : {Words{"qw", "qx", "qy", "qz"}, Words{"q0", "q1", "q2", "q3"},
                             Words{"rotation w", "rotation x", "rotation y", "rotation z"}}) {
    OrientationColumns found;
    for (const std::string_view word : words) {
      for (std::size_t k = 0; k < row.headings.size(); ++k) {
        if (row.headings[k].meaning == word && !is_ignored(file, row.fields[k])) found.columns.push_back(k + 1);
      }
    }
    if (found.columns.size() == words.size()) return found;
  }
  return std::nullopt;
}

}  // namespace

Quaternion AngleProduct::of(const std::array<double, 3>& angles) const {
  Quaternion product = Quaternion::Identity();
  for (std::size_t k = 0; k < angles.size(); ++k) {
    product = product * Quaternion(Eigen::AngleAxisd(angles[k], Eigen::Vector3d::Unit(axes[k])));
  }
  return product;
}

std::string AngleProduct::text() const {
  std::string text;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    text += fmt::format("{}R{}({})", k == 0 ? "" : " ", "xyz"[axes[k]], names[k]);
  }
  return text;
}

std::optional<AngleProduct> stated_angles(const TextFile& file) {
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const auto statement = statement_of(with_other_bytes_decoded(line));
    if (!statement) continue;
    if (auto product = product_of(*statement)) return product;
    throw InputFileError(file.name, number,
                         fmt::format("expected a product of three rotations, such as \"angles: Rz Ry Rx\" or \"angles: "
                                     "Rz(a) Ry(b) Rx(c)\", got \"{}\"",
                                     trimmed(*statement)));
  }
  return std::nullopt;
}

std::optional<OrientationColumns> orientation_columns(const TextFile& file, const HeaderRow& row) {
  if (const auto product = stated_angles(file)) return columns_of(file, row, *product);
  return quaternion_columns(file, row);
}

}  // namespace paracal::io

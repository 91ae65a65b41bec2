#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace paracal::io {

/// Whether a field is one finite number, possibly with a decimal comma.
bool may_be_number(std::string_view field);

/// The decimal sign of a table: point or comma. Both are possible if no comma separates fields, or if fields are in
/// quotation marks. A comma is a decimal comma if the number has no other meaning: "1,5", "0,125", "1234,125", but not
/// "1,125", which may be more than a thousand. The first unambiguous number determines the sign of the table.
///
class DecimalSign {
 public:
  /// @param comma  stated by the user: then a number with a point is not a number.
  explicit DecimalSign(bool comma = false) : sign_(comma ? Sign::comma : Sign::unknown) {}

  bool is_known() const { return sign_ != Sign::unknown; }

  /// Finds the sign from a field, before any number is read.
  void look(std::string_view field, int line);

  /// Empty if the field is not one finite number with this sign.
  std::optional<double> number(std::string_view field) const;

  /// Why not, for the end of a message: " (...)" or nothing.
  std::string why_not(std::string_view field) const;

 private:
  enum class Sign : std::uint8_t { unknown, point, comma } sign_;
  int line_ = 0;  ///< that determined it; 0: stated by the user
};

}  // namespace paracal::io

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace paracal::io {

/// Whether a field is one finite number where its decimals may have a comma.
bool may_be_number(std::string_view field);

/// Whether the decimals of a table's numbers have a point or a comma: where no comma separates fields, or quotation
/// marks are around them, they may have either. A comma is a decimal comma where the number cannot be meant otherwise:
/// "1,5", "0,125", "1234,125", but not "1,125", which may be a thousand and some. The first number that shows its sign
/// says it for the table.
class DecimalSign {
 public:
  /// @param comma  somebody says so: then nothing else is a number.
  explicit DecimalSign(bool comma = false) : sign_(comma ? Sign::comma : Sign::unknown) {}

  bool is_known() const { return sign_ != Sign::unknown; }

  /// Takes what a field shows, before any number is read.
  void look(std::string_view field, int line);

  /// Empty where the field is anything but one finite number with this sign.
  std::optional<double> number(std::string_view field) const;

  /// Why not, for the end of a message: " (...)" or nothing.
  std::string why_not(std::string_view field) const;

 private:
  enum class Sign : std::uint8_t { unknown, point, comma } sign_;
  int line_ = 0;  ///< that showed it; 0: somebody says so
};

}  // namespace paracal::io

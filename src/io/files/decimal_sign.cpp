#include "paracal/io/decimal_sign.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/tables/columns.hpp"

namespace paracal::io {
namespace {

std::string with_point(std::string_view field) {
  std::string text(field);
  std::ranges::replace(text, ',', '.');
  return text;
}

bool all_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// A comma that may as well separate thousands: "1,125", "-12,000".
bool may_be_thousands(std::string_view field) {
  constexpr std::size_t kGroup = 3;
  if (field.starts_with('+') || field.starts_with('-')) field.remove_prefix(1);
  const std::size_t comma = field.find(',');
  const std::string_view whole = field.substr(0, comma), rest = field.substr(comma + 1);
  return all_digits(whole) && whole.size() <= kGroup && !whole.starts_with('0') && all_digits(rest) &&
         rest.size() == kGroup;
}

/// What a field is as a number.
enum class Form : std::uint8_t { other, point, comma, either };

Form form_of(std::string_view field) {
  const bool has_point = field.find('.') != std::string_view::npos;
  if (field.find(',') == std::string_view::npos) {
    return has_point && finite_number(field) ? Form::point : Form::other;
  }
  if (has_point || !finite_number(with_point(field))) return Form::other;
  return may_be_thousands(field) ? Form::either : Form::comma;
}

}  // namespace

bool may_be_number(std::string_view field) { return finite_number(field) || form_of(field) != Form::other; }

void DecimalSign::look(std::string_view field, int line) {
  if (sign_ != Sign::unknown) return;
  const Form form = form_of(field);
  if (form != Form::point && form != Form::comma) return;
  sign_ = form == Form::comma ? Sign::comma : Sign::point;
  line_ = line;
}

std::optional<double> DecimalSign::number(std::string_view field) const {
  if (sign_ != Sign::comma) return finite_number(field);
  if (field.find('.') != std::string_view::npos) return std::nullopt;
  return finite_number(with_point(field));
}

std::string DecimalSign::why_not(std::string_view field) const {
  const Form form = form_of(field);
  if (form == Form::other) return {};
  if (sign_ == Sign::comma) {
    return line_ == 0 ? " (--decimal-comma is given)" : fmt::format(" (line {} has a decimal comma)", line_);
  }
  if (sign_ == Sign::point) return fmt::format(" (line {} has a decimal point)", line_);
  if (form == Form::comma) return " (for decimal commas add --decimal-comma)";
  std::string whole(field);
  std::erase(whole, ',');
  return fmt::format(" ({} or {}? For decimal commas add --decimal-comma)", with_point(field), whole);
}

}  // namespace paracal::io

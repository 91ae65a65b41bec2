#include "gcode_expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "io/letters.hpp"

namespace paracal::io {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kFirstOfController = 5000;
constexpr int kLastLocal = 30;

double truth(bool is_true) { return is_true ? 1.0 : 0.0; }

using Binary = double (*)(double, double);
struct Operator {
  std::string_view name;
  int rank;  ///< the higher binds the stronger; equal ones from left to right
  Binary apply;
};

constexpr double kSame = 1e-6;  // of EQ and NE [linuxcnc]

/// Longer names first where one begins another.
const std::array kOperators{
    Operator{"**", 5, [](double a, double b) { return std::pow(a, b); }},
    Operator{"*", 4, [](double a, double b) { return a * b; }},
    Operator{"/", 4, [](double a, double b) { return a / b; }},
    Operator{"MOD", 4,
             [](double a, double b) {
               const double rest = std::fmod(a, b);
               return rest < 0.0 ? rest + std::abs(b) : rest;
             }},
    Operator{"+", 3, [](double a, double b) { return a + b; }},
    Operator{"-", 3, [](double a, double b) { return a - b; }},
    Operator{"EQ", 2, [](double a, double b) { return truth(std::abs(a - b) < kSame); }},
    Operator{"NE", 2, [](double a, double b) { return truth(std::abs(a - b) >= kSame); }},
    Operator{"GT", 2, [](double a, double b) { return truth(a > b); }},
    Operator{"GE", 2, [](double a, double b) { return truth(a >= b); }},
    Operator{"LT", 2, [](double a, double b) { return truth(a < b); }},
    Operator{"LE", 2, [](double a, double b) { return truth(a <= b); }},
    Operator{"AND", 1, [](double a, double b) { return truth(a != 0.0 && b != 0.0); }},
    Operator{"XOR", 1, [](double a, double b) { return truth((a != 0.0) != (b != 0.0)); }},
    Operator{"OR", 1, [](double a, double b) { return truth(a != 0.0 || b != 0.0); }},
};

struct Function {
  std::string_view name;
  double (*apply)(double);
};

const std::array kFunctions{
    Function{"ABS", [](double a) { return std::abs(a); }},
    Function{"ACOS", [](double a) { return std::acos(a) / kDegree; }},
    Function{"ASIN", [](double a) { return std::asin(a) / kDegree; }},
    Function{"COS", [](double a) { return std::cos(a * kDegree); }},
    Function{"EXP", [](double a) { return std::exp(a); }},
    Function{"FIX", [](double a) { return std::floor(a); }},
    Function{"FUP", [](double a) { return std::ceil(a); }},
    Function{"LN", [](double a) { return std::log(a); }},
    Function{"ROUND", [](double a) { return std::round(a); }},
    Function{"SIN", [](double a) { return std::sin(a * kDegree); }},
    Function{"SQRT", [](double a) { return std::sqrt(a); }},
    Function{"TAN", [](double a) { return std::tan(a * kDegree); }},
};

}  // namespace

/// Reads from left to right; not a number wherever something is unknown or wrong.
class ExpressionReader {
 public:
  ExpressionReader(std::string_view text, const GcodeParameters& parameters) : text_(text), parameters_(parameters) {}

  double all() {
    const double result = value();
    return at_ == text_.size() ? result : kUnknown;
  }

  /// What a parameter is called: digits or <name>.
  std::string name() {
    if (!take("#")) return {};
    if (next() == '<') {
      const std::size_t end = text_.find('>', at_);
      if (end == std::string_view::npos) return fail();
      const std::string_view result = text_.substr(at_, end + 1 - at_);
      at_ = end + 1;
      return std::string(result);
    }
    const double number = next() == '[' || next() == '#' ? value() : digits();
    if (!(number >= 1.0 && number < 1e5) || number != std::floor(number)) return fail();
    return std::to_string(static_cast<int>(number));
  }

 private:
  static constexpr int kDeepest = 100;

  char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool take(std::string_view what) {
    if (at_ > text_.size() || !text_.substr(at_).starts_with(what)) return false;
    at_ += what.size();
    return true;
  }

  std::string fail() {
    at_ = text_.size() + 1;
    return {};
  }

  double digits() {
    double result = kUnknown;
    const auto [end, error] = std::from_chars(text_.data() + std::min(at_, text_.size()), text_.data() + text_.size(),
                                              result, std::chars_format::fixed);
    if (error != std::errc{}) return kUnknown;
    at_ = static_cast<std::size_t>(end - text_.data());
    return result;
  }

  double value() {
    if (++depth_ > kDeepest) return kUnknown;
    const double result = take("-") ? -positive() : (take("+"), positive());
    --depth_;
    return result;
  }

  double positive() {
    if (next() == '[') return brackets();
    if (next() == '#') return parameter();
    if (take("EXISTS")) {
      fail();
      return kUnknown;
    }
    if (take("ATAN")) {
      const double y = brackets();
      if (!take("/")) return kUnknown;
      return std::atan2(y, brackets()) / kDegree;
    }
    for (const Function& function : kFunctions) {
      if (take(function.name)) return next() == '[' ? function.apply(brackets()) : kUnknown;
    }
    return digits();
  }

  double parameter() {
    const std::string called = name();
    const auto found = parameters_.known_.find(called);
    return found == parameters_.known_.end() ? kUnknown : found->second;
  }

  const Operator* take_operator() {
    for (const Operator& one : kOperators) {
      if (take(one.name)) return &one;
    }
    return nullptr;
  }

  double brackets() {
    if (!take("[")) return kUnknown;
    std::vector<double> values{value()};
    std::vector<const Operator*> waiting;
    const auto apply_last = [&] {
      const double right = values.back();
      values.pop_back();
      // What is unknown stays so, whatever the operator makes of it.
      values.back() =
          std::isnan(values.back()) || std::isnan(right) ? kUnknown : waiting.back()->apply(values.back(), right);
      waiting.pop_back();
    };
    while (!take("]")) {
      const Operator* const one = take_operator();
      if (one == nullptr) return kUnknown;
      while (!waiting.empty() && waiting.back()->rank >= one->rank) apply_last();
      waiting.push_back(one);
      values.push_back(value());
    }
    while (!waiting.empty()) apply_last();
    return values.front();
  }

  std::string_view text_;
  const GcodeParameters& parameters_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

std::optional<double> GcodeParameters::value(std::string_view text) const {
  const std::string written = without_blanks_in_upper_case(text);
  const double result = ExpressionReader(written, *this).all();
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

std::string GcodeParameters::name_of(std::string_view text) const {
  const std::string written = without_blanks_in_upper_case(text);
  return ExpressionReader(written, *this).name();
}

bool GcodeParameters::is_of_controller(std::string_view text) const {
  const std::string name = name_of(text);
  return name.starts_with("<_") || (!name.empty() && name.front() != '<' && std::stoi(name) >= kFirstOfController);
}

bool GcodeParameters::is_local(const std::string& name) {
  if (name.starts_with('<')) return !name.starts_with("<_");
  return std::stoi(name) <= kLastLocal;
}

GcodeParameters GcodeParameters::enter(std::span<const double> arguments) {
  GcodeParameters callers = *this;
  std::erase_if(known_, [](const auto& one) { return is_local(one.first); });
  for (std::size_t k = 0; k < arguments.size(); ++k) known_[std::to_string(k + 1)] = arguments[k];
  return callers;
}

void GcodeParameters::leave(GcodeParameters&& callers) {
  std::erase_if(known_, [](const auto& one) { return is_local(one.first); });
  std::erase_if(callers.known_, [](const auto& one) { return !is_local(one.first); });
  known_.merge(callers.known_);
}

bool GcodeParameters::apply(GcodeBlock& block) {
  for (GcodeWord& word : block.words) {
    if (word.kind != GcodeWord::Kind::expression) continue;
    const std::optional<double> known = value(block.text.substr(word.begin, word.end - word.begin));
    if (!known) continue;
    word.kind = GcodeWord::Kind::number;
    word.value = *known;
  }
  std::vector<std::pair<std::string, std::optional<double>>> assigned;
  for (const auto& [parameter, expression] : block.assignments) {
    assigned.emplace_back(name_of(parameter), block.is_optional ? std::nullopt : value(expression));
  }
  bool moves_origin = false;
  for (const auto& [name, known] : assigned) {
    const bool is_number = !name.empty() && name.front() != '<';
    const bool is_controllers = is_number && std::stoi(name) >= kFirstOfController;
    moves_origin |= is_controllers || name.empty();
    if (name.empty()) known_.clear();
    known_.erase(name);
    if (known && !is_controllers && !name.empty()) known_[name] = *known;
  }
  return moves_origin;
}

}  // namespace paracal::io

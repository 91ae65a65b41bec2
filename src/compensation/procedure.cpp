#include "procedure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <map>
#include <tuple>
#include <utility>

namespace paracal::compensation_detail {
namespace {

/// Longer formulas are given a name before they become part of another.
constexpr std::size_t kLongestOperand = 40;

bool is_leaf(Operation operation) { return operation == Operation::constant || operation == Operation::symbol; }

bool is_arithmetic(Operation operation) {
  return operation == Operation::sum || operation == Operation::difference || operation == Operation::product ||
         operation == Operation::quotient;
}

bool commutes(Operation operation) { return operation == Operation::sum || operation == Operation::product; }

}  // namespace

/// Gives equal formulas one number.
class Procedure::Numbering {
 public:
  explicit Numbering(std::vector<Value>& values) : values_(values) {}

  std::size_t number(const Expression& expression) {
    const auto known = of_node_.find(&*expression);
    if (known != of_node_.end()) return known->second;
    Value value{expression->operation, expression->value, expression->symbol, {}, 0};
    for (const Expression& operand : expression->operands) value.operands.push_back(number(operand));
    return of_node_.emplace(&*expression, number(std::move(value))).first->second;
  }

 private:
  using Key = std::tuple<Operation, std::uint64_t, Symbol, std::vector<std::size_t>>;

  std::size_t number(Value value) {
    std::vector<std::size_t> operands = value.operands;
    if (commutes(value.operation)) std::ranges::sort(operands);
    const Key key{value.operation, std::bit_cast<std::uint64_t>(value.constant), value.symbol, std::move(operands)};
    const auto [at, is_new] = of_key_.emplace(key, values_.size());
    if (is_new) {
      for (const std::size_t operand : value.operands) ++values_[operand].uses;
      values_.push_back(std::move(value));
    }
    return at->second;
  }

  std::vector<Value>& values_;
  std::map<const Expression::Node*, std::size_t> of_node_;
  std::map<Key, std::size_t> of_key_;
};

Procedure::Procedure(std::vector<Result> results) : results_(std::move(results)) {
  Numbering numbering(values_);
  for (const Result& result : results_) {
    std::vector<std::size_t>& numbers = numbers_.emplace_back();
    for (const Expression& value : result.values) {
      numbers.push_back(numbering.number(value));
      ++values_[numbers.back()].uses;
    }
  }
}

OperationCount Procedure::count() const {
  OperationCount count;
  for (const Value& value : values_) {
    switch (value.operation) {
      case Operation::constant:
      case Operation::symbol:
        break;
      case Operation::product:
        ++count.multiplications;
        break;
      case Operation::quotient:
        ++count.divisions;
        break;
      case Operation::square_root:
        ++count.square_roots;
        break;
      case Operation::sine:
      case Operation::cosine:
      case Operation::arctangent:
        ++count.functions;
        break;
      case Operation::turn_cosine:
      case Operation::turn_sine:
        ++count.turns;
        break;
      case Operation::negative:
      case Operation::sum:
      case Operation::difference:
      case Operation::where_negative:
        ++count.additions;
    }
  }
  return count;
}

std::set<Symbol> Procedure::symbols() const {
  std::set<Symbol> found;
  for (const Value& value : values_) {
    if (value.operation == Operation::symbol) found.insert(value.symbol);
  }
  return found;
}

bool Procedure::is_never_negative(std::size_t number) const {
  const Value& value = values_[number];
  const auto& operands = value.operands;
  switch (value.operation) {
    case Operation::constant:
      return value.constant >= 0.0;
    case Operation::square_root:
      return true;
    case Operation::product:
      return operands[0] == operands[1];
    case Operation::sum:
      return is_never_negative(operands[0]) && is_never_negative(operands[1]);
    default:
      return false;
  }
}

bool Procedure::replaces_input(const Result& result) const {
  return std::ranges::any_of(values_, [&](const Value& value) {
    return value.operation == Operation::symbol && value.symbol.limb < 0 && value.symbol.name == result.name;
  });
}

/// Writes values in their order: what is used once and short stays part of the formula that uses it.
class Procedure::Writer {
 public:
  Writer(const Procedure& procedure, const Language& language)
      : procedure_(procedure), language_(language), named_(procedure.values_.size()) {
    has_name_ = guarded_ = named_;
    formulas_.resize(named_.size());
    for (std::size_t k = 0; k < procedure.results_.size(); ++k) {
      if (!procedure.replaces_input(procedure.results_[k])) continue;
      for (const std::size_t number : procedure.numbers_[k]) named_[number] = true;
    }
    for (std::size_t number = 0; number < named_.size(); ++number) write(number);
    assign();
  }

  std::vector<std::string> lines;
  std::size_t locals = 0;

 private:
  enum class Strength : std::uint8_t { sum, product, atom };
  struct Formula {
    std::string text;
    Strength strength = Strength::atom;
  };

  std::string within(std::size_t number, Strength needed) const {
    const Formula& formula = formulas_[number];
    return formula.strength < needed ? fmt::format("({})", formula.text) : formula.text;
  }

  Formula arithmetic(const Value& value) const {
    const bool adds = value.operation == Operation::sum || value.operation == Operation::difference;
    const Strength own = adds ? Strength::sum : Strength::product;
    const char sign = value.operation == Operation::sum          ? '+'
                      : value.operation == Operation::difference ? '-'
                      : value.operation == Operation::product    ? '*'
                                                                 : '/';
    const bool is_stated = adds && language_.states_precedence();
    const auto left = [&](std::size_t number) {
      const bool is_product = formulas_[number].strength == Strength::product;
      return within(number, is_stated && is_product ? Strength::atom : own);
    };
    const Strength right = adds && !is_stated ? Strength::product : Strength::atom;
    return {fmt::format("{} {} {}", left(value.operands[0]), sign, within(value.operands[1], right)), own};
  }

  std::string_view function_of(Operation operation) const {
    const FunctionNames names = language_.functions();
    switch (operation) {
      case Operation::square_root:
        return names.square_root;
      case Operation::sine:
        return names.sine;
      case Operation::cosine:
        return names.cosine;
      case Operation::arctangent:
        return names.arctangent;
      case Operation::turn_cosine:
        return names.turn_cosine;
      default:
        assert(operation == Operation::turn_sine);
        return names.turn_sine;
    }
  }

  Formula formula_of(const Value& value) const {
    if (value.operation == Operation::constant) {
      return {language_.number(value.constant), value.constant < 0.0 ? Strength::sum : Strength::atom};
    }
    if (value.operation == Operation::symbol) return {language_.symbol(value.symbol)};
    if (value.operation == Operation::negative)
      return {fmt::format("-{}", within(value.operands[0], Strength::atom)), Strength::sum};
    if (is_arithmetic(value.operation)) return arithmetic(value);
    std::vector<std::string> operands;
    for (const std::size_t operand : value.operands) operands.push_back(formulas_[operand].text);
    if (value.operation == Operation::where_negative) {
      return {language_.choice(operands[0], operands[1], operands[2])};
    }
    return {fmt::format("{}({})", function_of(value.operation), fmt::join(operands, ", "))};
  }

  /// Statements that keep an operation from what has no answer; its operand gets a name to be changed by.
  void guard(const Value& value) {
    std::size_t operand = 0;
    std::string (Language::*statements)(const std::string&) const = nullptr;
    if (value.operation == Operation::square_root && !procedure_.is_never_negative(value.operands[0])) {
      operand = value.operands[0];
      statements = &Language::guard_root;
    } else if (value.operation == Operation::quotient) {
      operand = value.operands[1];
      statements = &Language::guard_divisor;
    }
    const Value& guarded = procedure_.values_[operand];
    const bool is_given = guarded.operation == Operation::constant || guarded.symbol.limb >= 0;
    if (statements == nullptr || is_given || guarded_[operand] || (language_.*statements)("").empty()) return;
    if (!is_leaf(guarded.operation) && !has_name_[operand]) name(operand);
    lines.push_back((language_.*statements)(formulas_[operand].text));
    guarded_[operand] = true;
  }

  void name(std::size_t number) {
    const std::string local = fmt::format("v{}", ++locals);
    lines.push_back(language_.define(local, formulas_[number].text));
    formulas_[number] = {local};
    has_name_[number] = true;
  }

  void write(std::size_t number) {
    const Value& value = procedure_.values_[number];
    guard(value);
    formulas_[number] = formula_of(value);
    if (value.operation == Operation::constant) return;
    const bool is_shared = value.uses > 1 || formulas_[number].text.size() > kLongestOperand;
    if (named_[number] || (is_shared && value.operation != Operation::symbol)) name(number);
  }

  void assign() {
    for (std::size_t k = 0; k < procedure_.results_.size(); ++k) {
      const bool is_single = procedure_.numbers_[k].size() == 1;
      int index = is_single ? -1 : 0;
      for (const std::size_t number : procedure_.numbers_[k]) {
        const Symbol target{.name = procedure_.results_[k].name, .limb = -1, .index = index++};
        lines.push_back(language_.assign(language_.symbol(target), formulas_[number].text));
      }
    }
  }

  const Procedure& procedure_;
  const Language& language_;
  std::vector<bool> named_;  ///< must have one: they replace inputs that others still need
  std::vector<bool> has_name_, guarded_;
  std::vector<Formula> formulas_;
};

std::string Procedure::text(const Language& language, std::string_view indent) const {
  std::string text;
  for (const std::string& line : Writer(*this, language).lines) text += fmt::format("{}{}\n", indent, line);
  return text;
}

std::size_t Procedure::locals(const Language& language) const { return Writer(*this, language).locals; }

}  // namespace paracal::compensation_detail

#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "expression.hpp"

namespace paracal::compensation_detail {

/// Numbers that a procedure leaves behind: name[0], name[1], ..., or name alone where there is but one.
struct Result {
  std::string_view name;  ///< of static storage; that of an input where it replaces it
  std::vector<Expression> values;
};

/// How often a procedure does what: what its run costs.
struct OperationCount {
  std::size_t additions = 0, multiplications = 0, divisions = 0, square_roots = 0, functions = 0;
  std::size_t turns = 0;  ///< by series, whose own operations come on top
};

/// What a language calls functions of numbers.
struct FunctionNames {
  std::string_view square_root, sine, cosine, arctangent;
  // Functions of the template, the same in each.
  std::string_view turn_cosine = "paracal_turn_cosine", turn_sine = "paracal_turn_sine";
};

/// How formulas are written in one language.
class Language {
 public:
  virtual ~Language() = default;

  /// Products within sums stand in parentheses, as MISRA C:2012 wants it (12.1).
  virtual bool states_precedence() const { return false; }
  virtual std::string number(double value) const = 0;
  virtual std::string symbol(const Symbol& symbol) const = 0;
  virtual FunctionNames functions() const = 0;
  /// number < 0 ? negative : other
  virtual std::string choice(const std::string& number, const std::string& negative,
                             const std::string& other) const = 0;
  /// A statement that gives a local number its value.
  virtual std::string define(const std::string& local, const std::string& formula) const = 0;
  virtual std::string assign(const std::string& target, const std::string& formula) const = 0;
  /// Statements before a root is taken of a number that may be negative; empty: the language has NaN for it.
  virtual std::string guard_root(const std::string& number) const = 0;
  /// Statements before a division by a number that may be zero.
  virtual std::string guard_divisor(const std::string& number) const = 0;
};

/// Formulas in an order in which they can be computed, each value once: straight lines without a branch.
class Procedure {
 public:
  explicit Procedure(std::vector<Result> results);

  /// Statements, a line each, the first `locals()` of them with locals v1, v2, ...
  std::string text(const Language& language, std::string_view indent) const;
  OperationCount count() const;
  std::size_t locals(const Language& language) const;
  std::set<Symbol> symbols() const;

 private:
  struct Value {
    Operation operation;
    double constant = 0.0;
    Symbol symbol;
    std::vector<std::size_t> operands;
    std::size_t uses = 0;
  };
  class Numbering;
  class Writer;

  bool is_never_negative(std::size_t number) const;
  bool replaces_input(const Result& result) const;

  std::vector<Result> results_;
  std::vector<std::vector<std::size_t>> numbers_;  ///< of each result: its values
  std::vector<Value> values_;                      ///< operands before what is made of them
};

}  // namespace paracal::compensation_detail

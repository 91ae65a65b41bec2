#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "paracal/mechanism/machine_closure.hpp"

// A number of machine_closure.hpp's templates that remembers how it came about: run once on it, they become formulas
// that a printer of a controller's language writes down (procedure.hpp).

namespace paracal::compensation_detail {

enum class Operation : std::uint8_t {
  constant,
  symbol,
  negative,
  sum,
  difference,
  product,
  quotient,
  square_root,
  sine,
  cosine,
  arctangent,      ///< of y, x
  where_negative,  ///< a < 0 ? b : c
  turn_cosine,     ///< cos of an angle that is nearly always small: by turn_by_series within kSeriesReach
  turn_sine,
};

/// What a formula does not compute: an input, `name[index]`, or, of a limb, one of its constants.
struct Symbol {
  std::string_view name;  ///< of static storage
  int limb = -1;          ///< from 0; -1: an input
  int index = -1;         ///< -1: a single number
  double value = 0.0;     ///< of a constant

  auto operator<=>(const Symbol&) const = default;  // NOLINT(modernize-use-nullptr): takes its 0 for a pointer
};

class Expression {
 public:
  struct Node;

  Expression() : Expression(0.0) {}
  explicit Expression(double value);
  explicit Expression(const Symbol& symbol);
  Expression(Operation operation, std::vector<Expression> operands);

  const Node& operator*() const { return *node_; }
  const Node* operator->() const { return node_.get(); }
  bool is(double value) const;

 private:
  std::shared_ptr<const Node> node_;
};

struct Expression::Node {
  Operation operation;
  double value = 0.0;  ///< of a number that is written as such
  Symbol symbol;
  std::vector<Expression> operands;
};

// What is known beforehand is not asked for at run time: operations on constants, and those with 0, 1 and -1.
Expression operator-(const Expression& a);
Expression operator+(const Expression& a, const Expression& b);
Expression operator-(const Expression& a, const Expression& b);
Expression operator*(const Expression& a, const Expression& b);
Expression operator/(const Expression& a, const Expression& b);

Expression sqrt(const Expression& a);
Expression sin(const Expression& a);
Expression cos(const Expression& a);
Expression atan2(const Expression& y, const Expression& x);
/// Of a size that is not negative, and signs other than those of zeros.
Expression copysign(const Expression& size, const Expression& sign);

int as_integer(const Expression& constant);

/// By functions of the template; of a constant its cosine and sine.
ArmDirection<Expression> turn_by(const Expression& angle);

}  // namespace paracal::compensation_detail

#include "expression.hpp"

#include <cmath>
#include <utility>

namespace paracal::compensation_detail {

Expression::Expression(double value) : node_(std::make_shared<Node>(Node{Operation::constant, value, {}, {}})) {}

Expression::Expression(const Symbol& symbol)
    : node_(std::make_shared<Node>(Node{Operation::symbol, 0.0, symbol, {}})) {}

Expression::Expression(Operation operation, std::vector<Expression> operands)
    : node_(std::make_shared<Node>(Node{operation, 0.0, {}, std::move(operands)})) {}

bool Expression::is(double value) const { return node_->operation == Operation::constant && node_->value == value; }

namespace {

bool is_constant(const Expression& a) { return a->operation == Operation::constant; }

bool is_negative(const Expression& a) { return a->operation == Operation::negative; }

}  // namespace

Expression operator-(const Expression& a) {
  if (is_constant(a)) return Expression(-a->value);
  if (is_negative(a)) return a->operands[0];
  return {Operation::negative, {a}};
}

Expression operator+(const Expression& a, const Expression& b) {
  if (is_constant(a) && is_constant(b)) return Expression(a->value + b->value);
  if (a.is(0.0)) return b;
  if (b.is(0.0)) return a;
  if (is_negative(b)) return a - b->operands[0];
  if (is_negative(a)) return b - a->operands[0];
  return {Operation::sum, {a, b}};
}

Expression operator-(const Expression& a, const Expression& b) {
  if (is_constant(a) && is_constant(b)) return Expression(a->value - b->value);
  if (a.is(0.0)) return -b;
  if (b.is(0.0)) return a;
  return {Operation::difference, {a, b}};
}

Expression operator*(const Expression& a, const Expression& b) {
  if (is_constant(a) && is_constant(b)) return Expression(a->value * b->value);
  if (a.is(0.0) || b.is(0.0)) return Expression(0.0);
  if (a.is(1.0)) return b;
  if (b.is(1.0)) return a;
  if (a.is(-1.0)) return -b;
  if (b.is(-1.0)) return -a;
  if (is_negative(a)) return -(a->operands[0] * b);
  if (is_negative(b)) return -(a * b->operands[0]);
  return {Operation::product, {a, b}};
}

Expression operator/(const Expression& a, const Expression& b) {
  if (is_constant(a) && is_constant(b)) return Expression(a->value / b->value);
  if (a.is(0.0)) return a;
  if (b.is(1.0)) return a;
  return {Operation::quotient, {a, b}};
}

Expression sqrt(const Expression& a) {
  if (is_constant(a)) return Expression(std::sqrt(a->value));
  return {Operation::square_root, {a}};
}

Expression sin(const Expression& a) {
  if (is_constant(a)) return Expression(std::sin(a->value));
  return {Operation::sine, {a}};
}

Expression cos(const Expression& a) {
  if (is_constant(a)) return Expression(std::cos(a->value));
  return {Operation::cosine, {a}};
}

ArmDirection<Expression> turn_by(const Expression& angle) {
  if (is_constant(angle)) return closure::turn_by_any(angle);
  return {Expression(Operation::turn_cosine, {angle}), Expression(Operation::turn_sine, {angle})};
}

int as_integer(const Expression& constant) { return static_cast<int>(constant->value); }

Expression atan2(const Expression& y, const Expression& x) { return {Operation::arctangent, {y, x}}; }

Expression copysign(const Expression& size, const Expression& sign) {
  return {Operation::where_negative, {sign, -size, size}};
}

}  // namespace paracal::compensation_detail

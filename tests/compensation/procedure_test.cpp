// Formulas that remember how they came about, and the straight lines that they are printed as.

#include "compensation/procedure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

namespace paracal::compensation_detail::procedure_test {
namespace {

/// As short as a language can be.
class Plain : public Language {
 public:
  explicit Plain(bool states_precedence = false) : states_precedence_(states_precedence) {}

  bool states_precedence() const override { return states_precedence_; }
  std::string number(double value) const override { return fmt::format("{}", value); }
  std::string symbol(const Symbol& symbol) const override {
    return symbol.index < 0 ? std::string(symbol.name) : fmt::format("{}{}", symbol.name, symbol.index);
  }
  FunctionNames functions() const override { return {"f", "f", "f", "f", "f", "f"}; }
  std::string choice(const std::string& number, const std::string& negative, const std::string& other) const override {
    return fmt::format("f({}, {}, {})", number, negative, other);
  }
  std::string define(const std::string& local, const std::string& formula) const override {
    return fmt::format("{} = {}", local, formula);
  }
  std::string assign(const std::string& target, const std::string& formula) const override {
    return fmt::format("{} <- {}", target, formula);
  }
  std::string guard_root(const std::string& number) const override { return number + " >= 0?"; }
  std::string guard_divisor(const std::string& number) const override { return number + " <> 0?"; }

 private:
  bool states_precedence_;
};

const Expression x(Symbol{.name = "x"}), y(Symbol{.name = "y"}), z(Symbol{.name = "z"});

std::string printed(const Expression& value, bool states_precedence = false) {
  return Procedure({{"out", {value}}}).text(Plain(states_precedence), "");
}

TEST(Procedure, KeepsTheOrderOfOperations) {
  EXPECT_EQ(printed(x - (y + z)), "out <- x - (y + z)\n");
  EXPECT_EQ(printed(x - y + z), "out <- x - y + z\n");
  EXPECT_EQ(printed((x + y) * z), "out <- (x + y) * z\n");
  EXPECT_EQ(printed(x * (y * z)), "out <- x * (y * z)\n");
  EXPECT_EQ(printed(x * y + z), "out <- x * y + z\n");
  EXPECT_EQ(printed(x + y * z, true), "out <- x + (y * z)\n");
  EXPECT_EQ(printed(x * y - z, true), "out <- (x * y) - z\n");
  EXPECT_EQ(printed(-(x * y)), "out <- -(x * y)\n");
  EXPECT_EQ(printed(x * Expression(-2.0)), "out <- x * (-2)\n");
}

TEST(Procedure, ComputesNothingThatIsKnown) {
  const Expression zero, one(1.0);
  EXPECT_EQ(printed(x * zero + y * one - zero / z), "out <- y\n");
  EXPECT_EQ(printed(zero - x * Expression(-1.0)), "out <- x\n");
  EXPECT_EQ(printed(sqrt(Expression(4.0)) + Expression(3.0)), "out <- 5\n");
  EXPECT_EQ(printed(x + Expression(-1.0) * y), "out <- x - y\n");
}

TEST(Procedure, ComputesTheSameOnce) {
  const Procedure procedure({{"out", {x * y + z, z + y * x, z - x * y}}});
  EXPECT_EQ(procedure.text(Plain(), "  "),
            "  v1 = x * y\n  v2 = v1 + z\n  out0 <- v2\n  out1 <- v2\n  out2 <- z - v1\n");
  EXPECT_EQ(procedure.locals(Plain()), 2U);
  const OperationCount count = procedure.count();
  EXPECT_EQ(count.additions, 2U);
  EXPECT_EQ(count.multiplications, 1U);
  EXPECT_EQ(count.divisions + count.square_roots + count.functions + count.turns, 0U);
}

/// What replaces its own inputs is computed from the old ones.
TEST(Procedure, ReplacesInputsLast) {
  const Expression a(Symbol{.name = "a", .limb = -1, .index = 0}), b(Symbol{.name = "a", .limb = -1, .index = 1});
  EXPECT_EQ(Procedure({{"a", {a + b, a}}}).text(Plain(), ""), "v1 = a0\nv2 = v1 + a1\na0 <- v2\na1 <- v1\n");
  EXPECT_EQ(Procedure({{"c", {a + b, a}}}).text(Plain(), ""), "c0 <- a0 + a1\nc1 <- a0\n");
}

TEST(Procedure, GuardsWhatMayHaveNoAnswer) {
  EXPECT_EQ(printed(sqrt(x * y)), "v1 = x * y\nv1 >= 0?\nout <- f(v1)\n");
  EXPECT_EQ(printed(sqrt(x * x + y * y)), "out <- f(x * x + y * y)\n");
  EXPECT_EQ(printed(sqrt(x * x + y)), "v1 = x * x + y\nv1 >= 0?\nout <- f(v1)\n");
  EXPECT_EQ(printed(x / (y + z)), "v1 = y + z\nv1 <> 0?\nout <- x / v1\n");
  EXPECT_EQ(printed(x / z + y / z), "z <> 0?\nout <- x / z + y / z\n");
  EXPECT_EQ(printed(x / Expression(3.0)), "out <- x / 3\n");
  EXPECT_EQ(printed(x / Expression(Symbol{.name = "arm", .limb = 2, .value = 375.0})), "out <- x / arm\n");
}

}  // namespace
}  // namespace paracal::compensation_detail::procedure_test

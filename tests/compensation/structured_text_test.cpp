// The interpreter that judges exported Structured Text: it computes, and it refuses what a controller's compiler would.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "support/structured_text/program.hpp"

namespace paracal::test::structured_text_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string block(const std::string& variables, const std::string& statements) {
  return "FUNCTION_BLOCK one\nVAR_INPUT\n  a : LREAL;\nEND_VAR\nVAR_OUTPUT\n  b : LREAL;\n  n : INT;\n  yes : BOOL;\n"
         "END_VAR\nVAR CONSTANT\n  two : LREAL := 2.0;\nEND_VAR\nVAR\n  k : INT;\n  row : ARRAY [1..3] OF LREAL;\n" +
         variables + "END_VAR\n" + statements + "\nEND_FUNCTION_BLOCK\n";
}

double b_of(const std::string& statements, double a = 0.0) {
  FunctionBlock one(block("", statements), "one");
  one.set("a", a);
  one.run();
  return one.get("b");
}

TEST(StructuredText, Computes) {
  EXPECT_EQ(b_of("b := two + 3.0 * a - 8.0 / 2.0 / 2.0;", 5.0), 15.0);
  EXPECT_EQ(b_of("b := -a * 2.0 - (1.0 - 2.0 - 3.0);", 1.5), 1.0);
  EXPECT_EQ(b_of("B := SQRT(A) + ABS(-1.0) + SIN(0.0) + COS(0.0);", 9.0), 5.0);
  EXPECT_EQ(b_of("b := 4.0 * ATAN(1.0);"), 4.0 * std::atan(1.0));
  EXPECT_EQ(b_of("b := SEL(a < 0.0, 1.0, 2.0);", -1.0), 2.0);
  EXPECT_EQ(b_of("b := SEL(a < 0.0, 1.0, 2.0E0);", 1.0), 1.0);
  EXPECT_EQ(b_of("IF a > 1.0 THEN b := 1.0; ELSIF a = 1.0 THEN b := 2.0; ELSE b := 3.0; END_IF;", 1.0), 2.0);
  EXPECT_EQ(b_of("IF (a >= 1.0) AND NOT (a <> 1.0) OR FALSE THEN b := 7.0; END_IF;", 1.0), 7.0);
  EXPECT_EQ(b_of("FOR k := 1 TO 3 DO row[k] := a; END_FOR; b := row[1] + row[2] + row[4 - 1];", 2.0), 6.0);
  EXPECT_EQ(b_of("WHILE b < 5.0 DO b := b + a; (* twice *) IF b > 2.0 THEN EXIT; END_IF; END_WHILE;", 2.0), 4.0);
  EXPECT_EQ(b_of("b := 1.0; RETURN; b := 2.0;"), 1.0);
}

TEST(StructuredText, BlocksRememberAndFunctionsForget) {
  const std::string text =
      "FUNCTION twice : LREAL\nVAR_INPUT\n  x : LREAL;\nEND_VAR\nVAR\n  sum : LREAL;\nEND_VAR\n  sum := sum + x + x;\n"
      "  twice := sum;\nEND_FUNCTION\n"
      "FUNCTION_BLOCK counter\nVAR_INPUT\n  more : LREAL;\nEND_VAR\nVAR_OUTPUT\n  total : LREAL := 1.0;\nEND_VAR\n"
      "  total := total + twice(more);\nEND_FUNCTION_BLOCK\n" +
      block("  first, second : counter;\n",
            "first(more := a); first(); second(more := 1.0); b := first.total + 100.0 * second.total;");
  FunctionBlock one(text, "one");
  one.set("a", 5.0);
  one.run();
  EXPECT_EQ(one.get("b"), 1.0 + 10.0 + 10.0 + 100.0 * 3.0);
  one.run();
  EXPECT_EQ(one.get("b"), 21.0 + 20.0 + 100.0 * 5.0);
}

/// Each is refused for the reason given.
TEST(StructuredText, RefusesWhatControllersRefuse) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"c := 1.0;", "C is not declared"},
      {"b := 1;", "another type"},
      {"b := n;", "another type"},
      {"n := 1.0;", "another type"},
      {"yes := 1;", "another type"},
      {"b := a + 1;", "two types"},
      {"n := n / 2;", "division of INT"},
      {"n := 40000;", "no INT"},
      {"b := a", "expected ;"},
      {"IF a > 0.0 THEN b := 1.0; END_IF", "expected ;"},
      {"IF a THEN b := 1.0; END_IF;", "another type"},
      {"IF a > 0.0 THEN END_IF;", "expected a statement"},
      {"b := a < 1.0 AND TRUE;", "another type"},
      {"yes := a AND TRUE;", "AND is of BOOL"},
      {"yes := TRUE OR a;", "OR is of BOOL"},
      {"yes := NOT a;", "NOT is of BOOL"},
      {"yes := TRUE < FALSE;", "no order"},
      {"b := 1.;", "like 1.0E-5"},
      {"b := 1e5;", "like 1.0E-5"},
      {"b := 1.0e5;", "like 1.0E-5"},
      {"b := .5;", "no value"},
      {"b := a * -1.0;", "no value"},
      {"b := a + -1.0;", "two signs"},
      {"b := a ** 2.0;", "no value"},
      {"b := POW(a, 2.0);", "not declared"},
      {"b := EXPT(a, 2.0);", "not part of the subset"},
      {"b := ATAN2(a, a);", "not part of the subset"},
      {"b := SQRT(4);", "another type"},
      {"b := SEL(a, 1.0, 2.0);", "another type"},
      {"a := 1.0;", "not to be changed"},
      {"two := 1.0;", "not to be changed"},
      {"FOR k := 1 TO 3 DO k := 2; END_FOR;", "not to be changed"},
      {"FOR k := 1 TO 3 DO FOR k := 1 TO 2 DO b := a; END_FOR; END_FOR;", "counts already"},
      {"FOR b := 1 TO 3 DO n := 1; END_FOR;", "a local INT"},
      {"EXIT;", "outside of a loop"},
      {"row := row;", "expected ["},
      {"b := row[1.0];", "another type"},
      {"b := 1.0; // twice", "no comment everywhere"},
      {"b := 1.0; (* a (* b *) *)", "within a comment"},
      {"b := 1.0; (* a", "without end"},
      {"b := \"a\";", "nothing of the language"},
      {"a__b := 1.0;", "some tool does not take the name"},
      {"b_ := 1.0;", "some tool does not take the name"},
      {"a23456789012345678901234567890123 := 1.0;", "some tool does not take the name"},
      {"type := 1.0;", "expected a name"},
  };
  for (const auto& [statements, reason] : cases) {
    const std::string program = block("", statements);
    EXPECT_THAT([&] { FunctionBlock(program, "one"); }, ThrowsMessage<StructuredTextError>(HasSubstr(reason)))
        << statements;
  }
}

TEST(StructuredText, RefusesDeclarations) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"  B : LREAL;\n", "declared twice"},
      {"  c : REAL;\n", "no type of the subset"},
      {"  c : LREAL := 1;\n", "no value of the type"},
      {"  c : INT := 1.0;\n", "no value of the type"},
      {"  c : BOOL := 1;\n", "no value of the type"},
      {"  c : ARRAY [1..3] OF LREAL := [1.0, 2.0];\n", "not as many values"},
      {"  c : ARRAY [3..1] OF LREAL;\n", "an array of nothing"},
      {"  c : other;\n", "no such function block"},
      {"  c : POINTER TO LREAL;\n", "no type of the subset"},
      {"  c : LREAL\n", "expected ;"},
      {"  step : LREAL;\n", "expected a name"},
  };
  for (const auto& [variables, reason] : cases) {
    const std::string program = block(variables, "b := a;");
    EXPECT_THAT([&] { FunctionBlock(program, "one"); }, ThrowsMessage<StructuredTextError>(HasSubstr(reason)))
        << variables;
  }
  EXPECT_THAT([] { FunctionBlock("FUNCTION_BLOCK one\nVAR_OUTPUT\n  c : ARRAY [1..2] OF LREAL;\nEND_VAR\n", "one"); },
              ThrowsMessage<StructuredTextError>(HasSubstr("line 3: some tool takes no arrays")));
  EXPECT_THAT([] { FunctionBlock("FUNCTION_BLOCK one\nVAR CONSTANT\n  c : LREAL;\nEND_VAR\n", "one"); },
              ThrowsMessage<StructuredTextError>(HasSubstr("a constant without a value")));
  EXPECT_THAT([] { FunctionBlock("METHOD one\n", "one"); },
              ThrowsMessage<StructuredTextError>(HasSubstr("expected a function or a function block")));
}

/// A task that traps floating-point exceptions would stop.
TEST(StructuredText, StopsWhereAControllerMight) {
  const auto running = [](const std::string& statements, double a) { return [=] { b_of(statements, a); }; };
  const auto stops = [](const char* why) { return ThrowsMessage<StructuredTextError>(HasSubstr(why)); };
  EXPECT_THAT(running("b := SQRT(a);", -1.0), stops("SQRT gives"));
  EXPECT_THAT(running("b := 1.0 / a;", 0.0), stops("/ gives inf"));
  EXPECT_THAT(running("b := a * a;", 1e200), stops("* gives inf"));
  EXPECT_THAT(running("b := a + 1.0;", std::nan("")), stops("+ gives nan"));
  EXPECT_THAT(running("n := 5; b := row[n];", 0.0), stops("ROW[5] is not there"));
  EXPECT_THAT(running("WHILE a < 1.0 DO b := a; END_WHILE;", 0.0), stops("a loop without end"));
  for (const char* bounds : {"2 TO 2", "n + 2 TO 2", "3 TO 2"}) {
    EXPECT_THAT(running(fmt::format("n := 0; FOR k := {} DO b := a; END_FOR;", bounds), 0.0),
                stops("a loop that matiec does not run"));
  }
  EXPECT_EQ(b_of("IF NOT (ABS(a) < 1.0) THEN b := 1.0; END_IF;", std::nan("")), 1.0);
}

}  // namespace
}  // namespace paracal::test::structured_text_test

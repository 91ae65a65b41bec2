#pragma once

#include <set>
#include <utility>

#include "program.hpp"

namespace paracal::test {

/// Tokens one after the other.
class TokenStream {
 public:
  explicit TokenStream(std::vector<Token> tokens) : tokens_(std::move(tokens)) {}

  const Token& here() const { return tokens_[at_]; }
  int line() const { return here().line; }
  Token take();
  bool is(std::string_view text) const { return here().kind != Token::Kind::word && here().text == text; }
  /// Takes a sign or keyword if it is there.
  bool took(std::string_view text);
  void expect(std::string_view text);
  std::string name();
  [[noreturn]] void refuse(const std::string& what) const { throw StructuredTextError(line(), what); }

 private:
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
};

/// A value as it will be computed.
struct Formula {
  StructuredTextType type;
  std::function<double(double*)> value;
};

/// A place that a statement may change.
struct Place {
  StructuredTextType type;
  std::function<double*(double*)> number;
};

/// Expressions of one unit.
class FormulaReader {
 public:
  FormulaReader(TokenStream& tokens, StructuredTextProgram& program, const ProgramUnit& unit)
      : tokens_(tokens), program_(program), unit_(unit) {}

  Formula formula() { return disjunction(); }
  Formula formula(StructuredTextType type);
  /// @param name  already taken.
  Place place(const std::string& name);
  const Variable& variable(const std::string& name) const;

 private:
  Formula disjunction();
  Formula conjunction();
  Formula equation();
  Formula comparison();
  Formula sum();
  Formula product();
  Formula signed_factor();
  Formula factor();
  Formula named(const std::string& name);
  Formula standard_function(const std::string& name);
  Formula call(const ProgramUnit& function);
  std::vector<Formula> arguments(const std::vector<StructuredTextType>& types);
  Formula arithmetic(const Formula& a, const std::string& sign, const Formula& b);
  void must_match(const Formula& a, const Formula& b) const;

  TokenStream& tokens_;
  StructuredTextProgram& program_;
  const ProgramUnit& unit_;
};

}  // namespace paracal::test

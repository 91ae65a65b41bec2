#include "formulas.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace paracal::test {

using enum StructuredTextType;

Token TokenStream::take() {
  if (here().kind == Token::Kind::end) refuse("the text ends too early");
  return tokens_[at_++];
}

bool TokenStream::took(std::string_view text) {
  if (!is(text)) return false;
  ++at_;
  return true;
}

void TokenStream::expect(std::string_view text) {
  if (!took(text)) refuse(fmt::format("expected {}, not {}", text, here().text));
}

std::string TokenStream::name() {
  if (here().kind != Token::Kind::word) refuse(fmt::format("expected a name, not {}", here().text));
  return take().text;
}

namespace {

/// What a controller may trap.
double checked(double value, int line, std::string_view what) {
  if (!std::isfinite(value)) throw StructuredTextError(line, fmt::format("{} gives {}", what, value));
  return value;
}

}  // namespace

Formula FormulaReader::formula(StructuredTextType type) {
  Formula read = formula();
  if (read.type != type) tokens_.refuse("the expression is of another type");
  return read;
}

const Variable& FormulaReader::variable(const std::string& name) const {
  const auto found = unit_.variables.find(name);
  if (found == unit_.variables.end()) tokens_.refuse(name + " is not declared");
  return found->second;
}

Place FormulaReader::place(const std::string& name) {
  const Variable& one = variable(name);
  if (one.block != nullptr) tokens_.refuse(name + " is a function block");
  if (!one.is_array) return {one.type, [offset = one.offset](double* frame) { return frame + offset; }};
  tokens_.expect("[");
  const int line = tokens_.line();
  const Formula index = formula(integer);
  tokens_.expect("]");
  return {one.type, [=, offset = one.offset, first = one.first, last = one.last](double* frame) {
            const int at = static_cast<int>(index.value(frame));
            if (at < first || at > last) throw StructuredTextError(line, fmt::format("{}[{}] is not there", name, at));
            return frame + offset + static_cast<std::size_t>(at - first);
          }};
}

void FormulaReader::must_match(const Formula& a, const Formula& b) const {
  if (a.type != b.type) tokens_.refuse("two types in one operation");
}

Formula FormulaReader::disjunction() {
  Formula a = conjunction();
  while (tokens_.took("OR")) {
    const Formula b = conjunction();
    if (a.type != boolean || b.type != boolean) tokens_.refuse("OR is of BOOL");
    a = {boolean, [a, b](double* frame) {
           const bool first = a.value(frame) != 0.0, second = b.value(frame) != 0.0;  // both, whatever the first
           return static_cast<double>(first || second);
         }};
  }
  return a;
}

Formula FormulaReader::conjunction() {
  Formula a = equation();
  while (tokens_.took("AND")) {
    const Formula b = equation();
    if (a.type != boolean || b.type != boolean) tokens_.refuse("AND is of BOOL");
    a = {boolean, [a, b](double* frame) {
           const bool first = a.value(frame) != 0.0, second = b.value(frame) != 0.0;  // both, whatever the first
           return static_cast<double>(first && second);
         }};
  }
  return a;
}

Formula FormulaReader::equation() {
  Formula a = comparison();
  while (tokens_.is("=") || tokens_.is("<>")) {
    const bool equal = tokens_.take().text == "=";
    const Formula b = comparison();
    must_match(a, b);
    a = {boolean, [=](double* frame) { return static_cast<double>((a.value(frame) == b.value(frame)) == equal); }};
  }
  return a;
}

Formula FormulaReader::comparison() {
  Formula a = sum();
  while (tokens_.is("<") || tokens_.is(">") || tokens_.is("<=") || tokens_.is(">=")) {
    const std::string sign = tokens_.take().text;
    const Formula b = sum();
    must_match(a, b);
    if (a.type == boolean) tokens_.refuse("BOOL has no order");
    const bool swap = sign.front() == '>', or_equal = sign.size() == 2;
    a = {boolean, [=](double* frame) {
           const double first = a.value(frame), second = b.value(frame);
           const double low = swap ? second : first, high = swap ? first : second;
           return static_cast<double>(or_equal ? low <= high : low < high);
         }};
  }
  return a;
}

Formula FormulaReader::arithmetic(const Formula& a, const std::string& sign, const Formula& b) {
  must_match(a, b);
  if (a.type == boolean) tokens_.refuse("no arithmetic with BOOL");
  const int line = tokens_.line();
  StructuredTextWork& work = program_.work;
  const auto made = [&](auto operation) -> Formula {
    return {a.type, [=, &work](double* frame) {
              const double first = a.value(frame);
              return checked(operation(work, first, b.value(frame)), line, sign);
            }};
  };
  const std::size_t counts = a.type == real ? 1 : 0;
  if (sign == "+") return made([](StructuredTextWork&, double x, double y) { return x + y; });
  if (sign == "-") return made([](StructuredTextWork&, double x, double y) { return x - y; });
  if (sign == "*") {
    return made(
        [counts](StructuredTextWork& done, double x, double y) { return done.multiplications += counts, x * y; });
  }
  if (a.type == integer) tokens_.refuse("division of INT");
  return made([](StructuredTextWork& done, double x, double y) { return ++done.divisions, x / y; });
}

Formula FormulaReader::sum() {
  Formula a = product();
  while (tokens_.is("+") || tokens_.is("-")) {
    const std::string sign = tokens_.take().text;
    if (tokens_.is("-")) tokens_.refuse("two signs in a row");
    a = arithmetic(a, sign, product());
  }
  return a;
}

Formula FormulaReader::product() {
  Formula a = signed_factor();
  while (tokens_.is("*") || tokens_.is("/")) {
    const std::string sign = tokens_.take().text;
    a = arithmetic(a, sign, factor());
  }
  return a;
}

Formula FormulaReader::signed_factor() {
  if (!tokens_.took("-")) return factor();
  const Formula a = factor();
  if (a.type == boolean) tokens_.refuse("no arithmetic with BOOL");
  return {a.type, [a](double* frame) { return -a.value(frame); }};
}

Formula FormulaReader::factor() {
  if (tokens_.took("(")) {
    Formula inner = formula();
    tokens_.expect(")");
    return inner;
  }
  if (tokens_.took("NOT")) {
    const Formula a = factor();
    if (a.type != boolean) tokens_.refuse("NOT is of BOOL");
    return {boolean, [a](double* frame) { return a.value(frame) != 0.0 ? 0.0 : 1.0; }};
  }
  const Token token = tokens_.take();
  const auto literal = [](StructuredTextType type, double value) {
    return Formula{type, [value](double*) { return value; }};
  };
  switch (token.kind) {
    case Token::Kind::real:
      return literal(real, checked(std::stod(token.text), token.line, token.text));
    case Token::Kind::integer:
      if (std::stod(token.text) > 32767.0) tokens_.refuse(token.text + " is no INT");
      return literal(integer, std::stod(token.text));
    case Token::Kind::word:
      return named(token.text);
    case Token::Kind::keyword:
      if (token.text == "TRUE" || token.text == "FALSE") return literal(boolean, token.text == "TRUE" ? 1.0 : 0.0);
      return standard_function(token.text);
    default:
      tokens_.refuse(token.text + " is no value");
  }
}

std::vector<Formula> FormulaReader::arguments(const std::vector<StructuredTextType>& types) {
  std::vector<Formula> read;
  tokens_.expect("(");
  for (const StructuredTextType type : types) {
    if (!read.empty()) tokens_.expect(",");
    read.push_back(formula(type));
  }
  tokens_.expect(")");
  return read;
}

Formula FormulaReader::standard_function(const std::string& name) {
  const int line = tokens_.line();
  StructuredTextWork& work = program_.work;
  if (name == "SEL") {
    const std::vector<Formula> a = arguments({boolean, real, real});
    return {real, [a](double* frame) {
              const double no = a[1].value(frame), yes = a[2].value(frame);
              return a[0].value(frame) != 0.0 ? yes : no;
            }};
  }
  const auto of_one = [&](auto function) -> Formula {
    const std::vector<Formula> a = arguments({real});
    return {real, [=, &work](double* frame) { return checked(function(work, a[0].value(frame)), line, name); }};
  };
  if (name == "SQRT")
    return of_one([](StructuredTextWork& done, double x) { return ++done.square_roots, std::sqrt(x); });
  if (name == "SIN") return of_one([](StructuredTextWork&, double x) { return std::sin(x); });
  if (name == "COS") return of_one([](StructuredTextWork&, double x) { return std::cos(x); });
  if (name == "ATAN") return of_one([](StructuredTextWork&, double x) { return std::atan(x); });
  if (name == "INT_TO_LREAL") {
    const Formula a = arguments({integer}).front();
    return {real, [a](double* frame) { return a.value(frame); }};
  }
  if (name != "ABS") tokens_.refuse(name + " is not part of the subset");
  const Formula a = arguments({real}).front();  // of an input that may be anything
  return {real, [a](double* frame) { return std::abs(a.value(frame)); }};
}

Formula FormulaReader::named(const std::string& name) {
  const auto unit = program_.units.find(name);
  if (unit != program_.units.end()) {
    if (!unit->second->is_function) tokens_.refuse(name + " is a function block, not an instance");
    return call(*unit->second);
  }
  const Variable& one = variable(name);
  if (one.block == nullptr) {
    const Place read = place(name);
    return {read.type, [read](double* frame) { return *read.number(frame); }};
  }
  tokens_.expect(".");
  const std::string output = tokens_.name();
  const auto found = one.block->variables.find(output);
  if (found == one.block->variables.end() || found->second.section != Variable::Section::output) {
    tokens_.refuse(fmt::format("{} has no output {}", name, output));
  }
  return {found->second.type, [at = one.offset + found->second.offset](double* frame) { return frame[at]; }};
}

Formula FormulaReader::call(const ProgramUnit& function) {
  const auto at = [&](const std::string& name) -> const Variable& { return function.variables.at(name); };
  std::vector<StructuredTextType> types;
  std::vector<std::size_t> offsets;
  for (const std::string& input : function.inputs) {
    types.push_back(at(input).type);
    offsets.push_back(at(input).offset);
  }
  const std::vector<Formula> given = arguments(types);
  const auto frame_of = std::make_shared<std::vector<double>>();
  return {at(function.name).type, [=, &function, result = at(function.name).offset](double* frame) {
            std::vector<double> values;
            for (const Formula& one : given) values.push_back(one.value(frame));
            *frame_of = function.initial;
            for (std::size_t k = 0; k < values.size(); ++k) (*frame_of)[offsets[k]] = values[k];
            function.body(frame_of->data());
            return (*frame_of)[result];
          }};
}

}  // namespace paracal::test

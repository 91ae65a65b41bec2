#include "program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "statements.hpp"

namespace paracal::test {
namespace {

using enum StructuredTextType;
class UnitReader {
 public:
  UnitReader(TokenStream& tokens, StructuredTextProgram& program) : tokens_(tokens), program_(program) {}

  std::unique_ptr<ProgramUnit> unit() {
    unit_ = std::make_unique<ProgramUnit>();
    unit_->is_function = tokens_.is("FUNCTION");
    if (!unit_->is_function && !tokens_.is("FUNCTION_BLOCK")) tokens_.refuse("expected a function or a function block");
    const std::string end = "END_" + tokens_.take().text;
    unit_->name = tokens_.name();
    if (program_.units.contains(unit_->name)) tokens_.refuse(unit_->name + " is there already");
    if (unit_->is_function) {
      tokens_.expect(":");
      declare(unit_->name, {.section = Variable::Section::local, .type = type()});
    }
    while (sections()) {
    }
    unit_->body = StatementReader(tokens_, program_, *unit_).statements({end});
    tokens_.expect(end);
    return std::move(unit_);
  }

 private:
  bool sections() {
    auto section = Variable::Section::local;
    if (tokens_.took("VAR_INPUT")) {
      section = Variable::Section::input;
    } else if (tokens_.took("VAR_OUTPUT")) {
      if (unit_->is_function) tokens_.refuse("outputs of a function");
      section = Variable::Section::output;
    } else if (tokens_.took("VAR")) {
      if (tokens_.took("CONSTANT")) section = Variable::Section::constant;
    } else {
      return false;
    }
    do {
      declaration(section);
    } while (!tokens_.took("END_VAR"));
    return true;
  }

  StructuredTextType type() {
    if (tokens_.took("LREAL")) return real;
    if (tokens_.took("INT")) return integer;
    if (tokens_.took("BOOL")) return boolean;
    tokens_.refuse(tokens_.here().text + " is no type of the subset");
  }

  void declaration(Variable::Section section) {
    std::vector<std::string> names{tokens_.name()};
    while (tokens_.took(",")) names.push_back(tokens_.name());
    tokens_.expect(":");
    Variable variable{.section = section};
    if (tokens_.here().kind == Token::Kind::word) {
      const auto block = program_.units.find(tokens_.name());
      if (block == program_.units.end() || block->second->is_function) tokens_.refuse("no such function block yet");
      if (section != Variable::Section::local) tokens_.refuse("an instance is a local variable");
      variable.block = block->second.get();
    } else if (tokens_.took("ARRAY")) {
      range(variable);
    } else {
      variable.type = type();
    }
    const bool is_given = tokens_.is(":=");
    if (section == Variable::Section::constant && !is_given) tokens_.refuse("a constant without a value");
    const std::vector<double> start = is_given ? initial(variable) : std::vector<double>();
    tokens_.expect(";");
    for (const std::string& name : names) declare(name, variable, start);
  }

  void range(Variable& variable) {
    if (variable.section == Variable::Section::input || variable.section == Variable::Section::output) {
      tokens_.refuse("some tool takes no arrays as inputs or outputs");
    }
    variable.is_array = true;
    tokens_.expect("[");
    variable.first = whole();
    tokens_.expect("..");
    variable.last = whole();
    tokens_.expect("]");
    tokens_.expect("OF");
    variable.type = type();
    if (variable.last < variable.first) tokens_.refuse("an array of nothing");
  }

  int whole() {
    if (tokens_.here().kind != Token::Kind::integer) tokens_.refuse("expected a whole number");
    return std::stoi(tokens_.take().text);
  }

  std::vector<double> initial(const Variable& variable) {
    tokens_.expect(":=");
    if (variable.block != nullptr) tokens_.refuse("an instance has no value");
    if (!variable.is_array) return {literal(variable.type)};
    std::vector<double> values;
    tokens_.expect("[");
    do {
      values.push_back(literal(variable.type));
    } while (tokens_.took(","));
    tokens_.expect("]");
    if (std::cmp_not_equal(values.size(), variable.last - variable.first + 1)) {
      tokens_.refuse("not as many values as the array has");
    }
    return values;
  }

  double literal(StructuredTextType type) {
    const double sign = type != boolean && tokens_.took("-") ? -1.0 : 1.0;
    const Token token = tokens_.take();
    if (type == boolean && (token.text == "TRUE" || token.text == "FALSE")) return token.text == "TRUE" ? 1.0 : 0.0;
    if (type == boolean || token.kind != (type == real ? Token::Kind::real : Token::Kind::integer)) {
      tokens_.refuse(token.text + " is no value of the type");
    }
    return sign * std::stod(token.text);
  }

  void declare(const std::string& name, Variable variable, const std::vector<double>& start = {}) {
    if (program_.units.contains(name)) tokens_.refuse(name + " is a function or block");
    variable.offset = unit_->initial.size();
    if (!unit_->variables.emplace(name, variable).second) tokens_.refuse(name + " is declared twice");
    if (variable.section == Variable::Section::input) unit_->inputs.push_back(name);
    const std::size_t size = variable.is_array ? static_cast<std::size_t>(variable.last - variable.first + 1) : 1;
    const std::vector<double> zeros(size, 0.0);
    const std::vector<double>& values = variable.block != nullptr ? variable.block->initial
                                        : start.empty()           ? zeros
                                                                  : start;
    unit_->initial.insert(unit_->initial.end(), values.begin(), values.end());
  }

  TokenStream& tokens_;
  StructuredTextProgram& program_;
  std::unique_ptr<ProgramUnit> unit_;
};

}  // namespace

std::unique_ptr<StructuredTextProgram> parsed(std::string_view text) {
  auto program = std::make_unique<StructuredTextProgram>();
  TokenStream tokens(tokens_of(text));
  while (tokens.here().kind != Token::Kind::end) {
    std::unique_ptr<ProgramUnit> unit = UnitReader(tokens, *program).unit();
    program->units.emplace(unit->name, std::move(unit));
  }
  return program;
}

namespace {

std::string in_capitals(const std::string& name) { return tokens_of(name).front().text; }

}  // namespace

FunctionBlock::FunctionBlock(std::string_view text, const std::string& name)
    : program_(parsed(text)), unit_(program_->units.at(in_capitals(name)).get()), frame_(unit_->initial) {}

void FunctionBlock::set(const std::string& input, double value) {
  frame_.at(unit_->variables.at(in_capitals(input)).offset) = value;
}

double FunctionBlock::get(const std::string& variable) const {
  return frame_.at(unit_->variables.at(in_capitals(variable)).offset);
}

void FunctionBlock::run() { unit_->body(frame_.data()); }

}  // namespace paracal::test

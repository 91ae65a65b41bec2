#include "statements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace paracal::test {

using enum StructuredTextType;

namespace {

/// More turns than this of one loop are taken for a loop without end.
constexpr int kMostTurns = 1000;

}  // namespace

Statement StatementReader::statements(const std::vector<std::string>& ends) {
  std::vector<Statement> all;
  const auto is_end = [&](const std::string& end) { return tokens_.is(end); };
  while (std::ranges::none_of(ends, is_end)) {
    all.push_back(statement());
    tokens_.expect(";");
  }
  if (all.empty()) tokens_.refuse("expected a statement");
  return [all](double* frame) {
    for (const Statement& one : all) {
      if (const Flow flow = one(frame); flow != Flow::next) return flow;
    }
    return Flow::next;
  };
}

Statement StatementReader::statement() {
  if (tokens_.took("IF")) return choice();
  if (tokens_.took("FOR")) return counted_loop();
  if (tokens_.took("WHILE")) return loop();
  if (tokens_.took("RETURN")) return [](double*) { return Flow::leave; };
  if (tokens_.is("EXIT")) {
    if (loops_ == 0) tokens_.refuse("EXIT outside of a loop");
    tokens_.take();
    return [](double*) { return Flow::exit; };
  }
  const std::string name = tokens_.name();
  const Variable& variable = formulas_.variable(name);
  return variable.block != nullptr ? call(variable) : assignment(name, variable);
}

Statement StatementReader::assignment(const std::string& name, const Variable& variable) {
  const bool is_fixed = variable.section == Variable::Section::input || variable.section == Variable::Section::constant;
  if (is_fixed || counters_.contains(name)) tokens_.refuse(name + " is not to be changed");
  const Place target = formulas_.place(name);
  tokens_.expect(":=");
  const Formula value = formulas_.formula(target.type);
  return [target, value](double* frame) {
    const double number = value.value(frame);
    *target.number(frame) = number;
    return Flow::next;
  };
}

Statement StatementReader::call(const Variable& instance) {
  struct Input {
    std::size_t at;
    Formula value;
  };
  std::vector<Input> inputs;
  tokens_.expect("(");
  while (!tokens_.took(")")) {
    if (!inputs.empty()) tokens_.expect(",");
    const auto found = instance.block->variables.find(tokens_.name());
    if (found == instance.block->variables.end() || found->second.section != Variable::Section::input) {
      tokens_.refuse("no such input");
    }
    tokens_.expect(":=");
    inputs.push_back({instance.offset + found->second.offset, formulas_.formula(found->second.type)});
  }
  return [inputs, block = instance.block, offset = instance.offset](double* frame) {
    for (const Input& input : inputs) frame[input.at] = input.value.value(frame);
    block->body(frame + offset);
    return Flow::next;
  };
}

Statement StatementReader::choice() {
  std::vector<std::pair<Formula, Statement>> branches;
  do {
    Formula condition = formulas_.formula(boolean);
    tokens_.expect("THEN");
    branches.emplace_back(std::move(condition), statements({"ELSIF", "ELSE", "END_IF"}));
  } while (tokens_.took("ELSIF"));
  Statement other = [](double*) { return Flow::next; };
  if (tokens_.took("ELSE")) other = statements({"END_IF"});
  tokens_.expect("END_IF");
  return [branches, other](double* frame) {
    for (const auto& [condition, branch] : branches) {
      if (condition.value(frame) != 0.0) return branch(frame);
    }
    return other(frame);
  };
}

Statement StatementReader::body(const std::string& end) {
  ++loops_;
  Statement read = statements({end});
  tokens_.expect(end);
  --loops_;
  return read;
}

Statement StatementReader::counted_loop() {
  const int line = tokens_.line();
  const std::string name = tokens_.name();
  const Variable& counter = formulas_.variable(name);
  if (counter.type != integer || counter.section != Variable::Section::local || counter.is_array) {
    tokens_.refuse("a loop counts in a local INT");
  }
  tokens_.expect(":=");
  const Formula from = formulas_.formula(integer);
  tokens_.expect("TO");
  const Formula to = formulas_.formula(integer);
  tokens_.expect("DO");
  if (!counters_.insert(name).second) tokens_.refuse(name + " counts already");
  const Statement repeated = body("END_FOR");
  counters_.erase(name);
  return [=, at = counter.offset](double* frame) {
    const double first = from.value(frame), last = to.value(frame);
    if (!(first < last)) throw StructuredTextError(line, "a loop that matiec does not run: its bounds do not rise");
    for (frame[at] = first; frame[at] <= last; ++frame[at]) {
      if (const Flow flow = repeated(frame); flow == Flow::leave)
        return flow;
      else if (flow == Flow::exit)
        break;
    }
    return Flow::next;
  };
}

Statement StatementReader::loop() {
  const int line = tokens_.line();
  const Formula condition = formulas_.formula(boolean);
  tokens_.expect("DO");
  const Statement repeated = body("END_WHILE");
  return [=](double* frame) {
    for (int turn = 0; condition.value(frame) != 0.0; ++turn) {
      if (turn == kMostTurns) throw StructuredTextError(line, "a loop without end");
      if (const Flow flow = repeated(frame); flow == Flow::leave)
        return flow;
      else if (flow == Flow::exit)
        break;
    }
    return Flow::next;
  };
}

}  // namespace paracal::test

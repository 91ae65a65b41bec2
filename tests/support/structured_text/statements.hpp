#pragma once

#include <set>
#include <string>
#include <vector>

#include "formulas.hpp"

namespace paracal::test {

using Statement = std::function<Flow(double*)>;

/// Statements of one unit.
class StatementReader {
 public:
  StatementReader(TokenStream& tokens, StructuredTextProgram& program, const ProgramUnit& unit)
      : tokens_(tokens), formulas_(tokens, program, unit) {}

  /// Up to one of these words, which is left.
  Statement statements(const std::vector<std::string>& ends);

 private:
  Statement statement();
  Statement assignment(const std::string& name, const Variable& variable);
  Statement call(const Variable& instance);
  Statement choice();
  Statement body(const std::string& end);
  Statement counted_loop();
  Statement loop();

  TokenStream& tokens_;
  FormulaReader formulas_;
  std::set<std::string> counters_;  ///< of the loops around
  int loops_ = 0;
};

}  // namespace paracal::test

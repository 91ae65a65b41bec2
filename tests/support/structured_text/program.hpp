#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tokens.hpp"

// Runs programs in the subset of IEC 61131-3 Structured Text that CODESYS, TwinCAT and matiec have in common: functions
// and function blocks, LREAL, INT, BOOL and arrays of one dimension, IF, FOR, WHILE, EXIT, RETURN. Nothing is converted
// silently, nothing is used that is not declared, and no operation gives infinity or NaN: controllers may trap it.

namespace paracal::test {

/// What a program has done.
struct StructuredTextWork {
  std::size_t multiplications = 0, divisions = 0, square_roots = 0;
};

enum class StructuredTextType { real, integer, boolean };

enum class Flow { next, exit, leave };

struct ProgramUnit;

/// A variable in the frame of its unit; of a function block within another, where that has its own.
struct Variable {
  enum class Section { input, output, constant, local } section = Section::local;
  StructuredTextType type = StructuredTextType::real;
  const ProgramUnit* block = nullptr;  ///< of an instance of a function block
  bool is_array = false;
  int first = 0, last = 0;  ///< of an array
  std::size_t offset = 0;
};

/// A function or a function block. Its numbers lie in a frame, one after the other.
struct ProgramUnit {
  std::string name;
  bool is_function = false;
  std::map<std::string, Variable> variables;
  std::vector<std::string> inputs;  ///< in their order
  std::vector<double> initial;      ///< the frame at the start
  std::function<Flow(double*)> body;
};

/// Functions and function blocks by name.
struct StructuredTextProgram {
  std::map<std::string, std::unique_ptr<ProgramUnit>> units;
  StructuredTextWork work;
};

/// @throws StructuredTextError
std::unique_ptr<StructuredTextProgram> parsed(std::string_view text);

/// One instance of a function block.
class FunctionBlock {
 public:
  FunctionBlock(std::string_view text, const std::string& name);

  void set(const std::string& input, double value);
  double get(const std::string& variable) const;
  /// @throws StructuredTextError where a controller would stop.
  void run();
  const StructuredTextWork& work() const { return program_->work; }

 private:
  std::unique_ptr<StructuredTextProgram> program_;
  const ProgramUnit* unit_;
  std::vector<double> frame_;
};

}  // namespace paracal::test

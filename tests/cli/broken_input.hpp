#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <stdexcept>

#include "run_program.hpp"

namespace paracal::test {

struct NamedText {
  std::string name;
  std::string text;
};

/// One row: files, a command that must not accept them, and what it must do instead.
struct BrokenInput {
  std::string name;
  std::vector<NamedText> files;
  std::string command;
  int exit_code = kBadInputFile;
  std::vector<std::string> message;  ///< fragments of standard error
};

inline void PrintTo(const BrokenInput& input, std::ostream* stream) { *stream << "paracal " << input.command; }

inline std::string name_of(const testing::TestParamInfo<BrokenInput>& info) { return info.param.name; }

/// Text with its one occurrence of `old` replaced.
inline std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos || text.find(old, at + 1) != std::string::npos) {
    throw std::logic_error("expected once in the base text: " + old);
  }
  return text.replace(at, old.size(), by);
}

/// The files, with the one of this name replaced.
inline std::vector<NamedText> with(std::vector<NamedText> files, const NamedText& other) {
  for (NamedText& one : files) {
    if (one.name == other.name) one.text = other.text;
  }
  return files;
}

/// What must hold for every row stands in broken_input_test.cpp.
class BrokenInputTest : public testing::TestWithParam<BrokenInput> {
 protected:
  void SetUp() override {
    for (const NamedText& file : GetParam().files) folder.write(file.name, file.text);
  }

  ProgramResult run_with(const std::string& options) const { return folder.run(GetParam().command + options); }

  TemporaryFolder folder;
};

}  // namespace paracal::test

#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/io/store.hpp"

namespace paracal::app {

/// The files that a command writes: each a file of its own, and all of them in their places only once everything else
/// is done and printed.
class Outputs {
 public:
  /// An option that names a file to write.
  Option* declare(Option* option);

  /// What can be known before the command runs: that an output is no file that another option names, nor standard input
  /// or output, and that its folder can be written.
  /// @throws WrongUsage
  void check(const Command& command) const;
  /// The same of files that were read without an option's naming them.
  /// @throws WrongUsage
  void keep_off(const std::vector<std::string>& read) const;

  io::Store store;

 private:
  bool is_output(const Option& option) const;

  std::vector<const Option*> options_;
};

}  // namespace paracal::app

#pragma once

// Private to the filter: what a filter left as it was.

#include <cstdint>
#include <string_view>
#include <vector>

#include "paracal/filter/target_filter.hpp"
#include "target_line.hpp"

namespace paracal::io {

/// Counts what is passed through.
class PassedTally {
 public:
  /// @param weight  work breaks off; what is idle stands between no targets.
  void pass(std::string_view reason, std::int64_t line, TargetLine::Weight weight);
  /// What was passed since the last corrected target stands between two.
  void correct();
  /// In the order of their first lines.
  std::vector<PassedThrough> sorted() const;

 private:
  /// Since the last corrected target.
  struct Since {
    std::int64_t count = 0, first_line = 0;
  };

  void break_off();

  std::vector<PassedThrough> passed_;
  std::vector<Since> since_;  ///< of each of these
  bool corrected_ = false, passes_since_ = false;
};

}  // namespace paracal::io

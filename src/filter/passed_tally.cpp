#include "passed_tally.hpp"

#include <algorithm>
#include <utility>

namespace paracal::io {

void PassedTally::pass(std::string_view reason, std::int64_t line, TargetLine::Weight weight) {
  const auto found = std::ranges::find(passed_, reason, &PassedThrough::reason);
  if (found == passed_.end()) since_.emplace_back();
  PassedThrough& entry = found != passed_.end() ? *found : passed_.emplace_back(PassedThrough{reason, 0, line});
  ++entry.count;
  if (weight == TargetLine::Weight::idle) return;
  Since& since = since_[static_cast<std::size_t>(&entry - passed_.data())];
  if (since.count++ == 0) since.first_line = line;
  passes_since_ = true;
  if (weight == TargetLine::Weight::work) break_off();
}

void PassedTally::correct() {
  if (!std::exchange(corrected_, true)) {  // what came before was on the way to it
    since_.assign(since_.size(), Since{});
    passes_since_ = false;
  }
  break_off();
}

/// What was passed last is no approach or retreat: as if it stood between corrected targets.
void PassedTally::break_off() {
  if (!std::exchange(passes_since_, false)) return;
  for (std::size_t k = 0; k < passed_.size(); ++k) {
    const Since since = std::exchange(since_[k], {});
    if (passed_[k].between == 0) passed_[k].first_between = since.first_line;
    passed_[k].between += since.count;
  }
}

std::vector<PassedThrough> PassedTally::sorted() const {
  std::vector<PassedThrough> result = passed_;
  std::ranges::sort(result, {}, &PassedThrough::first_line);
  return result;
}

}  // namespace paracal::io

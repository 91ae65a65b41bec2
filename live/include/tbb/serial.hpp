#pragma once

#include <array>
#include <cstddef>

// What this project takes from oneTBB, on the one thread that a page has: the same calls, one after another. Results do
// not depend on the number of threads (tests/ hold that), so these are those of the program.

namespace tbb {

struct simple_partitioner {};

template <typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body) {
  for (Index k = first; k < last; ++k) body(k);
}

template <typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body, simple_partitioner /*how*/) {
  parallel_for(first, last, body);
}

class task_arena {
 public:
  static constexpr int automatic = -1;
  explicit task_arena(int /*threads*/ = automatic) {}
  template <typename Body>
  decltype(auto) execute(const Body& body) {
    return body();
  }
};

namespace this_task_arena {
inline int max_concurrency() { return 1; }
}  // namespace this_task_arena

template <typename T>
class enumerable_thread_specific {
 public:
  explicit enumerable_thread_specific(const T& start) : values_{start} {}
  T& local() { return values_.front(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }

 private:
  std::array<T, 1> values_;
};

}  // namespace tbb

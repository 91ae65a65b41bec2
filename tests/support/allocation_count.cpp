#include "support/allocation_count.hpp"

#include <atomic>

namespace paracal::test {
namespace {

std::atomic<std::size_t> count{0};

}  // namespace

std::size_t allocation_count() { return count; }

}  // namespace paracal::test

// An executable's own malloc takes the place of the C library's everywhere; glibc keeps its own under these names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++paracal::test::count;
  return __libc_malloc(size);
}

void* calloc(std::size_t items, std::size_t size) {
  ++paracal::test::count;
  return __libc_calloc(items, size);
}

void* realloc(void* block, std::size_t size) {
  ++paracal::test::count;
  return __libc_realloc(block, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++paracal::test::count;
  return __libc_memalign(alignment, size);
}
}

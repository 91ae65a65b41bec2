#include <cstddef>
#include <cstdlib>

// main.cpp asks the linker to put its own malloc in front of the library's. Emscripten's JavaScript calls malloc by its
// name and would not find it then, so the linker is not asked here: a call that gets no memory ends the instance, which
// the page tells.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
void* __real_malloc(std::size_t size) { return std::malloc(size); }
void* __real_realloc(void* memory, std::size_t size) { return std::realloc(memory, size); }
// NOLINTEND(bugprone-reserved-identifier)
}

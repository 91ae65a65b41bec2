#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "launch.hpp"
#include "program.hpp"
#include "session.hpp"
#include "terminal.hpp"

namespace {

using namespace paracal::app;

int complain(Launch& launch, const std::exception& error, ExitCode code) {
  if (launch.complains()) {
    const std::string name = emphasised(STDERR_FILENO, Emphasis::bad, std::string(Launch::name()) + ":");
    std::fprintf(stderr, "%s %s\n", name.c_str(), paracal::printable(error.what()).c_str());
  }
  launch.give_up(code);
  return code;
}

/// Ends here, not by unwinding: destructors of others (of JSON, for one) want memory, too. Outputs that are not
/// finished have no name and are gone.
[[noreturn]] void give_up() {
  constexpr std::string_view kMessage = "paracal: not enough memory\n";
  if (write(STDERR_FILENO, kMessage.data(), kMessage.size()) < 0) _exit(kWrongUsage);  // nothing more can be done
  _exit(kWrongUsage);
}

}  // namespace

// The linker sends the program's own calls here (--wrap): Eigen 3.4 frees a matrix twice when its new memory is
// refused. NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __wrap_malloc(std::size_t size) {
  void* const memory = __real_malloc(size);
  if (memory == nullptr && size > 0) give_up();
  return memory;
}
void* __wrap_realloc(void* earlier, std::size_t size) {
  void* const memory = __real_realloc(earlier, size);
  if (memory == nullptr && size > 0) give_up();
  return memory;
}
}
// NOLINTEND(bugprone-reserved-identifier)

namespace {

/// Opens those of the standard streams that are closed, the wrong way round, so that they fail as before: else a result
/// would get the number of one, and with it what is printed.
void keep_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::set_new_handler(give_up);
  keep_standard_streams();
  Launch launch(argc, argv);
  try {
    const auto nowhere = [](std::string_view /*text*/) {};
    const bool writes = launch.ranks().number() == 0;
    return run_program({argv + std::min(argc, 1), argv + argc},
                       writes ? paracal::io::TextSink(write_to_standard_output) : nowhere, launch.ranks());
  } catch (const paracal::InputFileError& error) {
    return complain(launch, error, kBadInputFile);
  } catch (const paracal::InvalidArgument& error) {
    return complain(launch, error, kBadInputFile);
  } catch (const MathematicsSaysNo& error) {
    return complain(launch, error, kMathematicsSaysNo);
  } catch (const paracal::Unreachable& error) {
    return complain(launch, error, kMathematicsSaysNo);
  } catch (const std::bad_alloc&) {  // of those who ask without operator new
    give_up();
  } catch (const std::exception& error) {  // wrong usage, or a result that cannot be written
    return complain(launch, error, kWrongUsage);
  }
}

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "arguments.hpp"
#include "embedded.hpp"
#include "paracal/version.hpp"
#include "session.hpp"

namespace {

using namespace paracal::app;

int complain(const std::exception& error, ExitCode code) {
  std::fprintf(stderr, "paracal: %s\n", paracal::printable(error.what()).c_str());
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

std::string licences() {
  std::string text = "paracal: Apache License 2.0\n\n";
  for (const paracal::detail::EmbeddedFile& file : paracal::detail::licences()) text += file.text;
  return text;
}

/// Opens those of the standard streams that are closed, the wrong way round, so that they fail as before: else a result
/// would get the number of one, and with it what is printed.
void keep_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

/// Everything, up to the outputs that replace earlier ones.
int run(int argc, char** argv) {
  Arguments arguments(
      {.about = "paracal: accuracy of parallel robots, from drawing tolerances to a compensated controller",
       .name = "paracal",
       .version = fmt::format("paracal {} ({})", paracal::version(), paracal::build()),
       .footer =
           "Exit codes: 0 done; 1 done, and the verdict is no; 2 wrong usage; 3 bad input file; 4 the mathematics "
           "says no.",
       .licences = licences});
  Command& program = arguments.program();
  Session session;
  session.command_line = shell_line(argc, argv);
  add_robot(program, session);
  add_inverse(program, session);
  add_forward(program, session);
  add_error_model(program, session);
  add_poses(program, session);
  add_identifiability(program, session);
  add_simulate(program, session);
  add_calibrate(program, session);
  add_validate(program, session);
  add_report(program, session);
  add_sensitivity(program, session);
  add_tolerance(program, session);
  add_yield(program, session);
  add_compensate(program, session);
  add_export(program, session);
  add_reproduce(program, session);
  if (const auto code = arguments.run(argc, argv)) return *code;
  session.finish();
  return session.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::set_new_handler(give_up);
  keep_standard_streams();
  try {
    return run(argc, argv);
  } catch (const paracal::InputFileError& error) {
    return complain(error, kBadInputFile);
  } catch (const paracal::InvalidArgument& error) {
    return complain(error, kBadInputFile);
  } catch (const MathematicsSaysNo& error) {
    return complain(error, kMathematicsSaysNo);
  } catch (const paracal::Unreachable& error) {
    return complain(error, kMathematicsSaysNo);
  } catch (const std::bad_alloc&) {  // of those who ask without operator new
    give_up();
  } catch (const std::exception& error) {  // wrong usage, or a result that cannot be written
    return complain(error, kWrongUsage);
  }
}

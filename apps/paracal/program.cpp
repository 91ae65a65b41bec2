#include "program.hpp"

#include <fmt/format.h>

#include "arguments.hpp"
#include "embedded.hpp"
#include "launch.hpp"
#include "paracal/version.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

std::string licences() {
  std::string text = "paracal: Apache License 2.0\n\n";
  for (const detail::EmbeddedFile& file : detail::licences()) text += file.text;
  return text;
}

void add_tolerance(Command& program, Session& session) {
  Command* tolerance = program.add_command("tolerance", "choose or analyze tolerances", "Design tolerances");
  tolerance->require_command();
  add_tolerance_allocate(*tolerance, session);
  add_tolerance_analyze(*tolerance, session);
}

void add_commands(Arguments& arguments, Session& session) {
  Command& program = arguments.program();
  if (Launch::has_long_jobs_alone()) {
    add_poses(program, session);
    add_tolerance(program, session);
    add_yield(program, session);
    return;
  }
  add_demo(program, session);
  add_robot(program, session);
  add_inverse(program, session);
  add_forward(program, session);
  add_error_model(program, session);
  add_poses(program, session);
  add_identifiability(program, session);
  add_simulate(program, session);
  add_calibrate(program, session);
  add_printer(program, session);
  add_validate(program, session);
  add_report(program, session);
  add_sensitivity(program, session);
  add_tolerance(program, session);
  add_yield(program, session);
  add_compensate(program, session);
  add_export(program, session);
  add_schema(program, session);
  add_reproduce(program, session);
  add_help(arguments, session);
  add_manual(arguments, session);
}

}  // namespace

int run_program(const std::vector<std::string>& words, const io::TextSink& standard_output, jobs::Ranks& ranks) {
  Arguments arguments(
      {.about = "paracal: estimates and compensates the geometric errors of parallel robots",
       .name = Launch::name(),
       .version = fmt::format("{} {} ({})", Launch::name(), version(), build()),
       .footer =
           "Exit codes: 0 done; 1 done, criteria not met; 2 wrong usage; 3 bad input file; 4 no solution (pose out of "
           "reach or singular).",
       .licences = licences});
  Session session(standard_output, ranks);
  session.words = words;
  add_commands(arguments, session);
  if (const auto code = arguments.run(words, standard_output)) return *code;
  session.finish();
  return session.exit_code;
}

}  // namespace paracal::app

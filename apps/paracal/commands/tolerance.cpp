#include "tolerance.hpp"

namespace paracal::app {

void add_tolerance(Command& program, Session& session) {
  Command* tolerance = program.add_command("tolerance", "choose or analyze tolerances", "Design tolerances");
  tolerance->require_command();
  add_tolerance_allocate(*tolerance, session);
  add_tolerance_analyze(*tolerance, session);
}

}  // namespace paracal::app

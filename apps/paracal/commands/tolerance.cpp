#include "tolerance.hpp"

namespace paracal::app {

void add_tolerance(CLI::App& app, Session& session) {
  CLI::App* tolerance = app.add_subcommand("tolerance", "choose tolerances, or see what they lead to");
  tolerance->group("Design tolerances");
  tolerance->require_subcommand(1);
  add_tolerance_allocate(*tolerance, session);
  add_tolerance_analyze(*tolerance, session);
}

}  // namespace paracal::app

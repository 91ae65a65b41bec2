#include "launch.hpp"

namespace paracal::app {

Launch::Launch(int& /*argc*/, char**& /*argv*/) {}
Launch::~Launch() = default;

jobs::Ranks& Launch::ranks() {
  static jobs::Alone alone;
  return alone;
}

const char* Launch::name() { return "paracal"; }
bool Launch::has_long_jobs_alone() { return false; }
void Launch::wait_for_the_first() {}
void Launch::give_up(int /*exit_code*/) {}

}  // namespace paracal::app

#include "launch.hpp"

namespace paracal::app {

Launch::Launch(int& /*argc*/, char**& /*argv*/) : ranks_(std::make_unique<jobs::Alone>()) {}
Launch::~Launch() = default;

const char* Launch::name() { return "paracal"; }
bool Launch::has_long_jobs_alone() { return false; }
bool Launch::complains() { return true; }
void Launch::give_up(int /*exit_code*/) {}

}  // namespace paracal::app

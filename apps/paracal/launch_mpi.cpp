#include <mpi.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>

#include "jobs/mpi_ranks.hpp"
#include "launch.hpp"

namespace paracal::app {
namespace {

std::optional<jobs::MpiRanks> ranks_of_mpi;

/// On standard error, where PARACAL_MPI_TRAFFIC is set.
void say_traffic() {
  const jobs::MpiRanks::Traffic all = ranks_of_mpi->traffic_of_all();
  if (ranks_of_mpi->number() != 0 || std::getenv("PARACAL_MPI_TRAFFIC") == nullptr) return;
  std::fprintf(stderr, "paracal-mpi: %llu ranks: %llu fetches of 8 bytes, %llu messages with %llu bytes\n",
               static_cast<unsigned long long>(ranks_of_mpi->size()), static_cast<unsigned long long>(all.fetches),
               static_cast<unsigned long long>(all.messages), static_cast<unsigned long long>(all.bytes));
}

}  // namespace

Launch::Launch(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  ranks_of_mpi.emplace();
}

Launch::~Launch() {
  say_traffic();
  ranks_of_mpi.reset();
  MPI_Finalize();
}

jobs::Ranks& Launch::ranks() { return *ranks_of_mpi; }
const char* Launch::name() { return "paracal-mpi"; }
bool Launch::has_long_jobs_alone() { return true; }

void Launch::wait_for_the_first() {
  if (ranks_of_mpi->number() != 0) std::this_thread::sleep_for(std::chrono::seconds(1));
}

void Launch::give_up(int exit_code) {
  if (ranks_of_mpi->size() > 1) MPI_Abort(MPI_COMM_WORLD, exit_code);
}

}  // namespace paracal::app

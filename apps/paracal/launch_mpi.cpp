#include <mpi.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "jobs/mpi_ranks.hpp"
#include "launch.hpp"

namespace paracal::app {
namespace {

/// On standard error, where PARACAL_MPI_TRAFFIC is set.
void say_traffic(const jobs::MpiRanks& ranks) {
  const jobs::MpiRanks::Traffic all = ranks.traffic_of_all();
  if (ranks.number() != 0 || std::getenv("PARACAL_MPI_TRAFFIC") == nullptr) return;
  std::fprintf(stderr, "paracal-mpi: %llu ranks: %llu fetches of 8 bytes, %llu messages with %llu bytes\n",
               static_cast<unsigned long long>(ranks.size()), static_cast<unsigned long long>(all.fetches),
               static_cast<unsigned long long>(all.messages), static_cast<unsigned long long>(all.bytes));
}

}  // namespace

Launch::Launch(int& argc, char**& argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  ranks_ = std::make_unique<jobs::MpiRanks>();
}

Launch::~Launch() {
  say_traffic(static_cast<const jobs::MpiRanks&>(*ranks_));
  ranks_.reset();
  MPI_Finalize();
}

const char* Launch::name() { return "paracal-mpi"; }
bool Launch::has_long_jobs_alone() { return true; }

bool Launch::complains() {
  if (static_cast<jobs::MpiRanks&>(*ranks_).is_first_to_complain()) return true;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  return false;
}

void Launch::give_up(int exit_code) {
  if (ranks_->size() > 1) MPI_Abort(MPI_COMM_WORLD, exit_code);
}

}  // namespace paracal::app

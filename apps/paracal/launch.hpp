#pragma once

#include <memory>

#include "jobs/ranks.hpp"

namespace paracal::app {

/// How a program was started: one process, or the ranks of MPI. Defined by launch_alone.cpp and launch_mpi.cpp.
class Launch {
 public:
  Launch(int& argc, char**& argv);
  ~Launch();
  Launch(const Launch&) = delete;
  Launch& operator=(const Launch&) = delete;

  jobs::Ranks& ranks() { return *ranks_; }
  /// Of the program.
  static const char* name();
  /// Whether it has the commands alone that share their work among ranks.
  static bool has_long_jobs_alone();
  /// Whether this rank says what is wrong: the first one does. Others may have met the same; they wait a little, so
  /// that the first one ends them.
  bool complains();
  /// A rank failed, and others may wait for it: ends all of them.
  void give_up(int exit_code);

 private:
  std::unique_ptr<jobs::Ranks> ranks_;
};

}  // namespace paracal::app

#pragma once

// Private to the programs that MPI starts.

#include <mpi.h>

#include <cstdint>

#include "ranks.hpp"

namespace paracal::jobs {

/// The ranks of MPI_COMM_WORLD. Chunks are taken by one-sided fetch-and-add on a counter of rank 0, totals added up
/// along a binary tree. Rank 0 answers others while it works, whatever the network: another thread lets MPI make
/// progress meanwhile.
class MpiRanks : public Ranks {
 public:
  /// MPI is initialised, with MPI_THREAD_SERIALIZED at least, until this has gone.
  MpiRanks();
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  std::uint64_t number() const override { return static_cast<std::uint64_t>(number_); }
  std::uint64_t size() const override { return static_cast<std::uint64_t>(size_); }
  void begin() override;
  std::uint64_t take() override;
  void work(const std::function<void()>& task) override;
  bool all(bool here) override;
  void add_up(JobStage& stage) override;

  /// Whether no other rank has asked before.
  bool is_first_to_complain();

  /// What this rank has sent.
  struct Traffic {
    std::uint64_t fetches = 0, messages = 0, bytes = 0;
  };
  /// Of all ranks. All of them ask.
  Traffic traffic_of_all() const;

 private:
  std::uint64_t add_one(MPI_Aint counter);
  void send(const std::string& text, int to);
  static std::string receive(int from);

  int number_ = 0, size_ = 1;
  std::uint64_t* counters_ = nullptr;  ///< rank 0's: chunks taken, complaints
  MPI_Win window_ = MPI_WIN_NULL;
  Traffic traffic_;
};

}  // namespace paracal::jobs

#include "mpi_ranks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <thread>

#include "paracal/error.hpp"

namespace paracal::jobs {
namespace {

constexpr int kRoot = 0, kTag = 0;
constexpr MPI_Aint kChunksTaken = 0, kComplaints = 1, kCounters = 2;

int length_of(const std::string& text) {
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw Error("a sum exceeds the largest MPI message; use fewer machines per job");
  }
  return static_cast<int>(text.size());
}

}  // namespace

MpiRanks::MpiRanks() {
  MPI_Comm_rank(MPI_COMM_WORLD, &number_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  const MPI_Aint bytes = number_ == kRoot ? kCounters * static_cast<MPI_Aint>(sizeof(std::uint64_t)) : 0;
  MPI_Win_allocate(bytes, sizeof(std::uint64_t), MPI_INFO_NULL, MPI_COMM_WORLD, static_cast<void*>(&counters_),
                   &window_);
  if (number_ == kRoot) std::fill_n(counters_, kCounters, 0);
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Win_lock_all(MPI_MODE_NOCHECK, window_);
}

MpiRanks::~MpiRanks() {
  MPI_Win_unlock_all(window_);
  MPI_Win_free(&window_);
}

void MpiRanks::begin() {
  MPI_Barrier(MPI_COMM_WORLD);
  if (number_ == kRoot) {
    const std::uint64_t none = 0;
    std::uint64_t before = 0;
    MPI_Fetch_and_op(&none, &before, MPI_UINT64_T, kRoot, kChunksTaken, MPI_REPLACE, window_);
    MPI_Win_flush(kRoot, window_);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

std::uint64_t MpiRanks::add_one(MPI_Aint counter) {
  const std::uint64_t one = 1;
  std::uint64_t before = 0;
  MPI_Fetch_and_op(&one, &before, MPI_UINT64_T, kRoot, counter, MPI_SUM, window_);
  MPI_Win_flush(kRoot, window_);
  return before;
}

std::uint64_t MpiRanks::take() {
  ++traffic_.fetches;
  return add_one(kChunksTaken);
}

bool MpiRanks::is_first_to_complain() { return add_one(kComplaints) == 0; }

void MpiRanks::work(const std::function<void()>& task) {
  if (number_ != kRoot || size_ == 1) return task();
  static constexpr std::chrono::milliseconds kBetweenLooks{
      5};  // short beside a chunk; looking takes time from the work
  const std::jthread answering([](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any woken;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      int ignored = 0;
      MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &ignored, MPI_STATUS_IGNORE);
      woken.wait_for(lock, stop, kBetweenLooks, [] { return false; });
    }
  });
  task();
}

bool MpiRanks::all(bool here) {
  int value = here ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_LAND, MPI_COMM_WORLD);
  return value != 0;
}

void MpiRanks::add_up(JobStage& stage) {
  for (int step = 1; step < size_; step *= 2) {
    if (number_ % (2 * step) == step) {
      send(stage.total(), number_ - step);
      break;
    }
    if (number_ + step < size_) stage.add(receive(number_ + step));
  }
  std::string total = number_ == kRoot ? stage.total() : std::string();
  auto length = static_cast<std::uint64_t>(length_of(total));
  MPI_Bcast(&length, 1, MPI_UINT64_T, kRoot, MPI_COMM_WORLD);
  total.resize(length);
  MPI_Bcast(total.data(), static_cast<int>(length), MPI_CHAR, kRoot, MPI_COMM_WORLD);
  if (number_ == kRoot) return;
  ++traffic_.messages;  // one copy reaches every other rank
  traffic_.bytes += length;
  stage.clear();
  stage.add(total);
}

void MpiRanks::send(const std::string& text, int to) {
  MPI_Send(text.data(), length_of(text), MPI_CHAR, to, kTag, MPI_COMM_WORLD);
  ++traffic_.messages;
  traffic_.bytes += text.size();
}

std::string MpiRanks::receive(int from) {
  MPI_Status status;
  MPI_Probe(from, kTag, MPI_COMM_WORLD, &status);
  int length = 0;
  MPI_Get_count(&status, MPI_CHAR, &length);
  std::string text(static_cast<std::size_t>(length), '\0');
  MPI_Recv(text.data(), length, MPI_CHAR, from, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return text;
}

MpiRanks::Traffic MpiRanks::traffic_of_all() const {
  const std::array<std::uint64_t, 3> own{traffic_.fetches, traffic_.messages, traffic_.bytes};
  std::array<std::uint64_t, 3> sum{};
  MPI_Allreduce(own.data(), sum.data(), 3, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  return {sum[0], sum[1], sum[2]};
}

}  // namespace paracal::jobs

#pragma once

// New parameters for a control thread that never stops: double buffer with counted publications. Needs only the
// standard library.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "paracal/compensation/compensator.hpp"

namespace paracal {

/// Two slots of parameters. One thread publishes into the free slot; any number of readers copy the
/// other. Only a reader that is overtaken by two publications during its copy can get a mixture, and the counts show
/// this.
///
///   publish n:  begun = n;  slot[n mod 2] = parameters;  published = n
///   read:       n = published;  copy slot[n mod 2];  good unless begun has come to n + 2
///
/// The slots are atomic words, stored with release and loaded with acquire: a reader that sees a word of publication
/// n + 2 also sees begun = n + 2. Neither side ever waits.
template <typename Scalar>
class ParameterBuffer {
 public:
  using Parameters = CompensatorParameters<Scalar>;

  /// @param parameters  of the robot; until the first publication, readers get them without errors.
  explicit ParameterBuffer(const Parameters& parameters) noexcept : nominal_(without_errors(parameters)) {
    store(nominal_, 0);
  }

  /// One thread at a time. Real-time: yes.
  void publish(const Parameters& parameters) noexcept {
    const std::uint32_t number = published_.load(std::memory_order_relaxed) + 1;
    begun_.store(number, std::memory_order_relaxed);
    store(parameters, number);
    published_.store(number, std::memory_order_release);
  }

  /// Removes all corrections: publishes the nominal robot.
  void fall_back() noexcept { publish(nominal_); }

  const Parameters& nominal() const noexcept { return nominal_; }

  /// Copies the last publication, in one try.
  /// @param parameters  valid if the copy is complete; else a mixture.
  /// @param number      of the publication that was copied.
  /// @returns whether the copy is complete. Real-time: yes.
  [[nodiscard]] bool copy(Parameters& parameters, std::uint32_t& number) const noexcept {
    number = published_.load(std::memory_order_acquire);
    load(parameters, number);
    // Counts may wrap: only their difference means something.
    return begun_.load(std::memory_order_relaxed) - number < 2;
  }

  /// Number of publications so far.
  std::uint32_t published() const noexcept { return published_.load(std::memory_order_acquire); }

 private:
  using Word = std::uint32_t;  // lock-free on small controllers too
  static_assert(std::is_trivially_copyable_v<Parameters>);
  static_assert(sizeof(Parameters) % sizeof(Word) == 0);
  static_assert(std::atomic<Word>::is_always_lock_free);
  static constexpr std::size_t kWords = sizeof(Parameters) / sizeof(Word);

  void store(const Parameters& parameters, std::uint32_t number) noexcept {
    const auto* bytes = reinterpret_cast<const unsigned char*>(&parameters);
    for (std::size_t k = 0; k < kWords; ++k) {
      Word word = 0;
      std::memcpy(&word, bytes + k * sizeof(Word), sizeof(Word));
      slots_[number % 2][k].store(word, std::memory_order_release);
    }
  }

  void load(Parameters& parameters, std::uint32_t number) const noexcept {
    auto* bytes = reinterpret_cast<unsigned char*>(&parameters);
    for (std::size_t k = 0; k < kWords; ++k) {
      const Word word = slots_[number % 2][k].load(std::memory_order_acquire);
      std::memcpy(bytes + k * sizeof(Word), &word, sizeof(Word));
    }
  }

  Parameters nominal_;
  std::array<std::array<std::atomic<Word>, kWords>, 2> slots_{};
  std::atomic<std::uint32_t> begun_{0}, published_{0};
};

/// The control thread's own copy: always complete. It starts with the nominal robot. If the publisher is too fast for
/// one try, it keeps its copy; the next cycle tries again.
template <typename Scalar>
class ParameterReader {
 public:
  explicit ParameterReader(const ParameterBuffer<Scalar>& buffer) noexcept
      : buffer_(&buffer), current_(buffer.nominal()) {}

  /// To be called once per cycle; copies only after a new publication. Real-time: yes, wait-free.
  const CompensatorParameters<Scalar>& latest() noexcept {
    (void)refresh();
    return current_;
  }

  /// The same. @returns whether the copy is a new one.
  bool refresh() noexcept {
    std::uint32_t number = 0;
    if (buffer_->published() == seen_ || !buffer_->copy(fresh_, number)) return false;
    current_ = fresh_;
    seen_ = number;
    return true;
  }

  const CompensatorParameters<Scalar>& current() const noexcept { return current_; }

 private:
  const ParameterBuffer<Scalar>* buffer_;
  CompensatorParameters<Scalar> current_, fresh_{};
  std::uint32_t seen_ = 0;
};

/// The control thread's compensator when parameters change while the machine moves. After a publication its joints go
/// in equal parts, one per cycle, from those of the old parameters to those of the new ones: no jump. A publication
/// during a change waits for its end.
template <typename Scalar>
class ChangingCompensator {
 public:
  /// @param cycles  of a change; 1: at once.
  ChangingCompensator(const ParameterBuffer<Scalar>& buffer, std::uint32_t cycles) noexcept
      : reader_(buffer), used_(buffer.nominal()), cycles_(cycles < 1 ? 1 : cycles) {}

  /// compensate() by the exact method, once per cycle. Real-time: yes; twice the time during a change.
  [[nodiscard]] CompensationStatus compensate(const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                                              CompensatorTilt<Scalar>* tilt = nullptr) noexcept {
    if (left_ == 0 && reader_.refresh()) left_ = cycles_;
    if (left_ == 0) return paracal::compensate(used_, CompensationWay::exact, pose, joints, tilt);
    CompensatorJoints<Scalar> from{}, to{};
    CompensatorTilt<Scalar> remaining;
    CompensationStatus status = paracal::compensate(used_, CompensationWay::exact, pose, from);
    if (status != CompensationStatus::ok) return status;
    status = paracal::compensate(reader_.current(), CompensationWay::exact, pose, to, &remaining);
    if (status != CompensationStatus::ok) return status;
    if (--left_ == 0) used_ = reader_.current();
    const Scalar share = static_cast<Scalar>(left_) / static_cast<Scalar>(cycles_);
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = to[i] + share * (from[i] - to[i]);
    if (tilt != nullptr) *tilt = remaining;
    return status;
  }

  bool is_changing() const noexcept { return left_ > 0; }

 private:
  ParameterReader<Scalar> reader_;
  CompensatorParameters<Scalar> used_;
  std::uint32_t cycles_, left_ = 0;
};

}  // namespace paracal

#pragma once

#include <Eigen/Core>
#include <array>
#include <random>
#include <string>
#include <vector>

namespace paracal::test {

/// A part program that nobody has written: motions, arcs, planes, units, steps (G91), places called otherwise (G92),
/// coordinate systems (G10 L2), tools (G43), rotations of C, feeds, comments anywhere. It keeps within 120 mm of its
/// first origin, and 40 mm along Z; its lines are numbered.
class RandomPart {
 public:
  struct Options {
    unsigned seed = 1;
    bool turns = true;  ///< C
    int lines = 25;
  };
  explicit RandomPart(const Options& options);

  const std::string& text() const { return text_; }
  /// Z of tools 1 and 2, mm.
  static constexpr std::array<double, 2> kToolLengths{31.5, 52.25};

 private:
  using Axes = std::array<double, 4>;

  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
  bool happens(double probability) { return uniform(0.0, 1.0) < probability; }
  int any_of(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }

  void add(const std::string& words);
  std::string comment();
  std::string axis_word(std::size_t axis, double place);
  double stated(std::size_t axis, double place) const;
  void begin();
  void straight();
  void turn();
  void arc();
  void switch_modes();
  void call_here();
  void define_system();
  void change_tool();
  std::string feed_word();
  Axes shift() const;

  std::mt19937 engine_;
  Options options_;
  std::string text_;
  int number_ = 0;
  Axes place_{};                   ///< in the machine, mm and deg
  std::array<Axes, 2> systems_{};  ///< origins of G54 and G55 in the machine
  std::size_t system_ = 0;
  Axes called_{};  ///< G92
  double tool_length_ = 0.0, unit_ = 1.0;
  bool is_incremental_ = false, by_inverse_time_ = false;
  int plane_ = 17;
};

}  // namespace paracal::test

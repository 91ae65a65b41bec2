#include "random_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace paracal::test {
namespace {

constexpr std::string_view kLetters = "XYZC";
constexpr double kReach = 120.0, kDepth = 40.0, kMostTurn = 170.0;  // mm, mm, deg

}  // namespace

/// C does not turn alone in G93: LinuxCNC moves by no less than 0.1 mm a minute then [linuxcnc, interp_inverse.cc].
RandomPart::RandomPart(const Options& options) : engine_(options.seed), options_(options) {
  begin();
  for (int k = 0; k < options.lines; ++k) {
    const int kind = any_of(14);
    if (kind < 5) straight();
    if (kind == 5 || kind == 6 || kind == 7) arc();
    if (kind == 8 && options_.turns && !by_inverse_time_) turn();
    if (kind == 9) switch_modes();
    if (kind == 10) call_here();
    if (kind == 11) define_system();
    if (kind == 12) change_tool();
    if (kind == 13) add(std::array{"M3 S1200", "G4 P0.1", "M8", "G64", "G61", "G40", "G80"}[any_of(7)]);
  }
  add("G94 G90");
  text_ += "M2\n";
}

std::string RandomPart::comment() {
  static constexpr std::array kComments{"(go)", "(G1 X5 Y5)", "(feed #3)", "(tool [2])", "(O100 sub)"};
  return happens(0.1) ? kComments[static_cast<std::size_t>(any_of(kComments.size()))] : "";
}

void RandomPart::add(const std::string& words) {
  ++number_;
  text_ += fmt::format("N{} {}{}{}\n", 10 * number_, comment(), words, happens(0.1) ? " ; G0 X0" : "");
}

RandomPart::Axes RandomPart::shift() const {
  Axes shift = systems_[system_];
  for (std::size_t axis = 0; axis < 4; ++axis) shift[axis] += called_[axis];
  shift[2] += tool_length_;
  return shift;
}

/// The number of a place in the machine.
double RandomPart::stated(std::size_t axis, double place) const {
  const double from = is_incremental_ ? place_[axis] : shift()[axis];
  return (place - from) / (axis == 3 ? 1.0 : unit_);
}

/// Goes where the rounded number says.
std::string RandomPart::axis_word(std::size_t axis, double place) {
  const int decimals = unit_ == 1.0 ? 3 : 4;
  const std::string number = fmt::format("{:.{}f}", stated(axis, place), decimals);
  const double from = is_incremental_ ? place_[axis] : shift()[axis];
  place_[axis] = std::stod(number) * (axis == 3 ? 1.0 : unit_) + from;
  return fmt::format("{}{}{}{}", comment(), happens(0.8) ? " " : "", kLetters[axis], number);
}

std::string RandomPart::feed_word() {
  if (by_inverse_time_) return fmt::format(" F{:.2f}", uniform(5.0, 60.0));
  return happens(0.4) ? fmt::format(" F{:.1f}", uniform(200.0, 3000.0) / unit_) : "";
}

void RandomPart::begin() {
  text_ = happens(0.5) ? "(a part)\n" : "%\n";
  add("G21 G90 G17 G94 G91.1 G54");
  for (int k = 0; k < 2; ++k) {
    Axes& origin = systems_[static_cast<std::size_t>(k)];
    if (k == 1) origin = {std::round(uniform(-20, 20)), std::round(uniform(-20, 20)), std::round(uniform(-5, 5)), 0.0};
    add(fmt::format("G10 L2 P{} X{:.3f} Y{:.3f} Z{:.3f}{}", k + 1, origin[0], origin[1], origin[2],
                    options_.turns ? " C0" : ""));
  }
  change_tool();
  std::string all = "G0";
  for (std::size_t axis = 0; axis < (options_.turns ? 4U : 3U); ++axis) all += axis_word(axis, uniform(-20, 20));
  add(all);
  add("F1200");
}

void RandomPart::straight() {
  std::string words = happens(0.7) ? "G1" : "G0";
  bool has_any = false;
  for (std::size_t axis = 0; axis < (options_.turns ? 4U : 3U); ++axis) {
    const bool is_alone = axis == 3 && !has_any && by_inverse_time_;
    if (is_alone || !happens(axis == 3 ? 0.2 : 0.6)) continue;
    const double reach = axis == 3 ? kMostTurn : axis == 2 ? kDepth : kReach;
    words += axis_word(axis, uniform(-reach, reach));
    has_any = true;
  }
  if (has_any) add(words + feed_word());
}

void RandomPart::turn() { add("G1" + axis_word(3, uniform(-kMostTurn, kMostTurn)) + feed_word()); }

/// About a centre that is chosen, so that the arc keeps within reach.
void RandomPart::arc() {
  const std::size_t normal = plane_ == 17 ? 2 : plane_ == 18 ? 1 : 0;
  const std::size_t one = (normal + 1) % 3, other = (normal + 2) % 3;
  const double radius = uniform(3.0, 15.0), angle = uniform(-3.1, 3.1), sweep = uniform(0.5, 5.5);
  const bool clockwise = happens(0.5);
  const std::array centre{place_[one] - radius * std::cos(angle), place_[other] - radius * std::sin(angle)};
  const auto leaves = [&](std::size_t axis, double middle) {
    return std::abs(middle) + radius > (axis == 2 ? kDepth + 20.0 : kReach + 20.0);
  };
  if (leaves(one, centre[0]) || leaves(other, centre[1])) return;
  const double end = clockwise ? angle - sweep : angle + sweep;
  const double i = (centre[0] - place_[one]) / unit_, j = (centre[1] - place_[other]) / unit_;
  std::string words = clockwise ? "G2" : "G3";
  words += axis_word(one, centre[0] + radius * std::cos(end)) + axis_word(other, centre[1] + radius * std::sin(end));
  if (happens(0.3)) words += axis_word(normal, std::clamp(place_[normal] + uniform(-5, 5), -kDepth, kDepth));
  const bool by_radius = happens(0.3) && std::abs(sweep - 3.1416) > 0.3;
  constexpr std::string_view kCentres = "IJK";
  words += by_radius ? fmt::format(" R{:.4f}", (sweep > 3.1416 ? -radius : radius) / unit_)
                     : fmt::format(" {}{:.4f} {}{:.4f}", kCentres[one], i, kCentres[other], j);
  add(words + feed_word());
}

void RandomPart::switch_modes() {
  switch (any_of(6)) {
    case 0:
      is_incremental_ = !is_incremental_;
      return add(is_incremental_ ? "G91" : "G90");
    case 1:
      unit_ = unit_ == 1.0 ? 25.4 : 1.0;
      add(unit_ == 1.0 ? "G21" : "G20");
      return add(fmt::format("F{:.1f}", 1000.0 / unit_));
    case 2:
      plane_ = 17 + any_of(3);
      return add(fmt::format("G{}", plane_));
    case 3:
      by_inverse_time_ = !by_inverse_time_;
      add(by_inverse_time_ ? "G93" : "G94");
      return by_inverse_time_ ? void() : add(fmt::format("F{:.1f}", 900.0 / unit_));
    case 4:
      system_ = 1 - system_;
      return add(system_ == 0 ? "G54" : "G55");
    default:
      called_ = {};
      return add("G92.1");
  }
}

void RandomPart::call_here() {
  const std::size_t axis = static_cast<std::size_t>(any_of(3));
  const double number = std::round(uniform(-30, 30));
  called_[axis] += place_[axis] - number * unit_ - shift()[axis];
  add(fmt::format("G92 {}{:.3f}", kLetters[axis], number));
}

void RandomPart::define_system() {
  const std::size_t system = static_cast<std::size_t>(any_of(2)), axis = static_cast<std::size_t>(any_of(3));
  const double number = std::round(uniform(-15, 15)) / (unit_ == 1.0 ? 1.0 : 10.0);
  systems_[system][axis] = number * unit_;
  add(fmt::format("G10 L2 P{} {}{:.3f}", system + 1, kLetters[axis], number));
}

/// Behind it all places are stated, as post-processors do.
void RandomPart::change_tool() {
  const int tool = 1 + any_of(2);
  tool_length_ = kToolLengths[static_cast<std::size_t>(tool) - 1];
  if (is_incremental_) add("G90");
  is_incremental_ = false;
  add(fmt::format("T{} M6", tool));
  add(fmt::format("G43 H{}", tool));
  if (number_ < 6) return;
  std::string all = "G0";
  for (std::size_t axis = 0; axis < (options_.turns ? 4U : 3U); ++axis) all += axis_word(axis, uniform(-20, 20));
  add(all);
}

}  // namespace paracal::test

#include "gcode_arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace paracal::io {
namespace {

constexpr std::string_view kNoCentre = "an arc without a centre in its plane";
constexpr std::string_view kTwoCentres = "an arc with both a centre and a radius";
constexpr std::string_view kNotReached = "an arc whose radius does not reach its end";
constexpr std::string_view kTurns = "an arc whose number of turns (P) is not a whole number from 1 to 1000";

/// Angles below which an arc that begins where it ends is a full turn, rad; controllers take 1e-6 [linuxcnc].
constexpr double kNoTurn = 1e-6;

using Plane = std::array<double, 2>;

Plane in_plane(const AxisValues& place, const ArcOfPath& arc) { return {place[arc.plane[0]], place[arc.plane[1]]}; }

/// How far radii at both ends may differ: places with three decimals, and centres rounded with them.
double slack(double radius) { return std::max(0.05, 0.005 * radius); }

/// To the left of the way from start to end for an arc of less than half a turn anticlockwise.
std::string_view centre_of_radius(double radius, bool clockwise, const Plane& start, const Plane& end, Plane& centre) {
  const Plane chord{end[0] - start[0], end[1] - start[1]};
  const double half = 0.5 * std::hypot(chord[0], chord[1]), size = std::abs(radius);
  if (half == 0.0 || half > size + slack(size)) return kNotReached;
  const double height = std::sqrt(std::max(0.0, size * size - half * half));
  const double to_left = (clockwise == (radius < 0.0) ? height : -height) / (2.0 * half);
  centre = {0.5 * (start[0] + end[0]) - to_left * chord[1], 0.5 * (start[1] + end[1]) + to_left * chord[0]};
  return {};
}

std::string_view find_centre(const ArcWords& words, bool clockwise, const Plane& start, const Plane& end,
                             ArcOfPath& arc) {
  const std::array stated{words.centre[arc.plane[0]], words.centre[arc.plane[1]]};
  const bool is_stated = stated[0] || stated[1];
  if (words.radius) {
    return is_stated ? kTwoCentres : centre_of_radius(*words.radius, clockwise, start, end, arc.centre);
  }
  if (!is_stated || (words.centre_is_place && !(stated[0] && stated[1]))) return kNoCentre;
  for (std::size_t k = 0; k < 2; ++k) {
    arc.centre[k] = words.centre_is_place ? *stated[k] : start[k] + stated[k].value_or(0.0);
  }
  return {};
}

}  // namespace

std::string_view make_arc(const ArcWords& words, ArcNormal normal, bool clockwise, TargetPath& path) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  ArcOfPath arc{.plane = {(normal + 1) % 3, (normal + 2) % 3}};
  if (words.centre[normal].value_or(0.0) != 0.0) return kNoCentre;  // some post-processors write K0 in G17
  if (!(words.turns >= 1.0 && words.turns <= 1000.0) || words.turns != std::floor(words.turns)) return kTurns;
  const Plane start = in_plane(path.from, arc), end = in_plane(path.to, arc);
  if (const std::string_view wrong = find_centre(words, clockwise, start, end, arc); !wrong.empty()) return wrong;
  const Plane from{start[0] - arc.centre[0], start[1] - arc.centre[1]},
      to{end[0] - arc.centre[0], end[1] - arc.centre[1]};
  arc.start_radius = std::hypot(from[0], from[1]);
  arc.end_radius = std::hypot(to[0], to[1]);
  if (!(std::abs(arc.end_radius - arc.start_radius) <= slack(arc.start_radius))) return kNotReached;
  arc.start_angle = std::atan2(from[1], from[0]);
  const double turned = std::atan2(to[1], to[0]) - arc.start_angle;  // in (-2 pi, 2 pi)
  const double forward = clockwise ? -turned : turned;
  const double once = forward - kTurn * std::floor(forward / kTurn);  // in [0, 2 pi)
  const double sweep = (once < kNoTurn ? kTurn : once) + kTurn * (words.turns - 1.0);
  arc.sweep = clockwise ? -sweep : sweep;
  path.arc = arc;
  return {};
}

}  // namespace paracal::io

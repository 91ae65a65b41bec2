#pragma once

// Private to io: when two readings or stations are the same, and how the readings of one file are collected.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"

namespace paracal::io {

using Coordinates = std::array<double, 3>;

/// Station and measured numbers, to the last bit. Two readings do not agree like that by chance: one is a copy.
/// Of the two quaternions of an orientation it holds one.
using ReadingKey = std::tuple<std::size_t, Coordinates, std::optional<Coordinates>, std::optional<double>,
                              std::optional<std::array<double, 4>>>;

ReadingKey key_of(const PointReading& reading);
ReadingKey key_of(const LengthReading& reading);
/// The same whichever of its two stations is named first.
ReadingKey key_of(const DistanceReading& reading);

bool is_same(const Pose& a, const Pose& b);
bool is_same(const std::optional<Joints>& a, const std::optional<Joints>& b);

/// Name of a file without its folder.
std::string title_of(const std::string& file);

/// Collects the readings of one file: counts a doubled one once and notes whatever a careful reader should know.
class SeriesBuilder {
 public:
  /// @param reach  of the robot, mm: as far, ten times, do points lie from each other.
  SeriesBuilder(const TextFile& file, double reach);

  bool is_empty() const { return measurements_.series.front().readings.empty(); }

  void note(std::string text) { measurements_.notes.push_back(std::move(text)); }
  void note(int line, std::string_view text);

  void add(int line, const std::string& pose, const PointReading& reading);

  /// To be called with at least one reading.
  /// @param stations  those that the readings name; only the ones that were read stay.
  /// @throws InputFileError for a point that is not among the others.
  Measurements finish(std::vector<Station> stations) &&;

 private:
  void check_spread() const;

  Measurements measurements_;
  double reach_;
  std::vector<int> lines_ = {};                                ///< of the readings
  std::map<ReadingKey, int> readings_;                         ///< line of the first
  std::map<Coordinates, std::pair<int, std::string>> points_;  ///< line and pose of the first
};

}  // namespace paracal::io

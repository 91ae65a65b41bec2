#pragma once

// Private to io: the part that filters of targets share, whatever the format. A format reads lines and says where
// numbers of a target stand; what is common corrects the targets of many lines at once and writes their numbers.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "paracal/io/target_filter.hpp"

namespace paracal::io {

inline constexpr std::size_t kAxes = 4;
inline constexpr std::size_t kRotation = 3;  ///< C, phi; before it X, Y, Z

/// Coordinates as files state them: x, y, z and phi, mm and deg.
using AxisValues = std::array<double, kAxes>;

/// A number in a line.
struct StatedNumber {
  std::size_t begin = 0, end = 0;
  double value = 0.0;  ///< in the unit of the line

  bool is_stated() const { return begin != end; }
};

/// A line that states a target.
struct TargetLine {
  std::size_t index = 0;    ///< among the lines that are read together
  std::int64_t number = 0;  ///< in the file, from 1
  AxisValues wanted{};
  std::array<StatedNumber, kAxes> stated{};
  double mm_per_unit = 1.0;

  // Only of G-code, where axes that are not stated keep their last value.
  std::array<bool, kAxes> passed{};  ///< the controller was told the wanted value in a line that was passed through
  bool may_insert = false;           ///< other axes may be added
  std::size_t insert_at = 0;         ///< behind the last axis word
  bool with_blank = false, in_lower_case = false;  ///< how added words are written
  std::size_t checksum_at = 0;                     ///< of '*', RepRap; 0: none
};

/// Counts what is passed through.
class Tally {
 public:
  void pass(std::string_view reason, std::int64_t line);
  /// What was passed since the last corrected target stands between two.
  void correct();
  /// In the order of their first lines.
  std::vector<PassedThrough> sorted() const;

 private:
  /// Since the last corrected target.
  struct Since {
    std::int64_t count = 0, first_line = 0;
  };

  std::vector<PassedThrough> passed_;
  std::vector<Since> since_;  ///< of each of these
  bool corrected_ = false, passes_since_ = false;
};

/// What differs between formats.
class TargetFormat {
 public:
  TargetFormat() = default;
  TargetFormat(const TargetFormat&) = delete;
  TargetFormat& operator=(const TargetFormat&) = delete;
  virtual ~TargetFormat() = default;

  /// Reads the next line.
  /// @param text  without the line end.
  /// @param target  has its number; gets what it states, if it states a target.
  /// @param passed  why not, if it may hold one; else empty.
  /// @returns whether it states a target.
  virtual bool read(std::string_view text, TargetLine& target, std::string_view& passed) = 0;
  /// A line too long to be read.
  virtual void skip() {}
  /// @throws InputFileError when something was missing.
  virtual void finish() const {}
};

FilterSummary filter(const TextStream& in, const TextSink& out, TargetFormat& format,
                     const TargetCorrection& correction, const Eigen::Vector3d& origin, unsigned threads);

}  // namespace paracal::io

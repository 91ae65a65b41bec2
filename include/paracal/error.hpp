#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace paracal {

/// Base class of all exceptions of this library. They report only mistakes of the caller or in a file, at construction
/// or load. Numerical results (unreachable, singular, not converged) have a status instead.
class Error : public std::runtime_error {
 public:
  /// @param message  is stored as printable().
  explicit Error(const std::string& message);
};

/// An invalid argument: a negative length, a NaN, two limbs at one azimuth. The message states the quantity, its value
/// and the violated limit, with units.
class InvalidArgument : public Error {
  using Error::Error;
};

/// A commanded pose that the robot cannot reach. The message names pose and limb.
class Unreachable : public Error {
  using Error::Error;
};

/// A file that cannot be used. The message reads `file:line: expected ..., got ...`; without the line if it concerns
/// the whole file.
class InputFileError : public Error {
 public:
  /// @param line  from 1; 0: the whole file.
  InputFileError(const std::string& file, int line, const std::string& complaint);

  const std::string& file() const { return file_; }
  int line() const { return line_; }

 private:
  std::string file_;
  int line_;
};

/// The first control character (including those that change the direction of text), except tabs. Empty if there is
/// none.
std::string_view control_character(std::string_view text);

/// Bytes as \x1b.
std::string escaped(std::string_view bytes);

/// A message that is safe for a terminal: control characters as \x1b, at most 2000
/// characters.
std::string printable(std::string_view message);

}  // namespace paracal

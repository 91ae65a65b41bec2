#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace paracal {

/// Root of everything this library throws. It is thrown only for what the caller or a file got wrong, at construction
/// or load; numerical outcomes (unreachable, singular, not converged) are statuses in results.
class Error : public std::runtime_error {
 public:
  /// @param message  is kept as printable().
  explicit Error(const std::string& message);
};

/// An argument that cannot be meant: a negative length, a NaN, two limbs at one azimuth. The message names the
/// quantity, the value that came and the limit that it breaks, with units.
class InvalidArgument : public Error {
  using Error::Error;
};

/// A commanded pose that the robot cannot reach. The message names pose and limb.
class Unreachable : public Error {
  using Error::Error;
};

/// A file that cannot be used. The message reads `file:line: expected ..., got ...`; the line is omitted if the
/// whole file is wrong.
class InputFileError : public Error {
 public:
  /// @param line  from 1; 0 if the whole file is wrong.
  InputFileError(const std::string& file, int line, const std::string& complaint);

  const std::string& file() const { return file_; }
  int line() const { return line_; }

 private:
  std::string file_;
  int line_;
};

/// The first character that a terminal obeys instead of showing it (those that turn round the order of others among
/// them); tabulators are none. Empty where there is none.
std::string_view control_character(std::string_view text);

/// Bytes as \x1b.
std::string escaped(std::string_view bytes);

/// A message as a terminal may show it: control characters, which come from files, as \x1b, and at most 2000
/// characters.
std::string printable(std::string_view message);

}  // namespace paracal

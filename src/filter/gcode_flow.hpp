#pragma once

// Private to io: O words of RS-274, subprograms and loops of one file, carried out.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode_expression.hpp"

namespace paracal::io {

/// A line as it is carried out.
struct CarriedOut {
  std::int64_t number = 0;  ///< in the file
  std::string text = {};    ///< with its end; values stand where there were parameters
};

/// Carries out a program as LinuxCNC does [linuxcnc, O codes]: sub, call, return, if, while, do, repeat, break,
/// continue. Only where all that it hangs on is known: each condition, each argument, each value in a line that is
/// carried out, each subprogram. Else nothing of it is.
class GcodeFlow {
 public:
  /// @param lines  of the file, with their ends, from the first one with an O word on; they must live as long.
  /// @param first  number of the first.
  GcodeFlow(std::vector<std::string_view> lines, std::int64_t first, GcodeParameters& parameters);

  /// @returns whether all of it was carried out.
  bool carry_out(std::vector<CarriedOut>& into);
  std::int64_t unfollowed_line() const { return unfollowed_line_; }
  std::string_view why_unfollowed() const { return why_; }

 private:
  enum class Word : std::uint8_t {
    none,
    unknown,
    sub,
    endsub,
    call,
    returns,
    when,
    elsewhen,
    otherwise,
    endif,
    loop,
    endloop,
    once,
    repeat,
    endrepeat,
    leave,
    again
  };
  enum class End : std::uint8_t { normal, leave, again, returned, program, failed };

  /// A line with an O word: its label, what it says, and what stands behind that.
  struct Flow {
    Word word = Word::none;
    std::string label = {};
    std::string_view rest = {};
  };

  static constexpr std::string_view kUnknownValue = "subprograms, jumps and loops: a value here is not known";
  static constexpr std::string_view kNotUnderstood = "subprograms, jumps and loops: a line that is not understood";
  static const std::array<std::pair<std::string_view, Word>, 15> kWords;

  static Flow flow_of(std::string_view line);
  End run(std::size_t from, std::size_t to, int depth);
  End take(std::size_t& at, std::size_t to, int depth);
  End take_line(std::size_t at);
  End state_shown(std::size_t at);
  /// Behind what is carried out, with the end of the line that it comes from.
  /// @param otherwise  its end where that line, the file's last, has none.
  void put(std::size_t at, std::string text, std::string_view otherwise = "");
  End take_if(std::size_t& at, int depth);
  End take_while(std::size_t& at, bool asks_first, int depth);
  End take_repeat(std::size_t& at, int depth);
  End call(std::size_t at, int depth);
  bool goes_on(End& end, const std::string& label);
  std::size_t find(std::size_t from, const std::string& label, std::initializer_list<Word> words) const;
  std::optional<double> condition(std::string_view text) const;
  End fail(std::size_t at, std::string_view why);

  std::vector<std::string_view> lines_;
  std::int64_t first_;
  GcodeParameters& parameters_;
  std::vector<Flow> flows_;                  ///< of each line
  std::map<std::string, std::size_t> subs_;  ///< where the subprogram of a label begins
  std::vector<CarriedOut>* into_ = nullptr;
  std::string leaving_ = {};  ///< label of the loop that is left or begun again
  std::int64_t unfollowed_line_ = 0;
  std::string_view why_ = {};
  std::size_t steps_ = 0;
};

}  // namespace paracal::io

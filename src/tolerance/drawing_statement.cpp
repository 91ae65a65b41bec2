#include "paracal/tolerance/drawing_statement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "paracal/error.hpp"

namespace paracal {
namespace {

using Kind = DrawnFeature::Kind;

constexpr double kSameSize = 1e-6;   // mm: a nominal size as typed is the robot's
constexpr double kNotWider = 1e-12;  // of itself: rounding of degrees and of the arcus sine
constexpr double kPlaceAxes = 0.5;   // of a zone's width, along each axis
constexpr double kSteepest = 1.0;    // rad: a zone about as wide as long says nothing
constexpr double kHalf = 0.5;        // of a grade's width: it lies evenly about the nominal size

/// Signs of drawings in the words that are read.
std::string in_words(std::string text) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kSigns{{{"+/-", "±"},
                                                                                        {"+-", "±"},
                                                                                        {"±", " pm "},
                                                                                        {"/", " / "},
                                                                                        {"⌀", " dia "},
                                                                                        {"Ø", " dia "},
                                                                                        {"ø", " dia "},
                                                                                        {"+", " + "}}};
  for (const auto& [sign, word] : kSigns) {
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign, at + word.size())) {
      text.replace(at, sign.size(), word);
    }
  }
  return text;
}

/// Reads a statement word by word.
class Words {
 public:
  explicit Words(std::string_view statement) : text_(in_words(std::string(statement))), rest_(text_) {}

  std::string_view peek() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    return rest_.substr(0, rest_.find_first_of(" \t"));
  }
  bool take(std::string_view word) {
    if (peek() != word || word.empty()) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::optional<double> number() {
    const std::string_view word = peek();
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    rest_.remove_prefix(word.size());
    return value;
  }
  std::optional<double> positive() {
    const std::optional<double> value = number();
    return value && *value > 0.0 ? value : std::nullopt;
  }
  bool at_end() { return peek().empty(); }

 private:
  std::string text_;
  std::string_view rest_;
};

/// What can be said of a feature, for messages.
std::string expected(const DrawnFeature& feature) {
  switch (feature.kind) {
    case Kind::size:
      return feature.sizes.size() == 1
                 ? fmt::format("a number, \"IT8\" or \"{} +- H\" ({})", feature.sizes.front(), feature.name)
                 : fmt::format("a number or \"IT8\" ({}, {} to {} mm)", feature.name, feature.sizes.front(),
                               feature.sizes.back());
    case Kind::place:
      return fmt::format("a number or \"position dia T\" ({})", feature.name);
    case Kind::turn: {
      std::string text = "a number";
      for (const auto& [orientation, to] : feature.data) {
        text += fmt::format(" or \"{} T/L\" ({} to {})", name(orientation), feature.name, to);
      }
      return text;
    }
    default:
      return "a number";
  }
}

/// A statement being read, with what its complaints need.
struct Reading {
  std::string_view statement;
  const DrawnFeature& feature;

  [[noreturn]] void refuse(std::string_view why = {}) const {
    throw InvalidArgument(
        fmt::format("expected {}, got \"{}\"{}{}", expected(feature), statement, why.empty() ? "" : ": ", why));
  }
};

/// Half the width of a grade at the size that it leaves widest, the largest.
double half_grade(const Reading& reading, StandardGrade grade) {
  std::optional<double> width;
  for (const double size : reading.feature.sizes) {
    width = standard_tolerance(grade, size);
    if (!width) reading.refuse(fmt::format("ISO 286-1 has no {} at {} mm", name(grade), size));
  }
  return kHalf * width.value_or(0.0);
}

void check_nominal(const Reading& reading, double size) {
  const std::vector<double>& sizes = reading.feature.sizes;
  if (sizes.size() > 1) reading.refuse("the limbs differ; state a grade (IT8) or a half-width instead of one size");
  if (std::abs(size - sizes.front()) > kSameSize)
    reading.refuse(fmt::format("the robot's size is {} mm", sizes.front()));
}

double size_of(const Reading& reading, Words& words) {
  const std::optional<double> nominal = words.number();
  if (nominal) check_nominal(reading, *nominal);
  const double both = reading.feature.is_of_pairs ? 2.0 : 1.0;
  if (nominal && words.take("pm")) {
    const std::optional<double> half = words.number();
    if (!half || *half < 0.0) reading.refuse("\"+-\" needs a number of at least 0");
    return both * *half;
  }
  const std::optional<StandardGrade> grade = standard_grade_named(words.peek());
  if (!grade) {
    reading.refuse("write symmetric limits (+- H) or the grade of a fit alone (IT7 for H7)");
  }
  words.take(name(*grade));
  return both * half_grade(reading, *grade);
}

/// A zone T/L: a line of length L fits between planes (or into a cylinder) T apart while L sin(turn) <= T.
std::optional<double> zone(Words& words) {
  words.take("dia");  // round or between planes: as wide
  const std::optional<double> width = words.positive();
  if (!width || !words.take("/")) return std::nullopt;
  const std::optional<double> length = words.positive();
  if (!length || *width >= *length) return std::nullopt;
  return std::asin(*width / *length);
}

double turn_of(const Reading& reading, Words& words) {
  const std::optional<double> turn = zone(words);
  if (!turn) reading.refuse("a zone is T/L: width T over a greater length L");
  return *turn;
}

double place_of(const Reading& reading, Words& words) {
  words.take("dia");
  const std::optional<double> width = words.positive();
  if (!width) reading.refuse("a position needs a zone width above 0");
  return kPlaceAxes * *width;
}

/// Zones of a chain of parts, with "+" between them.
double sum_of(const Reading& reading, Words& words, double (*zone)(const Reading&, Words&)) {
  double sum = zone(reading, words);
  while (words.take("+")) sum += zone(reading, words);
  return sum;
}

double orientation_of(const Reading& reading, Words& words) {
  for (const Orientation one : {Orientation::parallelism, Orientation::perpendicularity, Orientation::angularity}) {
    if (!words.take(name(one))) continue;
    if (std::ranges::find(reading.feature.data, one, &DrawnFeature::Datum::orientation) == reading.feature.data.end()) {
      reading.refuse(one == Orientation::angularity
                         ? "angularity does not apply to features that are parallel or perpendicular"
                         : "this does not limit the rotation");
    }
    return sum_of(reading, words, turn_of);
  }
  reading.refuse();
}

double position_of(const Reading& reading, Words& words) {
  if (!words.take("position")) reading.refuse();
  return sum_of(reading, words, place_of);
}

double half_width_of(const Reading& reading, Words& words) {
  switch (reading.feature.kind) {
    case Kind::size:
      return size_of(reading, words);
    case Kind::turn:
      return orientation_of(reading, words);
    case Kind::place:
      return position_of(reading, words);
    default:
      reading.refuse(reading.feature.name);
  }
}

/// A number to three digits that is not above the value: the nearest, else the one below.
std::string rounded_down(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  double count = std::round(value / unit);
  if (count * unit > value * (1.0 + kNotWider)) count -= 1.0;
  return fmt::format("{:.12g}", count * unit);
}

std::string grade_text(const std::optional<StandardGrade>& grade, double size) {
  if (size <= 0.0 || size > kLargestGradedSize) return "";
  if (!grade) return " (finer than any grade)";
  return fmt::format(" ({}{})", name(*grade), *grade < StandardGrade::IT5 ? ", finer than IT5" : "");
}

/// The coarsest grade that is within the half-width at every size.
std::optional<StandardGrade> grade_within(double half_width, const std::vector<double>& sizes) {
  const double width = half_width / kHalf * (1.0 + kNotWider);
  std::optional<StandardGrade> grade = StandardGrade::IT18;
  for (const double size : sizes) grade = std::min(grade, coarsest_grade(size, width));
  return grade;
}

DrawingStatement size_on_a_drawing(double half_width, const DrawnFeature& feature) {
  const double of_each = feature.is_of_pairs ? half_width / 2.0 : half_width;
  DrawingStatement said{.grade = grade_within(of_each, feature.sizes)};
  const std::string limits = "+- " + rounded_down(of_each);
  if (feature.sizes.size() == 1) {
    said.statement = fmt::format("{} {}", feature.sizes.front(), limits);
    said.text = fmt::format("{} {}", feature.name, said.statement);
  } else {
    if (said.grade) said.statement = name(*said.grade);
    said.text = fmt::format("{} {}", feature.name, limits);
  }
  said.text += grade_text(said.grade, feature.sizes.back());
  return said;
}

DrawingStatement turn_on_a_drawing(double half_width, const DrawnFeature& feature) {
  const double width = feature.length * std::sin(std::min(half_width, kSteepest));
  const DrawnFeature::Datum& datum = feature.data.front();
  const std::string zone = fmt::format("{}/{}", rounded_down(width), feature.length);
  DrawingStatement said{.statement = fmt::format("{} {}", name(datum.orientation), zone)};
  said.text = fmt::format("{}: {} to {}", feature.name, said.statement, datum.to);
  return said;
}

DrawingStatement place_on_a_drawing(double half_width, const DrawnFeature& feature) {
  DrawingStatement said{.statement = "position dia " + rounded_down(half_width / kPlaceAxes)};
  said.text = fmt::format("{}: {}", feature.name, said.statement);
  return said;
}

}  // namespace

double half_width_of(std::string_view statement, const DrawnFeature& feature) {
  const Reading reading{statement, feature};
  Words words(statement);
  const double half_width = half_width_of(reading, words);
  if (!words.at_end()) reading.refuse(fmt::format("remove \"{}\"", words.peek()));
  return half_width;
}

std::optional<double> turn_within(std::string_view text) {
  Words words(text);
  const std::optional<double> turn = zone(words);
  return words.at_end() ? turn : std::nullopt;
}

DrawingStatement on_a_drawing(double half_width, const DrawnFeature& feature) {
  switch (feature.kind) {
    case Kind::size:
      return size_on_a_drawing(half_width, feature);
    case Kind::turn:
      return turn_on_a_drawing(half_width, feature);
    case Kind::place:
      return place_on_a_drawing(half_width, feature);
    default:
      return {.text = std::string(feature.name)};
  }
}

std::optional<DrawingStatement> on_a_drawing(const Tolerances& tolerances, Source source, const Robot& robot) {
  if (!(tolerances[source] > 0.0)) return std::nullopt;
  return on_a_drawing(tolerances[source], drawn_feature(source, robot.limbs()));
}

}  // namespace paracal

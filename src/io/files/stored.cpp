#include "stored.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "paracal/error.hpp"

namespace paracal::io {
namespace {

/// A place in a text, whose copies share how far they came: a parser does not say where it is.
class Reading {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Reading(const char* at, const char** reached) : at_(at), reached_(reached) {}
  reference operator*() const { return *at_; }
  Reading& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  bool operator==(const Reading& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char** reached_;
};

/// Builds what a text says, and refuses it where it exceeds a limit or says a key twice.
class JsonBuilder final : public nlohmann::json_sax<Json> {
 public:
  explicit JsonBuilder(const TextFile& file)
      : file_(file),
        reached_(file.text.data()),
        memory_left_(kStoredLimits.memory_of_any + kStoredLimits.memory_per_byte * file.text.size()) {
    const char* const begin = file.text.data();
    Json::sax_parse(Reading(begin, &reached_), Reading(begin + file.text.size(), &reached_), this);
  }
  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }
  bool start_object(std::size_t /*count*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*count*/) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& key) override {
    auto& object = open_.back()->get_ref<Json::object_t&>();
    if (object.size() == kStoredLimits.keys) {
      refuse(fmt::format("expected at most {} keys in an object, got more", kStoredLimits.keys));
    }
    use(kPart);
    const auto [place, is_new] = object.emplace(key, nullptr);
    if (!is_new) refuse(fmt::format("expected each key once, got \"{}\" again; remove one of them", key));
    next_ = &place->second;
    return true;
  }
  bool parse_error(std::size_t byte, const std::string& token, const Json::exception& error) override {
    constexpr int kOutOfRange = 406;  // the library's number of this error
    reached_ = file_.text.data() + std::min(byte, file_.text.size());
    if (error.id == kOutOfRange) refuse(fmt::format("expected numbers below 1e309, got {}", token));
    const bool is_blank = file_.text.find_first_not_of(" \t\r\n") == std::string::npos;
    refuse(is_blank ? "expected JSON, got an empty file" : "expected JSON, got something else");
  }

 private:
  /// Bytes that a value takes, an array or object, and a key; more than they do once the text has ended.
  static constexpr std::size_t kValue = 48, kPart = 100;

  [[noreturn]] void refuse(const std::string& complaint) const {
    const auto byte = static_cast<std::size_t>(reached_ - file_.text.data());
    throw InputFileError(file_.name, line_at(file_.text, byte), complaint);
  }
  void use(std::size_t bytes) {
    if (bytes > memory_left_) refuse("expected fewer values in a file of this length, got more");
    memory_left_ -= bytes;
  }
  bool add(Json value) {
    use(kValue);
    return put(std::move(value)) != nullptr;
  }
  Json* put(Json value) {
    if (open_.empty()) return &(root_ = std::move(value));
    if (open_.back()->is_object()) return &(*next_ = std::move(value));
    return &open_.back()->get_ref<Json::array_t&>().emplace_back(std::move(value));
  }
  bool open(Json empty) {
    use(kPart);
    open_.push_back(put(std::move(empty)));
    if (std::ssize(open_) > kStoredLimits.levels) {
      refuse(fmt::format("expected at most {} levels of nesting, got more", kStoredLimits.levels));
    }
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const TextFile& file_;
  const char* reached_;
  std::size_t memory_left_;
  Json root_ = {};
  std::vector<Json*> open_ = {};  ///< arrays and objects around the next value
  Json* next_ = nullptr;          ///< of the key before it
};

/// A TOML text, one character after the other, outside of comments and quotation marks.
class Bare {
 public:
  explicit Bare(std::string_view text) : rest_(text) {}

  /// '\0' at the end.
  char next() {
    while (!rest_.empty()) {
      const char one = take(1);
      if (one == '#') {
        rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
      } else if (one == '"' || one == '\'') {
        skip_quoted(one);
      } else {
        return one;
      }
    }
    return '\0';
  }
  int line() const { return line_; }

 private:
  char take(std::size_t count) {
    const char first = rest_.front();
    line_ += static_cast<int>(std::ranges::count(rest_.substr(0, count), '\n'));
    rest_.remove_prefix(std::min(count, rest_.size()));
    return first;
  }

  /// Three marks begin a text of several lines, which three end; a backslash hides what follows it from ".
  void skip_quoted(char mark) {
    const std::string three(3, mark);
    const bool is_long = rest_.starts_with(three.substr(1));
    if (is_long) take(2);
    while (!rest_.empty()) {
      if (mark == '"' && rest_.front() == '\\') {
        take(2);
      } else if (is_long ? rest_.starts_with(three) : rest_.front() == mark || rest_.front() == '\n') {
        take(is_long ? 3 : 1);
        return;
      } else {
        take(1);
      }
    }
  }

  std::string_view rest_;
  int line_ = 1;
};

}  // namespace

Json parse_json(const TextFile& file) { return JsonBuilder(file).take(); }

int line_at(std::string_view text, std::size_t byte) {
  return static_cast<int>(1 + std::ranges::count(text.substr(0, byte), '\n'));
}

std::optional<int> line_of_endless_key(std::string_view text) {
  constexpr std::string_view kEndsKeys = ",[]{}=\n";
  Bare bare(text);
  int dots = 0;
  for (char one = bare.next(); one != '\0'; one = bare.next()) {
    if (kEndsKeys.find(one) != std::string_view::npos) dots = 0;
    if (one == '.' && ++dots > kStoredLimits.levels) return bare.line();
  }
  return std::nullopt;
}

std::optional<int> line_of_deep_nesting(std::string_view text) {
  Bare bare(text);
  int levels = 0;
  for (char one = bare.next(); one != '\0'; one = bare.next()) {
    if (one == '[' || one == '{') ++levels;
    if (one == ']' || one == '}') --levels;
    if (levels > kStoredLimits.levels) return bare.line();
  }
  return std::nullopt;
}

}  // namespace paracal::io

#include "tokens.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

namespace paracal::test {

StructuredTextError::StructuredTextError(int line, const std::string& what)
    : std::runtime_error(fmt::format("line {}: {}", line, what)) {}

namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Words that mean something: those of the subset, and those that any of the tools keeps for itself.
constexpr std::string_view kKeywordList = R"(
    ABS ABSTRACT ACOS ACTION ADD ADR AND ANY ARRAY ASIN AT ATAN ATAN2 BOOL BY BYTE CAL CASE CLASS CONCAT
    CONFIGURATION CONSTANT CONTINUE COS CTD CTU CTUD DATE DELETE DINT DIV DO DT DWORD ELSE ELSIF END_ACTION
    END_CASE END_FOR END_FUNCTION END_FUNCTION_BLOCK END_IF END_PROGRAM END_REPEAT END_STRUCT END_TYPE END_VAR
    END_WHILE EQ EXIT EXP EXPT EXTENDS FALSE FINAL FIND FOR FROM FUNCTION FUNCTION_BLOCK F_EDGE F_TRIG GE GET
    GOTO GT IF IMPLEMENTS INI INITIAL_STEP INSERT INT INT_TO_LREAL INTERFACE INTERNAL JMP LD LE LEFT LEN LIMIT LINT LN LOG
    LREAL LT LWORD MAX METHOD MID MIN MOD MOVE MUL MUX NE NON_RETAIN NOT NULL OF ON OR OVERRIDE PERSISTENT
    POINTER PRIORITY PRIVATE PROGRAM PROPERTY PROTECTED PUBLIC READ_ONLY READ_WRITE REAL REFERENCE REPEAT
    REPLACE RESOURCE RET RETAIN RETURN RIGHT ROL ROR RS R_EDGE R_TRIG SEL SEMA SET SHL SHR SIN SINGLE SINT
    SIZEOF SQRT SR STEP STRING STRUCT SUB SUPER TAN TASK THEN THIS TIME TO TOD TOF TON TP TRANSITION TRUE TRUNC
    TYPE UDINT UINT ULINT UNTIL USINT VAR VAR_ACCESS VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL VAR_INPUT VAR_IN_OUT
    VAR_OUTPUT VAR_TEMP WHILE WITH WORD WSTRING XOR)";

const std::set<std::string, std::less<>>& keywords() {
  static const std::set<std::string, std::less<>> kWords = [] {
    std::istringstream list{std::string(kKeywordList)};
    return std::set<std::string, std::less<>>(std::istream_iterator<std::string>(list), {});
  }();
  return kWords;
}

constexpr std::array<std::string_view, 18> kSigns{":=", "<=", ">=", "<>", "..", "=", "<", ">", "+",
                                                  "-",  "*",  "/",  "(",  ")",  "[", "]", ",", ";"};

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  std::vector<Token> tokens() {
    for (skip(); at_ < text_.size(); skip()) tokens_.push_back(next());
    tokens_.push_back({Token::Kind::end, "the end", line_});
    return std::move(tokens_);
  }

 private:
  char here(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  bool starts(std::string_view with) const { return text_.substr(at_).starts_with(with); }

  void skip() {
    while (at_ < text_.size()) {
      if (here() == '\n') ++line_;
      if (starts("(*")) {
        comment();
      } else if (here() == ' ' || here() == '\n') {
        ++at_;
      } else {
        return;
      }
    }
  }

  void comment() {
    const int began = line_;
    for (at_ += 2; !starts("*)"); ++at_) {
      if (at_ >= text_.size()) throw StructuredTextError(began, "a comment without end");
      if (starts("(*")) throw StructuredTextError(line_, "a comment within a comment");
      if (here() == '\n') ++line_;
    }
    at_ += 2;
  }

  Token next() {
    if (is_letter(here())) return word();
    if (is_digit(here())) return number();
    for (const std::string_view sign : kSigns) {
      if (starts(sign)) return take(Token::Kind::sign, sign.size());
    }
    if (here() == ':' || here() == '.') return take(Token::Kind::sign, 1);
    throw StructuredTextError(line_, fmt::format("'{}' is nothing of the language", here()));
  }

  Token take(Token::Kind kind, std::size_t size) {
    if (starts("//")) throw StructuredTextError(line_, "// is no comment everywhere");
    Token token{kind, std::string(text_.substr(at_, size)), line_};
    at_ += size;
    return token;
  }

  Token word() {
    std::size_t size = 0;
    while (is_letter(here(size)) || is_digit(here(size))) ++size;
    Token token = take(Token::Kind::word, size);
    for (char& c : token.text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const std::string& name = token.text;
    if (size > 32 || name.front() == '_' || name.back() == '_' || name.find("__") != std::string::npos) {
      throw StructuredTextError(line_, "some tool does not take the name " + name);
    }
    if (keywords().contains(name)) token.kind = Token::Kind::keyword;
    return token;
  }

  Token number() {
    std::size_t size = digits(0);
    if (here(size) == '.' && here(size + 1) != '.') {
      size = digits(size + 1);
      if (here(size) == 'E') size = digits(size + (here(size + 1) == '+' || here(size + 1) == '-' ? 2 : 1));
      if (!is_letter(here(size))) return take(Token::Kind::real, size);
    } else if (!is_letter(here(size))) {
      return take(Token::Kind::integer, size);
    }
    throw StructuredTextError(line_, "expected a number like 1.0E-5");
  }

  /// @returns where digits, at least one, end.
  std::size_t digits(std::size_t first) const {
    if (!is_digit(here(first))) throw StructuredTextError(line_, "expected a number like 1.0E-5");
    while (is_digit(here(first))) ++first;
    return first;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view text) { return Reader(text).tokens(); }

}  // namespace paracal::test

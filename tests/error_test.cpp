#include "paracal/error.hpp"

#include <gtest/gtest.h>

namespace paracal::error_test {
namespace {

/// A terminal shows all of a message, and in its order.
TEST(Errors, AreTextWhateverTheFileHeld) {
  const std::string nul("a\0b", 3);
  EXPECT_STREQ(Error(nul).what(), "a\\x00b");
  EXPECT_STREQ(InputFileError("\u202Evsc.p", 2, "expected \x1B[2J\x7F, got \u2066\u0085").what(),
               "\\xe2\\x80\\xaevsc.p:2: expected \\x1b[2J\\x7f, got \\xe2\\x81\\xa6\\xc2\\x85");
  const std::string shown = "Me\u00DFpunkt\t5 \u00B5m \u20AC \u200B\u2027\u202F\u2065\u00A0";
  EXPECT_EQ(printable(shown), shown);
  EXPECT_TRUE(control_character(shown).empty());
  EXPECT_EQ(printable("\xE2\x80"), "\xE2\x80") << "cut";
  EXPECT_EQ(printable(std::string(3000, 'x')), std::string(2000, 'x') + " ... (1000 characters more)");
}

}  // namespace
}  // namespace paracal::error_test

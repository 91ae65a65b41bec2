#include "paracal/io/decimal_sign.hpp"

#include <gmock/gmock.h>

namespace paracal::io::decimal_sign_test {
namespace {

using testing::HasSubstr;

DecimalSign shown_by(const std::string& field) {
  DecimalSign sign;
  sign.look(field, 7);
  return sign;
}

TEST(DecimalSign, IsShownByNumbersThatCannotBeMeantOtherwise) {
  for (const std::string field : {"1,5", "-0,125", "+12,25", "1234,125", "1,2345", "0,5e3", ",5", "1,125e2"}) {
    const DecimalSign sign = shown_by(field);
    EXPECT_TRUE(sign.is_known()) << field;
    EXPECT_EQ(sign.number("1,125"), 1.125) << field;
    EXPECT_EQ(sign.number("-3"), -3.0) << field;
    EXPECT_EQ(sign.number("1.5"), std::nullopt) << field;
    EXPECT_EQ(sign.why_not("1.5"), " (line 7 has a decimal comma)") << field;
  }
  for (const std::string field : {"1.5", "-0.125", "1.125"}) {
    const DecimalSign sign = shown_by(field);
    EXPECT_TRUE(sign.is_known()) << field;
    EXPECT_EQ(sign.number("1.125"), 1.125) << field;
    EXPECT_EQ(sign.number("1,5"), std::nullopt) << field;
    EXPECT_EQ(sign.why_not("1,125"), " (line 7 has a decimal point)") << field;
  }
}

TEST(DecimalSign, IsNotShownByAnythingElse) {
  for (const std::string field :
       {"1,125", "-12,000", "+999,999", "", "7", "1e5", "P1,5", "1,2,5", "1.234,5", "1,234,567", ",", "1,5 mm"}) {
    EXPECT_FALSE(shown_by(field).is_known()) << field;
  }
}

TEST(DecimalSign, WhatMayBeTwoNumbersIsNone) {
  const DecimalSign unknown;
  EXPECT_EQ(unknown.number("-1,125"), std::nullopt);
  EXPECT_THAT(unknown.why_not("-1,125"), HasSubstr("-1.125 or -1125? For decimal commas add --decimal-comma"));
  EXPECT_THAT(unknown.why_not("1,5"), HasSubstr("(for decimal commas add --decimal-comma)"));
  EXPECT_EQ(unknown.why_not("P1"), "");
  EXPECT_EQ(unknown.number("1.5"), 1.5);
}

TEST(DecimalSign, SomebodySaysIt) {
  const DecimalSign comma(true);
  EXPECT_TRUE(comma.is_known());
  EXPECT_EQ(comma.number("1,125"), 1.125);
  EXPECT_EQ(comma.number("1.125"), std::nullopt);
  EXPECT_EQ(comma.number("1.234,5"), std::nullopt);
  EXPECT_EQ(comma.why_not("1.125"), " (--decimal-comma is given)");
}

TEST(DecimalSign, TheFirstThatShowsItSaysIt) {
  DecimalSign sign = shown_by("1,125");
  sign.look("2,5", 8);
  sign.look("2.5", 9);
  EXPECT_EQ(sign.number("1,125"), 1.125);
  EXPECT_EQ(sign.why_not("2.5"), " (line 8 has a decimal comma)");
}

TEST(DecimalSign, NumbersWithEitherSign) {
  for (const std::string field : {"1", "1.5", "1,5", "1,125", "-1e3"}) EXPECT_TRUE(may_be_number(field)) << field;
  for (const std::string field : {"", "X", "1.5.2", "nan", "1,5 mm"}) EXPECT_FALSE(may_be_number(field)) << field;
}

}  // namespace
}  // namespace paracal::io::decimal_sign_test

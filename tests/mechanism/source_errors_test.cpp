#include "paracal/mechanism/source_errors.hpp"

#include <gtest/gtest.h>

namespace paracal {
namespace {

TEST(Source, NamesReadBackAndAreTheContracts) {
  const std::array<std::string_view, kSourceCount> contract{
      "theta_offset",     "e_x",     "e_y",    "e_z",    "arm_length", "alpha0", "beta0", "rod_mean", "rod_difference",
      "width_difference", "alpha03", "beta03", "alpha2", "beta2"};
  for (const Source source : all_sources()) {
    EXPECT_EQ(name(source), contract[index(source)]);
    EXPECT_EQ(source_named(name(source)), source);
  }
  EXPECT_FALSE(source_named("theta"));
}

TEST(Source, LengthsAreMmAndAnglesRad) {
  for (const Source source : all_sources()) {
    const std::string_view text = name(source);
    const bool angle = text.starts_with("alpha") || text.starts_with("beta");
    const Unit expected = angle ? Unit::rad : Unit::mm;
    EXPECT_EQ(unit(source, Actuator::linear), expected) << text;
    EXPECT_EQ(unit(source, Actuator::revolute), text.starts_with("theta") ? Unit::rad : expected) << text;
  }
}

TEST(Source, TiltGroupIsTheLastSix) {
  EXPECT_FALSE(tilts_plate(Source::rod_mean));
  EXPECT_TRUE(tilts_plate(Source::rod_difference));
  EXPECT_EQ(index(Source::rod_difference), kPositionSourceCount);
}

TEST(SourceErrors, StartAtZero) {
  const SourceErrors errors;
  for (const Source source : all_sources()) EXPECT_EQ(errors(3, source), 0.0);
}

}  // namespace
}  // namespace paracal

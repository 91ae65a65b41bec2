#include "paracal/mechanism/source_errors.hpp"

#include <gtest/gtest.h>

namespace paracal::source_errors_test {
namespace {

TEST(Source, NamesReadBackAndAreTheContracts) {
  const std::array<std::string_view, kSourceCount> contract{
      "theta_offset",     "e_x",     "e_y",    "e_z",    "arm_length", "alpha0", "beta0", "rod_mean", "rod_difference",
      "width_difference", "alpha03", "beta03", "alpha2", "beta2"};
  for (const Source source : all_sources()) {
    EXPECT_EQ(name(source), contract[index(source)]);
    EXPECT_EQ(source_named(name(source), Actuator::revolute), source);
  }
  EXPECT_FALSE(source_named("theta", Actuator::revolute));
  EXPECT_FALSE(source_named("zero", Actuator::linear));
}

TEST(Source, LengthsAreMmAndAnglesRad) {
  for (const Source source : all_sources()) {
    const std::string_view text = name(source);
    const bool angle = text.starts_with("alpha") || text.starts_with("beta");
    const Unit expected = angle ? Unit::rad : Unit::mm;
    EXPECT_EQ(unit(source, Actuator::linear), source == Source::gain ? Unit::mm_per_m : expected) << text;
    EXPECT_EQ(unit(source, Actuator::revolute), text.starts_with("theta") ? Unit::rad : expected) << text;
  }
}

TEST(Source, CarriagesHaveAGainInsteadOfAnArm) {
  for (const Source source : all_sources()) {
    const std::string_view expected = source == Source::gain ? "gain" : name(source);
    EXPECT_EQ(name(source, Actuator::linear), expected);
    EXPECT_EQ(source_named(expected, Actuator::linear), source);
    EXPECT_EQ(is_felt(source, Actuator::linear), source != Source::e_z) << expected;
  }
  EXPECT_FALSE(source_named("arm_length", Actuator::linear));
  EXPECT_FALSE(source_named("gain", Actuator::revolute));
}

TEST(Source, StrutsHaveEightOfTheirOwn) {
  const std::array<std::string_view, 8> contract{"zero", "base_x",  "base_y",  "base_z",
                                                 "gain", "plate_x", "plate_y", "plate_z"};
  const auto sources = sources_of(Actuator::strut);
  ASSERT_EQ(sources.size(), contract.size());
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const Source source = sources[k];
    EXPECT_EQ(name(source, Actuator::strut), contract[k]);
    EXPECT_EQ(source_named(contract[k], Actuator::strut), source);
    EXPECT_EQ(unit(source, Actuator::strut), source == Source::gain ? Unit::mm_per_m : Unit::mm);
    EXPECT_TRUE(is_felt(source, Actuator::strut));
    EXPECT_FALSE(tilts_plate(source, Actuator::strut));
  }
  EXPECT_FALSE(source_named("theta_offset", Actuator::strut));
  EXPECT_FALSE(source_named("alpha2", Actuator::strut));
}

TEST(Source, CoordinatesOfAPointShareAName) {
  EXPECT_EQ(shared_name(Source::e_z, Actuator::revolute), "e");
  EXPECT_EQ(coordinate(Source::e_z, Actuator::revolute), 2U);
  EXPECT_FALSE(is_leading(Source::e_z, Actuator::revolute));
  EXPECT_TRUE(is_leading(Source::e_x, Actuator::revolute));
  EXPECT_EQ(shared_name(Source::rod_mean, Actuator::linear), "rod_mean");
  EXPECT_FALSE(coordinate(Source::rod_mean, Actuator::linear));
  EXPECT_EQ(shared_name(Source::e_y, Actuator::strut), "base");
  EXPECT_EQ(shared_name(Source::plate_y, Actuator::strut), "plate");
  EXPECT_EQ(coordinate(Source::plate_y, Actuator::strut), 1U);
  EXPECT_TRUE(is_leading(Source::gain, Actuator::strut));
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
}  // namespace paracal::source_errors_test

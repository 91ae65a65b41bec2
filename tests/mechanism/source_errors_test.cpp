#include "paracal/mechanism/source_errors.hpp"

#include <gtest/gtest.h>

#include <set>

#include "paracal/mechanism/parameter.hpp"

namespace paracal::source_errors_test {
namespace {

TEST(Source, NamesReadBackAndAreTheContracts) {
  const std::array<std::string_view, 14> contract{
      "theta_offset",     "e_x",     "e_y",    "e_z",    "arm_length", "alpha0", "beta0", "rod_mean", "rod_difference",
      "width_difference", "alpha03", "beta03", "alpha2", "beta2"};
  for (const Source source : sources_of(Actuator::revolute)) {
    EXPECT_EQ(name(source), contract[place_in(Actuator::revolute, source)]);
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
    EXPECT_EQ(unit(source, Actuator::linear), source == "gain" ? Unit::mm_per_m : expected) << text;
    if (source != "gain") {
      EXPECT_EQ(unit(source, Actuator::revolute), is_joint_zero(source) || is_harmonic(source) ? Unit::rad : expected)
          << text;
    }
  }
}

TEST(Source, CarriagesHaveAGainInsteadOfAnArm) {
  EXPECT_EQ(place_in(Actuator::linear, "gain"), place_in(Actuator::revolute, "arm_length"));
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
    EXPECT_EQ(name(source), contract[k]);
    EXPECT_EQ(source_named(contract[k], Actuator::strut), source);
    EXPECT_EQ(unit(source, Actuator::strut), source == "gain" ? Unit::mm_per_m : Unit::mm);
    EXPECT_FALSE(tilts_plate(source));
  }
  EXPECT_FALSE(source_named("theta_offset", Actuator::strut));
  EXPECT_FALSE(source_named("alpha2", Actuator::strut));
}

TEST(Source, CoordinatesOfAPointShareAName) {
  EXPECT_EQ(shared_name("e_z"), "e");
  EXPECT_EQ(coordinate("e_z"), 2U);
  EXPECT_FALSE(is_leading("e_z"));
  EXPECT_TRUE(is_leading("e_x"));
  EXPECT_EQ(shared_name("rod_mean"), "rod_mean");
  EXPECT_FALSE(coordinate("rod_mean"));
  EXPECT_EQ(shared_name("base_y"), "base");
  EXPECT_EQ(shared_name("plate_y"), "plate");
  EXPECT_EQ(coordinate("plate_y"), 1U);
  EXPECT_TRUE(is_leading("gain"));
}

TEST(Source, TiltGroupIsTheLastSix) {
  EXPECT_FALSE(tilts_plate("rod_mean"));
  EXPECT_TRUE(tilts_plate("rod_difference"));
  EXPECT_EQ(place_in(Actuator::revolute, "rod_difference"), 8U);
}

/// Seeds keep their machines: today's names keep their numbers, and a new name disturbs none of them.
TEST(Source, EachKindOfLimbDrawsEveryErrorByANumberOfItsOwn) {
  for (const Actuator kind :
       {Actuator::revolute, Actuator::linear, Actuator::strut, Actuator::crank, Actuator{Drive::rail, 1, true}}) {
    std::set<std::uint64_t> numbers;
    for (const Source source : sources_of(kind)) numbers.insert(number_of(3, source));
    EXPECT_EQ(numbers.size(), sources_of(kind).size());
  }
  EXPECT_EQ(number_of(2, "beta2"), 14U * 2 + 13);
  EXPECT_EQ(number_of(1, "plate_z"), 14U + 10);
}

TEST(SourceErrors, StartAtZero) {
  const SourceErrors errors;
  for (const Source source : all_sources()) EXPECT_EQ(errors(3, source), 0.0);
}

}  // namespace
}  // namespace paracal::source_errors_test

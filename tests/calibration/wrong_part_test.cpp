// One part of a machine is far off: the calibration must name it, and must not blame its like on other limbs.

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "calibration/verdict/component_candidates.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/base_motion.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::wrong_part_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNoise = 0.017;  // mm

/// What a limb may suffer, on one limb of a machine drawn from the robot's tolerances.
struct Fault {
  std::string note;  ///< how the sentence about it begins, but for the limb
  std::function<void(const Robot&, std::size_t limb, SourceErrors&)> strike;
};

Fault off(Source source, double by) {
  return {std::string(name(source)),
          [=](const Robot&, std::size_t limb, SourceErrors& errors) { errors(limb, source) += by; }};
}

/// 15 and 40 mm are 17 to 150 standard deviations of what these robots' tolerances say.
std::vector<Fault> faults_of(const Robot& robot) {
  const Actuator actuator = robot.actuator();
  if (actuator == Actuator::strut) {
    return {off("zero", -15.0), off("zero", 40.0), off("plate_x", -15.0)};
  }
  const Source rod = !robot.is_level() ? Source("rod_length") : Source("rod_mean");
  std::vector<Fault> faults{off(rod, -15.0), off(rod, actuator == Actuator::carriage ? 15.0 : 40.0),
                            off("beta0", to_radians(-3.0))};
  if (swings_arm(actuator)) faults.push_back(off("arm_length", 40.0));
  if (robot.is_level()) {
    faults.push_back({"e_", [](const Robot& of, std::size_t limb, SourceErrors& errors) {
                        shift_limb(of, limb, -40.0 * of.nominal().limbs[limb].radial, errors);
                      }});
  }
  return faults;
}

/// Coordinates at 20 poses, of a plate with six freedoms at 30.
const std::vector<Station>& plan(const Robot& robot) {
  static std::map<std::string, std::vector<Station>> plans;
  std::vector<Station>& stations = plans[robot.name()];
  if (stations.empty()) {
    stations = select_stations(robot, candidate_stations(robot, 200, 1),
                               {.poses = !robot.is_level() ? 30 : 20, .largest_sweeps = 1})
                   .stations;
  }
  return stations;
}

class WrongPartLaw : public EveryRobot {};

/// Of all machines one note, about that part of that limb: 95 % of them, written before it was tried.
TEST_P(WrongPartLaw, IsNamedAndNoOther) {
  int named = 0, all = 0;
  std::string other;
  for (const Fault& fault : faults_of(robot)) {
    for (int number = 0; number < 2; ++number, ++all) {
      const auto limb = static_cast<std::size_t>(number + 1) % robot.limb_count();
      SourceErrors errors = measured_machine(robot, plan(robot), number, {}).errors;
      fault.strike(robot, limb, errors);
      const Calibration found =
          calibrate(robot, measure(robot, errors, plan(robot), number, {.noise = kNoise}), {.states_use = false});
      const std::string whose = " of limb " + std::to_string(limb + 1) + " ";
      const bool right =
          found.accepted() && testing::Value(found.notes, ElementsAre(AllOf(StartsWith(fault.note), HasSubstr(whose))));
      named += right;
      if (!right) other += fault.note + whose + testing::PrintToString(found.notes) + "\n";
    }
  }
  EXPECT_GE(named, 0.95 * all) << other;
}

PARACAL_ON_EVERY_ROBOT(WrongPartLaw);
PARACAL_ON_HEXAPODS(WrongPartLaw);

/// Four brackets hold the base of this robot, and one that stands off by 5 mm is hardly told from its neighbour: then
/// both are named, and what to do.
TEST(WrongPart, IsNamedBesideItsEqual) {
  const Robot robot = catalogue::huang2016();
  int doubtful = 0;
  for (int number = 0; number < 12; ++number) {
    const auto limb = static_cast<std::size_t>(number) % 4;
    SourceErrors errors = measured_machine(robot, plan(robot), number, {}).errors;
    shift_limb(robot, limb, 6.0 * robot.nominal().limbs[limb].radial, errors);
    const Calibration found =
        calibrate(robot, measure(robot, errors, plan(robot), number, {.noise = kNoise}), {.states_use = false});
    for (const std::string& note : found.notes) {
      if (note.find("would explain the readings equally well: measure the parts") == std::string::npos) continue;
      ++doubtful;
      EXPECT_THAT(note, HasSubstr("of limb " + std::to_string(limb + 1) + " "));
    }
  }
  EXPECT_GT(doubtful, 0);
}

/// What is worth a fit: the three that promise most, the best of each family, parts about as good as the best of them.
TEST(WorthTrying, IsWhatMayBeTheBest) {
  using detail::ComponentFamily;
  const auto candidate = [](ComponentFamily family, std::string subject, double promised) {
    return detail::ComponentCandidate{
        .family = family, .subject = std::move(subject), .promised = promised, .price = 1.0};
  };
  const std::vector<detail::ComponentCandidate> tried = detail::worth_trying(
      {candidate(ComponentFamily::one, "far", 80.0), candidate(ComponentFamily::group, "", 200.0),
       candidate(ComponentFamily::kind, "", 190.0), candidate(ComponentFamily::kind, "", 180.0),
       candidate(ComponentFamily::kind, "", 170.0), candidate(ComponentFamily::one, "best", 100.0),
       candidate(ComponentFamily::one, "near", 91.0), candidate(ComponentFamily::in_limb, "centre", 40.0),
       candidate(ComponentFamily::one, "near", 96.0), candidate(ComponentFamily::one, "near", 95.0),
       candidate(ComponentFamily::one, "near", 94.0), candidate(ComponentFamily::one, "near", 93.0),
       candidate(ComponentFamily::noise, "", 2.5)});
  std::vector<double> promises;
  for (const detail::ComponentCandidate& one : tried) promises.push_back(one.promised);
  EXPECT_THAT(promises, ElementsAre(200.0, 190.0, 180.0, 100.0, 96.0, 95.0, 94.0, 93.0, 40.0));
}

}  // namespace
}  // namespace paracal::test::wrong_part_test

#include "misprint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// "rod_mm and arm_mm"
std::string key_of(const Misprint& misprint) {
  std::vector<std::string> keys;
  for (const Dimension& one : misprint.of) keys.push_back(one.key);
  return fmt::format("{}", fmt::join(keys, " and "));
}

}  // namespace

Mistake mistake_of(const Robot& given, const Misprint& misprint) {
  std::vector<std::string> should, says;
  for (std::size_t k = 0; k < misprint.count(); ++k) {
    const Dimension& one = misprint.of[k];
    const auto shown = [&](double x) { return one.angle ? to_degrees(x) : x; };
    should.push_back(fmt::format("{} = {:.{}f}", one.key, shown(misprint.value(k)), one.angle ? 2 : 1));
    says.push_back(fmt::format("{:g}", shown(now(given, one))));
  }
  const std::string text = fmt::format("the readings fit a robot file with {} instead of {}",
                                       fmt::join(should, " and "), fmt::join(says, " and "));
  return {MistakeKind::nominal, key_of(misprint), text, [misprint](Input& input) {
            state_joints(input.robot, input.measurements);
            for (std::size_t k = 0; k < misprint.count(); ++k) {
              input.robot = with(input.robot, misprint.of[k], misprint.value(k));
            }
          }};
}

}  // namespace paracal::detail

// Every option that comes from a list of settings refuses what is outside of its range, and what is no number or word.

#include <fmt/format.h>

#include <algorithm>

#include "broken_input.hpp"
#include "io/calibrations/calibration_settings.hpp"

namespace paracal::test::settings_test {
namespace {

using io::Setting;
using testing::HasSubstr;

/// The rows of one command.
class Rows {
 public:
  explicit Rows(std::string command) : command_(std::move(command)) {}

  void add(const Setting& setting, const char* what, const std::string& value, std::vector<std::string> message = {}) {
    message.push_back(fmt::format("--{}", setting.option));
    std::string name = fmt::format("{}_{}_{}", command_, setting.option, what);
    std::ranges::replace(name, '-', '_');
    rows_.push_back({name,
                     {},
                     fmt::format("{} --{}{}{}", command_, setting.option, value.starts_with('=') ? "" : " ", value),
                     kWrongUsage,
                     message});
  }

  void add_number(const Setting& setting) {
    const plausible::Range& range = setting.range;
    add(setting, "text", "thin", {"thin"});
    add(setting, "nan", "nan", {"nan"});
    add(setting, "inf", "inf", {"inf"});
    add(setting, "more", fmt::format("{}", 2.0 * range.most), {fmt::format("{:g}", range.most)});
    add(setting, "less", fmt::format("{}", range.least == 0.0 ? -1.0 : 0.5 * range.least));
  }

  template <typename T>
  void of(const Setting& setting, const T& /*value*/) {
    if (setting.option.empty() || setting.set_by != io::SetBy::all) return;
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>) {
      add_number(setting);
    } else if constexpr (std::is_enum_v<T>) {
      add(setting, "word", "nonsense", io::words_of<T>());
    } else if constexpr (std::is_same_v<T, bool>) {
      add(setting, "value", "=maybe");
    }
  }

  std::vector<BrokenInput> rows() const { return rows_; }

 private:
  std::string command_;
  std::vector<BrokenInput> rows_;
};

template <typename List, typename Options>
std::vector<BrokenInput> refusals(const std::string& command) {
  Rows rows(command);
  const Options defaults;
  List::list(defaults, 1.0,
             [&](const Setting& setting, const auto& value, const auto&...) { rows.of(setting, value); });
  return rows.rows();
}

INSTANTIATE_TEST_SUITE_P(SettingsOfCalibrate, BrokenInputTest,
                         testing::ValuesIn(refusals<io::CalibrationSettings, CalibrationOptions>("calibrate")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(SettingsOfValidate, BrokenInputTest,
                         testing::ValuesIn(refusals<io::ValidationSettings, ValidationOptions>("validate")), name_of);
INSTANTIATE_TEST_SUITE_P(SettingsOfPlans, BrokenInputTest,
                         testing::ValuesIn(refusals<io::PlanSettings, CalibrationOptions>("identifiability")), name_of);

/// What --help of calibrate says of a setting is what its list says.
TEST(Settings, HelpShowsTextAndDefault) {
  std::string help = run_program({"calibrate", "--help"}).out;
  std::ranges::replace(help, '\n', ' ');
  help.erase(std::unique(help.begin(), help.end(), [](char a, char b) { return a == ' ' && b == ' '; }), help.end());
  const CalibrationOptions defaults;
  std::size_t count = 0;
  io::CalibrationSettings::list(defaults, 1.0, [&]<typename T>(const Setting& setting, const T& value, const auto&...) {
    if (setting.option.empty()) return;
    ++count;
    EXPECT_THAT(help, HasSubstr(fmt::format("--{}", setting.option)));
    EXPECT_THAT(help, HasSubstr(std::string(setting.text)));
    std::string shown(setting.default_text);
    if constexpr (std::is_enum_v<T>) shown = io::word_of(value);
    if (!shown.empty()) {
      EXPECT_THAT(help, HasSubstr(fmt::format("(default: {})", shown)));
    }
  });
  EXPECT_GE(count, 20U);
}

}  // namespace
}  // namespace paracal::test::settings_test

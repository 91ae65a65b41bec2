#include "settings.hpp"

#include <fmt/format.h>

#include <optional>
#include <type_traits>
#include <vector>

#include "io/calibrations/calibration_settings.hpp"
#include "io/tables/names.hpp"
#include "measuring.hpp"
#include "paracal/calibration/source_selection.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

using io::Setting;

template <typename T>
inline constexpr bool is_number = std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>;

/// The options of the library that a list is declared with, for their defaults.
template <typename List>
struct OptionsOf {
  using Type = CalibrationOptions;
};
template <>
struct OptionsOf<io::ValidationSettings> {
  using Type = ValidationOptions;
};

std::string shown_default(const Setting& setting, double value) {
  return fmt::format("{:g}", io::tidy(setting.factor * value));
}

template <typename T>
Option* declared(Command& command, const Setting& setting, const T& value) {
  const std::string name = "--" + std::string(setting.option), text(setting.text);
  if constexpr (std::is_same_v<T, bool>) {
    return command.add_flag(name, text);
  } else {
    Option* const option = command.add_text(name, text);
    if (!setting.takes.empty()) option->takes(std::string(setting.takes));
    if constexpr (std::is_enum_v<T>) {
      option->check(one_of(io::words_of<T>()))->shows_default(std::string(io::word_of(value)));
    } else if constexpr (is_number<T>) {
      option->check(within(setting.range));
      if constexpr (std::is_same_v<T, double>) option->shows_default(shown_default(setting, value));
    } else if constexpr (std::is_same_v<T, std::optional<TrackerModel>>) {
      option->lists(std::string(setting.takes), 4)->check(within(setting.range));
    } else if constexpr (std::is_same_v<T, std::vector<SourceSelector>>) {
      option->lists(std::string(setting.takes));
    }
    if (!setting.default_text.empty()) option->shows_default(std::string(setting.default_text));
    return option;
  }
}

/// What was typed, as the value of a setting; it was checked when it was parsed.
class Typed {
 public:
  Typed(const Option& option, const Setting& setting, const Robot& robot)
      : option_(option), setting_(setting), robot_(robot), words_(option.values()) {}

  void put_into(bool& value) const { value = option_.is_set() == setting_.flag_sets; }
  void put_into(double& value) const { value = option_.numbers().front() / setting_.factor; }
  void put_into(std::optional<double>& value) const { value = option_.numbers().front() / setting_.factor; }
  void put_into(std::optional<TrackerModel>& value) const { value = io::tracker_of_um(option_.numbers()); }
  void put_into(std::vector<SourceSelector>& value) const { value = source_selectors(words_, robot_.joint_space()); }
  void put_into(std::optional<Tolerances>& value) const {
    value = read_priors(io::read_stored(words_.front()), robot_);
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void put_into(Enum& value) const { value = io::value_of<Enum>(words_.front()).value(); }

 private:
  const Option& option_;
  const Setting& setting_;
  const Robot& robot_;
  std::vector<std::string> words_;
};

bool is_option(const Setting& setting) { return !setting.option.empty() && setting.set_by == io::SetBy::all; }

}  // namespace

template <typename List>
void Settings<List>::declare(Command& command) {
  const typename OptionsOf<List>::Type defaults;
  const auto add = [&]<typename T>(const Setting& setting, const T& value, const auto&... /*other*/) {
    if constexpr (requires(const Typed& typed, T& into) { typed.put_into(into); }) {
      if (!is_option(setting)) return;
      command.heading(std::string(setting.heading));
      options_.emplace(setting.option, declared(command, setting, value));
    }
  };
  List::list(defaults, 1.0, add);
}

template <typename List>
bool Settings<List>::is_given(std::string_view option) const {
  return this->option(option)->is_given();
}

template <typename List>
template <typename Options>
void Settings<List>::put_into(Options& options, const Robot& robot) const {
  const auto put = [&]<typename T>(const Setting& setting, T& value, auto&... other) {
    if constexpr (requires(const Typed& typed) { typed.put_into(value); }) {
      if (!is_option(setting) || !is_given(setting.option)) return;
      try {
        Typed(*option(setting.option), setting, robot).put_into(value);
      } catch (const InvalidArgument& refused) {
        throw WrongUsage(fmt::format("--{}: {}", setting.option, refused.what()));
      }
      ((other = value), ...);
    }
  };
  List::list(options, to_file_unit(joint_unit(robot.actuator()), 1.0), put);
}

template class Settings<io::CalibrationSettings>;
template void Settings<io::CalibrationSettings>::put_into(CalibrationOptions&, const Robot&) const;
template class Settings<io::ValidationSettings>;
template void Settings<io::ValidationSettings>::put_into(ValidationOptions&, const Robot&) const;
template class Settings<io::PlanSettings>;
template void Settings<io::PlanSettings>::put_into(CalibrationOptions&, const Robot&) const;
template class Settings<io::NoiseSettings>;
template void Settings<io::NoiseSettings>::put_into(CalibrationOptions&, const Robot&) const;

}  // namespace paracal::app

#include "options.hpp"

#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>

#include "io/calibrations/calibration_settings.hpp"
#include "paracal/calibration/source_selection.hpp"

namespace paracal::python {

double checked(const char* name, double number, const plausible::Range& range) {
  if (range.contains(number)) return number;
  throw InvalidArgument(fmt::format("{}: expected {:g} to {:g}, got {:g}", name, range.least, range.most, number));
}

std::uint64_t checked(const char* name, std::int64_t number, const option_limits::Whole& range) {
  const auto whole = static_cast<std::uint64_t>(number);
  if (number >= 0 && whole >= range.least && whole <= range.most) return whole;
  throw InvalidArgument(fmt::format("{}: expected {} to {}, got {}", name, range.least, range.most, number));
}

namespace {

using io::Setting;

/// The value of a keyword, put into that of a setting.
class Keyword {
 public:
  Keyword(const Keywords& given, const Setting& setting, const Robot* robot)
      : given_(given), setting_(setting), name_(setting.python_keyword()), robot_(robot) {}

  bool is_given() const { return given_.has(name_.c_str()); }

  void put_into(bool& value) const { value = get<bool>("True or False") == setting_.flag_sets; }
  void put_into(double& value) const { value = number(); }
  void put_into(std::optional<double>& value) const { value = number(); }
  void put_into(std::optional<TrackerModel>& value) const {
    const auto um = get<std::array<double, 4>>("four numbers");
    try {
      value = io::tracker_of_um(um);
    } catch (const InvalidArgument& refused) {
      throw InvalidArgument(fmt::format("{}: {}", name_, refused.what()));
    }
  }
  void put_into(std::vector<SourceSelector>& value) const {
    value = source_selectors(get<std::vector<std::string>>("names of source errors"), robot_->joint_space());
  }
  void put_into(std::optional<Tolerances>& value) const { value = get<Tolerances>("Tolerances"); }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void put_into(Enum& value) const {
    const auto word = get<std::string>("a text");
    const auto found = io::value_of<Enum>(word);
    if (!found) {
      throw InvalidArgument(
          fmt::format("{}: expected one of {}, got \"{}\"", name_, fmt::join(io::words_of<Enum>(), ", "), word));
    }
    value = *found;
  }

 private:
  template <typename T>
  T get(std::string_view expected) const {
    return given_.get<T>(name_.c_str(), expected);
  }
  double number() const {
    return checked(name_.c_str(), get<double>("a number"), setting_.python_range()) / setting_.python_factor();
  }

  const Keywords& given_;
  const Setting& setting_;
  std::string name_;
  const Robot* robot_;
};

/// @param robot  of names of its errors; null for lists without them.
template <typename List, typename Options>
void take(const Keywords& given, const Robot* robot, Options& options) {
  List::list(options, 1.0, [&]<typename T>(const Setting& setting, T& value, auto&... other) {
    if constexpr (requires(const Keyword& keyword) { keyword.put_into(value); }) {
      const Keyword keyword(given, setting, robot);
      if (setting.option.empty() || !keyword.is_given()) return;
      keyword.put_into(value);
      ((other = value), ...);
    }
  });
}

}  // namespace

NoiseModel noise_of(const Keywords& given) {
  CalibrationOptions options;
  take<io::NoiseSettings>(given, nullptr, options);
  return options.noise;
}

CalibrationOptions calibration_options(const Robot& robot, const Keywords& given) {
  CalibrationOptions options;
  take<io::CalibrationSettings>(given, &robot, options);
  check_selection(options, robot.joint_space());
  return options;
}

ValidationOptions validation_options(const Keywords& given) {
  ValidationOptions options;
  take<io::ValidationSettings>(given, nullptr, options);
  options.rotation_noise_is_known = given.has("sigma_rad");
  return options;
}

PlannedReadings planned_readings(const Keywords& given) {
  PlannedReadings readings;
  const auto wanted = given.has("measure") ? given.get<std::string>("measure", "a text") : "coordinates";
  const auto kind = std::ranges::find(length_kinds(), wanted, &LengthWords::name);
  if (kind != length_kinds().end()) {
    readings.measurand = Measurand::lengths;
    readings.length = kind->kind;
  } else {
    given.choose("measure",
                 {{"coordinates", Measurand::coordinates},
                  {"pose", Measurand::poses},
                  {"distance", Measurand::distances},
                  {"home-distance", Measurand::home_distances},
                  {words(LengthKind::height).name, Measurand::lengths},
                  {words(LengthKind::ball_bar).name, Measurand::lengths},
                  {words(LengthKind::dial).name, Measurand::lengths}},
                 readings.measurand);
  }
  given.take("read_rotation", "True or False", readings.rotation);
  given.take("second", "True or False", readings.second);
  if (given.has("reflectors")) {
    CalibrationOptions options;
    take<io::ReadingSettings>(given, nullptr, options);
    readings.mount = options.reflectors;
  }
  if (given.has("at")) {
    const auto at = given.get<std::array<double, 3>>("at", "x, y, z in mm");
    readings.at = Eigen::Vector3d(at[0], at[1], at[2]);
  }
  return readings;
}

}  // namespace paracal::python

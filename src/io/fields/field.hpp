#pragma once

// Private to io: one list of fields for each stored struct. Its JSON, its schema, docs/json-keys.md and the types of
// the page come from the list.

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "words.hpp"

namespace paracal::io {

/// What a file says of a value beyond its type. Limits are in the unit of the key.
struct Form {
  double factor = 1.0;               ///< from mm and rad to the unit of the key
  std::optional<double> least = {};  ///< also of each number of a list
  std::optional<double> most = {};   ///< likewise
  std::string_view refers = {};      ///< to a schema, or to a part of common.schema.json
  std::string_view only = {};        ///< the one text that stands here
  std::string_view pattern = {};     ///< of a text
  std::string_view title = {};       ///< of a choice between structs
  bool may_lack = false;  ///< an empty value (of numbers that are never empty: 0) has no key; else it is null
};
inline constexpr double kLargest = 1e6;  ///< mm or deg of anything that a robot has
inline constexpr double kDegrees = to_degrees(1.0);
inline constexpr Form kAngle{.factor = kDegrees};
inline constexpr Form kAngleMayLack{.factor = kDegrees, .may_lack = true};
inline constexpr Form kNotNegative{.least = 0.0};
inline constexpr Form kNotNegativeMayLack{.least = 0.0, .may_lack = true};
inline constexpr Form kAngleNotNegative{.factor = kDegrees, .least = 0.0};
inline constexpr Form kSize{.least = 0.0, .most = kLargest};
inline constexpr Form kShare{.least = 0.0, .most = 1.0};
inline constexpr Form kCount{.least = 0.0, .most = 1e12};

/// Where the schema of a struct stands, and what the documents say of it.
struct Place {
  std::string_view file;          ///< "calibration.schema.json"
  std::string_view name = {};     ///< among its parts: "stage"; empty for what the file as a whole describes
  std::string_view title;         ///< of its table in docs/json-keys.md and of its type on the page
  std::string_view meaning = {};  ///< a sentence
};

/// The list of a struct has its kPlace, and fields(field), which calls field(key, get, meaning, form) for each key in
/// its order: get is a member or a function of the struct, meaning stands in the documents, form may be left out. A
/// list of settings (setting.hpp) has values(object, field) instead, with the value in place of get, and example(),
/// whose values have the types.
template <typename Struct>
struct List;
template <typename T>
concept Listed = requires {
  List<T>::kPlace;
};

template <typename T>
concept HasValues = requires {
  List<T>::example();
};

template <typename T>
inline constexpr bool is_choice = false;
template <typename... T>
inline constexpr bool is_choice<std::variant<T...>> = true;
template <typename T>
concept EigenValue = std::derived_from<T, Eigen::MatrixBase<T>>;
template <typename T>
concept EigenMatrix = EigenValue<T> && T::ColsAtCompileTime != 1;

/// The type of what a field states.
template <typename Struct, typename Get>
using ValueOf = std::remove_cvref_t<std::invoke_result_t<const Get&, const Struct&>>;

template <typename T>
Json stored(const T& value, const Form& form = {});

template <typename Struct>
Json stored_object(const Struct& object) {
  Json json = Json::object();
  const auto add = [&]<typename T>(std::string_view key, const T& value, const Form& form) {
    if constexpr (is_optional<T>) {
      if (form.may_lack && !value) return;
    } else if constexpr (std::same_as<T, double>) {
      if (form.may_lack && value == 0.0) return;
    }
    json.emplace(std::string(key), stored(value, form));
  };
  if constexpr (HasValues<Struct>) {
    List<Struct>::values(object, [&](std::string_view key, const auto& value, std::string_view /*meaning*/,
                                     const Form& form) { add(key, value, form); });
  } else {
    List<Struct>::fields(
        [&]<typename Get>(std::string_view key, const Get& get, std::string_view /*meaning*/, const Form& form = {}) {
          const ValueOf<Struct, Get>& value = std::invoke(get, object);
          add(key, value, form);
        });
  }
  return json;
}

/// The value as it stands in a file.
template <typename T>
Json stored(const T& value, const Form& form) {
  if constexpr (Listed<T>) {
    return stored_object(value);
  } else if constexpr (Worded<T> || Named<T>) {
    return word_of(value);
  } else if constexpr (is_optional<T>) {
    return value ? stored(*value, form) : Json(nullptr);
  } else if constexpr (is_choice<T>) {
    return std::visit([&](const auto& one) { return stored(one, form); }, value);
  } else if constexpr (EigenMatrix<T>) {
    return rows_json(form.factor * value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return form.factor * value;
  } else if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string_view> || std::same_as<T, Json>) {
    return value;
  } else {
    return json_array(value, [&](const auto& one) { return stored(one, form); });
  }
}

}  // namespace paracal::io

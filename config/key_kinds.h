// The kinds of the config's keys: each maker completes the row of a key with how its value is read,
// stored and shown. For config_keys.cpp alone.
#pragma once

#include "config/config_schema.h"
#include "execution/size_text.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace meshhier::config {

using Json = nlohmann::ordered_json;

/// A mesh has no more.
inline constexpr double kMostAttributes = kMaxValueChannels;
/// The most bytes of a text that the manifest repeats, which has 1 MiB.
inline constexpr double kMostTextBytes = 32768;
/// JSON numbers are exact up to here.
inline constexpr double kMostBytes = 9007199254740991.0;  // 2^53 - 1

struct Limits {
  double minimum;
  double maximum;
};

template <class T>
struct Unwrapped {
  using Type = T;
};
template <class T>
struct Unwrapped<std::optional<T>> {
  using Type = T;
};

template <class Value>
Json shown(const Value& value) {
  return value;
}
template <class Value>
Json shown(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

/// Leads from a config to the member that holds a key's value. A pointer, so that what follows is
/// compiled for each type of member and not for each key.
template <class T>
using Field = T& (*)(Config&);

/// Makes one of a lambda that captures nothing.
template <class Lambda>
auto member(Lambda lambda) {
  using T = std::remove_reference_t<std::invoke_result_t<Lambda, Config&>>;
  return static_cast<Field<T>>(lambda);
}

template <class T>
const T& member_of(Field<T> field, const Config& config) {
  return field(const_cast<Config&>(config));  // it changes nothing
}

// Each of these completes the row of one kind of key.

inline ConfigKey ignored_text(ConfigKey key) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [](Config&, const Json&) {};
  key.show = [](const Config&) { return Json(); };
  return key;
}

inline ConfigKey path(ConfigKey key, Field<std::filesystem::path> field) {
  key.kind = KeyKind::path;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    const std::filesystem::path& path = member_of(field, config);
    return path.empty() ? Json() : Json(path.string());
  };
  return key;
}

inline ConfigKey required_paths(ConfigKey key, double most, Field<mesh_io::InputPaths> field) {
  key.kind = KeyKind::paths;
  key.required = true;
  key.maximum = most;
  key.assign = [field](Config& config, const Json& value) {
    field(config).clear();
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      field(config).emplace_back(one.get<std::string>());
  };
  key.show = [field](const Config& config) {
    Json all = Json::array();
    for (const std::filesystem::path& one : member_of(field, config))
      all.push_back(one.string());
    return all.empty() ? Json() : all.size() == 1 ? all[0] : all;
  };
  return key;
}

inline ConfigKey boolean(ConfigKey key, Field<bool> field) {
  key.kind = KeyKind::boolean;
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<bool>(); };
  key.show = [field](const Config& config) { return Json(member_of(field, config)); };
  return key;
}

inline ConfigKey bytes(ConfigKey key, Field<std::optional<std::uint64_t>> field) {
  key.kind = KeyKind::size;
  key.minimum = 1;
  key.maximum = kMostBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.is_string() ? *execution::parse_size(value.get_ref<const std::string&>())
                                      : static_cast<std::uint64_t>(value.get<double>());
  };
  key.show = [field](const Config& config) {
    const std::optional<std::uint64_t>& bytes = member_of(field, config);
    return bytes ? Json(execution::exact_size_text(*bytes)) : Json();
  };
  return key;
}

/// A key for an integer or, for a field of floating point, a number.
template <class T>
ConfigKey number(ConfigKey key, Limits limits, Field<T> field) {
  using Number = typename Unwrapped<T>::Type;
  key.kind = std::is_integral_v<Number> ? KeyKind::integer : KeyKind::number;
  key.minimum = limits.minimum;
  key.maximum = limits.maximum;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = static_cast<Number>(value.get<double>());
  };
  key.show = [field](const Config& config) { return shown(member_of(field, config)); };
  return key;
}

inline ConfigKey text(ConfigKey key, Field<std::string> field) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    const std::string& text = member_of(field, config);
    return text.empty() ? Json() : Json(text);
  };
  return key;
}

/// A key for an optional string, of which an empty one is a value.
inline ConfigKey optional_text(ConfigKey key, Field<std::optional<std::string>> field) {
  key.kind = KeyKind::text;
  key.maximum = kMostTextBytes;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) { return shown(member_of(field, config)); };
  return key;
}

/// A key for an optional array.
template <class Array>
ConfigKey numbers(ConfigKey key, Field<std::optional<Array>> field) {
  key.kind = KeyKind::numbers;
  key.maximum = static_cast<double>(std::tuple_size_v<Array>);
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<Array>(); };
  key.show = [field](const Config& config) { return shown(member_of(field, config)); };
  return key;
}

/// A key for optional TargetVertexCounts. A list of one is the number: it means the same.
inline ConfigKey levels(ConfigKey key, Limits limits,
                        Field<std::optional<TargetVertexCounts>> field) {
  key.kind = KeyKind::levels;
  key.minimum = limits.minimum;
  key.maximum = limits.maximum;
  key.most_levels = TargetVertexCounts::kMostLevels;
  key.assign = [field](Config& config, const Json& value) {
    std::vector<std::uint32_t> by_level;
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      by_level.push_back(static_cast<std::uint32_t>(one.get<double>()));
    field(config) = TargetVertexCounts(std::move(by_level));
  };
  key.show = [field](const Config& config) {
    const std::optional<TargetVertexCounts>& counts = member_of(field, config);
    if (!counts)
      return Json();
    const std::span<const std::uint32_t> by_level = counts->by_level();
    return by_level.size() == 1 ? Json(by_level[0]) : Json(by_level);
  };
  return key;
}

template <class Names, class T>
ConfigKey choice(ConfigKey key, const Names& names, Field<T> field) {
  key.kind = KeyKind::choice;
  for (const auto& named : names)
    key.choices.emplace_back(named.name);
  key.assign = [field, names](Config& config, const Json& value) {
    for (const auto& named : names) {
      if (named.name == value.get_ref<const std::string&>())
        field(config) = named.value;
    }
  };
  key.show = [field, names](const Config& config) {
    for (const auto& named : names) {
      if (named.value == member_of(field, config))
        return Json(named.name);
    }
    return Json();
  };
  return key;
}

inline ConfigKey attributes(ConfigKey key) {
  using Which = mesh_io::AttributeChoice::Which;
  key.kind = KeyKind::names;
  key.maximum = kMostAttributes;
  key.choices = {"all", "none"};
  key.assign = [](Config& config, const Json& value) {
    config.attributes.which = value == "all"    ? Which::all
                              : value == "none" ? Which::none
                                                : Which::named;
    config.attributes.names.clear();
    if (value.is_array())
      value.get_to(config.attributes.names);
  };
  key.show = [](const Config& config) {
    switch (config.attributes.which) {
      case Which::all:
        return Json("all");
      case Which::none:
        return Json("none");
      case Which::named:
        break;
    }
    return Json(config.attributes.names);
  };
  return key;
}

inline ConfigKey labels(ConfigKey key) {
  key.kind = KeyKind::names;
  key.maximum = kMostAttributes;
  key.choices = {"integers"};
  key.assign = [](Config& config, const Json& value) {
    config.attributes.labels.reset();
    if (value.is_array())
      config.attributes.labels = value.get<std::vector<std::string>>();
  };
  key.show = [](const Config& config) {
    return config.attributes.labels ? Json(*config.attributes.labels) : Json("integers");
  };
  return key;
}

inline ConfigKey object_source(ConfigKey key) {
  key.kind = KeyKind::choice;
  key.prefix = mesh_io::kObjectLabel;
  for (const auto& row : mesh_io::kObjectSources)
    key.choices.emplace_back(row.name);
  key.assign = [](Config& config, const Json& value) {
    config.objects.from = mesh_io::object_choice_of(value.get_ref<const std::string&>()).value();
  };
  key.show = [](const Config& config) { return Json(text_of(config.objects.from)); };
  return key;
}

/// A key that is told only where it is not what it is by default: builds without it tell what they
/// did before there was such a key.
inline ConfigKey untold_by_default(ConfigKey key) {
  key.show = [show = key.show, usual = key.show(Config())](const Config& config) {
    Json value = show(config);
    return value == usual ? Json() : value;
  };
  return key;
}

inline ConfigKey deciding(ConfigKey key) {
  key.decides_result = true;
  return key;
}

}  // namespace meshhier::config

#include "config/config_schema.h"

#include "execution/size_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::config {

namespace {

using Json = nlohmann::ordered_json;

/// Fewer than 4 vertices hold no solid; tile indices are 16 bits wide and half of them are kept for
/// ghosts.
constexpr double kFewestTileVertices = 4;
constexpr double kMostTileVertices = 32768;
/// 2^32 vertices at the fewest a partition.
constexpr double kMostPartitions = 1073741824;
/// A sector needs its own lines within the outline's 32 kB: beyond this no line would be left to
/// draw.
constexpr double kMostSectors = 65536;
/// More than any machine has; catches a size that was meant for the budget.
constexpr double kMostThreads = 4096;
/// Each is a line of the manifest and of the journal, which have a MiB.
constexpr double kMostInputs = 1000;
/// JSON numbers are exact up to here.
constexpr double kMostBytes = 9007199254740991.0;  // 2^53 - 1

/// Degrees.
constexpr double kHalfTurn = 180;
/// Beyond any orbit; what is meant is in other units.
constexpr double kMostMetres = 1e9;

struct Limits {
  double minimum;
  double maximum;
};

constexpr Limits kTileVertices{kFewestTileVertices, kMostTileVertices};

template <class Field>
struct Unwrapped {
  using Type = Field;
};
template <class Field>
struct Unwrapped<std::optional<Field>> {
  using Type = Field;
};

template <class Value>
Json shown(const Value& value) {
  return value;
}
template <class Value>
Json shown(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

// Each of these makes the row of one kind of key. `field` turns a Config& or a const Config& into a
// reference to the member that holds the value.

ConfigKey ignored_text(std::string path) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::text};
  key.assign = [](Config&, const Json&) {};
  key.show = [](const Config&) { return Json(); };
  return key;
}

template <class Field>
ConfigKey required_path(std::string path, Field field) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::path, .required = true};
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    return field(config).empty() ? Json() : Json(field(config).string());
  };
  return key;
}

template <class Field>
ConfigKey required_paths(std::string path, double most, Field field) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::paths, .required = true, .maximum = most};
  key.assign = [field](Config& config, const Json& value) {
    field(config).clear();
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      field(config).emplace_back(one.get<std::string>());
  };
  key.show = [field](const Config& config) {
    Json all = Json::array();
    for (const std::filesystem::path& one : field(config))
      all.push_back(one.string());
    return all.empty() ? Json() : all.size() == 1 ? all[0] : all;
  };
  return key;
}

template <class Field>
ConfigKey boolean(std::string path, Field field) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::boolean};
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<bool>(); };
  key.show = [field](const Config& config) { return Json(field(config)); };
  return key;
}

template <class Field>
ConfigKey bytes(std::string path, Field field) {
  ConfigKey key{
      .path = std::move(path), .kind = KeyKind::size, .minimum = 1, .maximum = kMostBytes};
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.is_string() ? *execution::parse_size(value.get_ref<const std::string&>())
                                      : static_cast<std::uint64_t>(value.get<double>());
  };
  key.show = [field](const Config& config) {
    return Json(execution::exact_size_text(field(config)));
  };
  return key;
}

/// An integer or, for a field of floating point, a number.
template <class Field>
ConfigKey number(std::string path, Limits limits, Field field) {
  using Member = std::remove_reference_t<decltype(field(std::declval<Config&>()))>;
  using Number = typename Unwrapped<Member>::Type;
  ConfigKey key;
  key.path = std::move(path);
  key.kind = std::is_integral_v<Number> ? KeyKind::integer : KeyKind::number;
  key.minimum = limits.minimum;
  key.maximum = limits.maximum;
  key.assign = [field](Config& config, const Json& value) {
    field(config) = static_cast<Number>(value.get<double>());
  };
  key.show = [field](const Config& config) { return shown(field(config)); };
  return key;
}

template <class Field>
ConfigKey text(std::string path, Field field) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::text};
  key.assign = [field](Config& config, const Json& value) {
    field(config) = value.get<std::string>();
  };
  key.show = [field](const Config& config) {
    return field(config).empty() ? Json() : Json(field(config));
  };
  return key;
}

/// Of an optional array.
template <class Field>
ConfigKey numbers(std::string path, Field field) {
  using Array =
      typename Unwrapped<std::remove_reference_t<decltype(field(std::declval<Config&>()))>>::Type;
  ConfigKey key{.path = std::move(path),
                .kind = KeyKind::numbers,
                .maximum = static_cast<double>(std::tuple_size_v<Array>)};
  key.assign = [field](Config& config, const Json& value) { field(config) = value.get<Array>(); };
  key.show = [field](const Config& config) { return shown(field(config)); };
  return key;
}

/// Of optional TargetVertexCounts. A list of one is the number: it means the same.
template <class Field>
ConfigKey levels(std::string path, Limits limits, Field field) {
  ConfigKey key{.path = std::move(path),
                .kind = KeyKind::levels,
                .minimum = limits.minimum,
                .maximum = limits.maximum,
                .most_levels = TargetVertexCounts::kMostLevels};
  key.assign = [field](Config& config, const Json& value) {
    std::vector<std::uint32_t> by_level;
    for (const Json& one : value.is_array() ? value : Json::array({value}))
      by_level.push_back(static_cast<std::uint32_t>(one.get<double>()));
    field(config) = TargetVertexCounts(std::move(by_level));
  };
  key.show = [field](const Config& config) {
    if (!field(config))
      return Json();
    const std::span<const std::uint32_t> by_level = field(config)->by_level();
    return by_level.size() == 1 ? Json(by_level[0]) : Json(by_level);
  };
  return key;
}

template <class Names, class Field>
ConfigKey choice(std::string path, const Names& names, Field field) {
  ConfigKey key{.path = std::move(path), .kind = KeyKind::choice};
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
      if (named.value == field(config))
        return Json(named.name);
    }
    return Json();
  };
  return key;
}

ConfigKey deciding(ConfigKey key) {
  key.decides_result = true;
  return key;
}

std::vector<ConfigKey> make_config_keys() {
  return {
      ignored_text("$schema"),  // lets editors find configs/meshhier.schema.json
      required_paths(
          "input", kMostInputs, [](auto& c) -> auto& { return c.input; }),
      required_path(
          "output", [](auto& c) -> auto& { return c.output; }),
      bytes(
          "memory_budget", [](auto& c) -> auto& { return c.memory_budget; }),
      number(
          "threads", {0, kMostThreads}, [](auto& c) -> auto& { return c.threads; }),
      deciding(boolean(
          "weld", [](auto& c) -> auto& { return c.weld; })),
      deciding(number(
          "partition.vertices", kTileVertices,
          [](auto& c) -> auto& { return c.partition.vertices; })),
      deciding(number(
          "partition.count", {1, kMostPartitions},
          [](auto& c) -> auto& { return c.partition.count; })),
      deciding(choice(
          "partition.axis", kAxisRules, [](auto& c) -> auto& { return c.partition.axis; })),
      deciding(choice(
          "simplify.method", kSimplifyMethods, [](auto& c) -> auto& { return c.simplify.method; })),
      deciding(levels(
          "simplify.vertices", kTileVertices,
          [](auto& c) -> auto& { return c.simplify.vertices; })),
      deciding(choice(
          "simplify.representative", kRepresentatives,
          [](auto& c) -> auto& { return c.simplify.representative; })),
      deciding(choice(
          "simplify.cost", kHalfEdgeCosts, [](auto& c) -> auto& { return c.simplify.cost; })),
      deciding(number(
          "outline.sectors", {1, kMostSectors},
          [](auto& c) -> auto& { return c.outline.sectors; })),
      deciding(number(
          "outline.tolerance", {0, 1}, [](auto& c) -> auto& { return c.outline.tolerance; })),
      choice(
          "storage.container", kContainers, [](auto& c) -> auto& { return c.storage.container; }),
      deciding(choice(
          "storage.compression", kCompressions,
          [](auto& c) -> auto& { return c.storage.compression; })),
      deciding(number(
          "storage.positions.bits", {Lattice::kFewestBits, Lattice::kMostBits},
          [](auto& c) -> auto& { return c.storage.position_bits; })),
      deciding(choice(
          "up", kUpAxes, [](auto& c) -> auto& { return c.up; })),
      deciding(number(
          "placement.longitude", {-kHalfTurn, kHalfTurn},
          [](auto& c) -> auto& { return c.placement.longitude; })),
      deciding(number(
          "placement.latitude", {-kHalfTurn / 2, kHalfTurn / 2},
          [](auto& c) -> auto& { return c.placement.latitude; })),
      deciding(number(
          "placement.height", {-kMostMetres, kMostMetres},
          [](auto& c) -> auto& { return c.placement.height; })),
      deciding(numbers(
          "placement.anchor", [](auto& c) -> auto& { return c.placement.anchor; })),
      deciding(numbers(
          "placement.transform", [](auto& c) -> auto& { return c.placement.transform; })),
      deciding(text(
          "licence", [](auto& c) -> auto& { return c.licence; })),
  };
}

bool is_integer_within(const ConfigKey& key, const Json& value) {
  if (!value.is_number())
    return false;
  const auto number = value.get<double>();
  return std::trunc(number) == number && number >= key.minimum && number <= key.maximum;
}

bool is_size_within(const ConfigKey& key, const Json& value) {
  if (!value.is_string())
    return is_integer_within(key, value);
  const std::optional<std::uint64_t> parsed =
      execution::parse_size(value.get_ref<const std::string&>());
  return parsed && static_cast<double>(*parsed) >= key.minimum;
}

bool is_list_of_numbers(const ConfigKey& key, const Json& value) {
  return value.is_array() && static_cast<double>(value.size()) == key.maximum &&
         std::all_of(value.begin(), value.end(), [](const Json& number) {
           return number.is_number() && std::isfinite(number.get<double>());
         });
}

bool is_list_of_levels(const ConfigKey& key, const Json& value) {
  const ConfigKey entry = level_entry(key);
  return value.is_array() && !value.empty() && value.size() <= key.most_levels &&
         std::all_of(value.begin(), value.end(),
                     [&](const Json& one) { return accepts(entry, one); });
}

bool is_usable_path(const Json& value) {
  if (!value.is_string())
    return false;
  const auto& text = value.get_ref<const std::string&>();
  return !text.empty() && text.find('\0') == std::string::npos;
}

}  // namespace

const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> keys = make_config_keys();
  return keys;
}

const ConfigKey* find_config_key(std::string_view path) {
  const std::vector<ConfigKey>& keys = config_keys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const ConfigKey& key) { return key.path == path; });
  return found == keys.end() ? nullptr : &*found;
}

bool is_config_section(std::string_view path) {
  const std::string prefix = std::string(path) + '.';
  const std::vector<ConfigKey>& keys = config_keys();
  return std::any_of(keys.begin(), keys.end(),
                     [&](const ConfigKey& key) { return key.path.starts_with(prefix); });
}

bool accepts(const ConfigKey& key, const Json& value) {
  switch (key.kind) {
    case KeyKind::text:
      return value.is_string();
    case KeyKind::path:
      return is_usable_path(value);
    case KeyKind::paths:
      return is_usable_path(value) || (value.is_array() && !value.empty() &&
                                       static_cast<double>(value.size()) <= key.maximum &&
                                       std::all_of(value.begin(), value.end(), is_usable_path));
    case KeyKind::boolean:
      return value.is_boolean();
    case KeyKind::integer:
      return is_integer_within(key, value);
    case KeyKind::number:
      return value.is_number() && value.get<double>() > key.minimum &&
             value.get<double>() <= key.maximum;
    case KeyKind::numbers:
      return is_list_of_numbers(key, value);
    case KeyKind::levels:
      return is_integer_within(key, value) || is_list_of_levels(key, value);
    case KeyKind::size:
      return is_size_within(key, value);
    case KeyKind::choice:
      return value.is_string() &&
             std::find(key.choices.begin(), key.choices.end(),
                       value.get_ref<const std::string&>()) != key.choices.end();
  }
  return false;
}

ConfigKey level_entry(const ConfigKey& key) {
  return {
      .path = key.path, .kind = KeyKind::integer, .minimum = key.minimum, .maximum = key.maximum};
}

std::string expectation(const ConfigKey& key) {
  switch (key.kind) {
    case KeyKind::text:
      return "a string";
    case KeyKind::path:
      return "a path";
    case KeyKind::paths:
      return fmt::format("a path or a list of 1 to {:.0f} paths", key.maximum);
    case KeyKind::boolean:
      return "true or false";
    case KeyKind::integer:
      return fmt::format("an integer from {:.0f} to {:.0f}", key.minimum, key.maximum);
    case KeyKind::number:
      return fmt::format("a number above {} and at most {}", key.minimum, key.maximum);
    case KeyKind::numbers:
      return fmt::format("a list of {:.0f} numbers", key.maximum);
    case KeyKind::levels:
      return fmt::format("{} or a list of 1 to {} of them", expectation(level_entry(key)),
                         key.most_levels);
    case KeyKind::size:
      return std::string(execution::kSizeSyntax);
    case KeyKind::choice:
      break;
  }
  return fmt::format("{}\"{}\"", key.choices.size() > 1 ? "one of " : "",
                     fmt::join(key.choices, "\", \""));
}

}  // namespace meshhier::config

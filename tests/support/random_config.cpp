#include "tests/support/random_config.h"

#include "config/config_schema.h"
#include "images/ktx2_coder.h"
#include "storage/format/view_keys.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using config::ConfigKey;
using config::KeyKind;
using Json = nlohmann::ordered_json;

/// The largest of a key that costs time or makes no second tile of a small mesh. These are drawn
/// nearly always.
struct Cap {
  std::string_view path;
  double most;
};
constexpr std::array kCaps{Cap{"partition.vertices", 600},   Cap{"partition.count", 40},
                           Cap{"simplify.vertices", 600},    Cap{"outline.sectors", 200},
                           Cap{"normal_map.texels", 256},    Cap{"texture.texels", 256},
                           Cap{"storage.positions.bits", 24}};

const Cap* cap_of(const ConfigKey& key) {
  const auto* const found = std::ranges::find(kCaps, key.path, &Cap::path);
  return found == kCaps.end() ? nullptr : found;
}

class ConfigDrawer {
 public:
  ConfigDrawer(const Draw& draw, const DrawnFor& what) : draw_(draw), what_(what) {}

  config::Config operator()() {
    for (const ConfigKey& key : config::config_keys()) {
      if (std::ranges::find(kNotDrawn, key.path) == kNotDrawn.end() && is_wanted(key))
        add(key);
    }
    document_["input"] = "mesh.ply";
    document_["output"] = "mesh.hier";
    config::Config config = config::parse_config(document_.dump(), {"drawn", "/"}, {});
    config.input = {};
    config.output.clear();
    return config;
  }

 private:
  static std::string section_of(const std::string& path) {
    return path.substr(0, path.rfind('.') + 1);
  }
  bool has(const std::string& path) const {
    return document_.contains(config::json_pointer_to(path));
  }
  bool has_any(const ConfigKey& key, const std::vector<std::string>& names) const {
    return std::ranges::any_of(
        names, [&](const std::string& name) { return has(section_of(key.path) + name); });
  }
  /// Returns whether a key that is there excludes this one, or the other way round.
  bool is_excluded(const ConfigKey& key) const {
    const std::string section = section_of(key.path);
    return has_any(key, key.excludes) ||
           std::ranges::any_of(config::config_keys(), [&](const ConfigKey& other) {
             return section_of(other.path) == section && has(other.path) &&
                    std::ranges::find(other.excludes, key.path.substr(section.size())) !=
                        other.excludes.end();
           });
  }

  bool is_wanted(const ConfigKey& key) {
    if (key.kind == KeyKind::choice || key.kind == KeyKind::boolean)
      return draw_(1) == 1;
    return cap_of(key) != nullptr ? draw_(3) > 0 : draw_(3) == 1;
  }

  /// With what it needs; not if something excludes it.
  void add(const ConfigKey& key) {
    if (has(key.path) || is_excluded(key))
      return;
    document_[config::json_pointer_to(key.path)] = value_of(key);
    if (!key.needs.empty() && !has_any(key, key.needs))
      add(*config::find_config_key(section_of(key.path) + key.needs.front()));
  }

  Json value_of(const ConfigKey& key) {
    switch (key.kind) {
      case KeyKind::boolean:
        return key.show(config::Config()) == false;  // one that is not told is true
      case KeyKind::choice:
        return choice(key);
      case KeyKind::integer:
        return integer(key);
      case KeyKind::number:
        return key.minimum +
               (key.maximum - key.minimum) * static_cast<double>(1 + draw_(998)) / 1000;
      case KeyKind::levels:
        return levels(key);
      case KeyKind::numbers:
        return numbers(key);
      case KeyKind::names:
        return draw_(1) == 0 ? Json::array() : Json(key.choices[draw_(key.choices.size() - 1)]);
      case KeyKind::size:
        return integer(key);
      case KeyKind::view:
        return view_value(key);
      case KeyKind::text:
      case KeyKind::path:
      case KeyKind::paths:
        break;
    }
    return "a text, with \"quotes\" and ümlauts";
  }

  /// Returns one of few values for keys that need no attribute; texts of any other.
  Json view_value(const ConfigKey& key) {
    if (!key.choices.empty())
      return key.choices[draw_(key.choices.size() - 1)];
    for (const Json& value :
         {Json(key.view->unset != "true"), Json(2), Json({-1, 3}), Json({1, 2, 3}),
          Json({1, 0, 0.5, 2}), Json({0, 0, 0, 1, 2.5, 3}), Json({"a", "b"})}) {
      if (storage::accepts(*key.view, value))
        return value;
    }
    return "a text";
  }

  Json choice(const ConfigKey& key) {
    std::vector<std::string> choices = key.choices;
    const bool has_ktx2 = what_.with_ktx2 && images::missing_for_ktx2().empty();
    if (!has_ktx2)
      std::erase(choices, "ktx2");
    return choices[draw_(choices.size() - 1)];
  }

  /// Each order of magnitude above the least is as likely.
  Json integer(const ConfigKey& key) {
    const Cap* const cap = cap_of(key);
    const double most = cap != nullptr ? std::min(cap->most, key.maximum) : key.maximum;
    const auto range = static_cast<std::uint64_t>(most - key.minimum);
    const auto bits = static_cast<std::uint64_t>(std::log2(static_cast<double>(range) + 1));
    const std::uint64_t within = std::min(range, (std::uint64_t{2} << draw_(bits)) - 1);
    return static_cast<std::uint64_t>(key.minimum) + draw_(within);
  }

  Json levels(const ConfigKey& key) {
    if (draw_(1) == 0)
      return integer(key);
    Json list = Json::array();
    for (std::uint64_t left = 1 + draw_(7); left > 0; --left)
      list.push_back(integer(key));
    return list;
  }

  double within(double low, double high) {
    return low + (high - low) * static_cast<double>(draw_(16)) / 16;
  }

  /// Two corners, a matrix, or anything.
  Json numbers(const ConfigKey& key) {
    if (key.path == "crop")
      return crop();
    if (key.path == "placement.transform") {
      const double turn = draw_(1) == 0 ? 1 : -1;
      return {0, turn, 0, 0, -turn, 0, 0, 0, 0, 0, 1, 0, within(0, 7e6), within(0, 7e6), 5, 1};
    }
    Json all = Json::array();
    for (int i = 0; i < static_cast<int>(key.maximum); ++i)
      all.push_back(within(-8, 8));
    return all;
  }

  Json crop() {
    std::array<double, 6> corners{};
    for (int axis = 0; axis < 3; ++axis) {
      const double a = within(what_.box.min[axis], what_.box.max[axis]);
      const double b = within(what_.box.min[axis], what_.box.max[axis]);
      corners[static_cast<std::size_t>(axis)] = std::min(a, b);
      corners[static_cast<std::size_t>(axis) + 3] = std::max(a, b);
    }
    return corners;
  }

  const Draw& draw_;
  const DrawnFor& what_;
  Json document_ = Json::object();
};

}  // namespace

config::Config random_config(const Draw& draw, const DrawnFor& what) {
  return ConfigDrawer(draw, what)();
}

}  // namespace meshhier::tests

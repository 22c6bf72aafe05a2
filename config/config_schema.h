// Every key of the config, described once: for the parser, its messages, resolved_json(), and the
// references of the keys (config_reference.h).
#pragma once

#include "config/config.h"
#include "storage/format/view_keys.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::config {

enum class KeyKind {
  text,     ///< a string of at most `maximum` bytes
  path,     ///< a string that is not empty
  paths,    ///< a path, or a list of 1 to `maximum` of them
  boolean,  ///< true or false
  integer,  ///< minimum to maximum
  number,   ///< above minimum, or from it if takes_minimum, up to maximum
  numbers,  ///< a list of so many finite numbers as `maximum` says
  levels,   ///< an integer, or a list of 1 to `most_levels` of them; each minimum to maximum
  size,     ///< bytes as a number, or a text for parse_size(); minimum to maximum
  choice,   ///< one of `choices`, or `prefix` and the name of an attribute
  names,    ///< one of `choices`, or a list of at most `maximum` names of attributes
  view      ///< a value of a view, as `view` says
};

struct ConfigKey {
  std::string path;            ///< dotted
  std::string meaning;         ///< for people: no capital, no full stop, names in `backticks`
  std::string unset = "none";  ///< for people: holds if there is neither value nor default
  std::vector<std::string> excludes{};  ///< keys of the same section that must not be there too
  std::vector<std::string> needs{};     ///< keys of the same section of which one must be there too
  bool takes_minimum = false;           ///< the minimum itself is allowed, too, for a number
  bool required = false;
  bool decides_result = false;
  KeyKind kind{};
  double minimum = 0;
  double maximum = 0;
  std::size_t most_levels = 0;
  std::vector<std::string> choices{};
  std::string prefix{};  ///< of a choice; empty: none
  const storage::ViewKey* view = nullptr;
  /// Stores an acceptable value.
  std::function<void(Config&, const nlohmann::ordered_json&)> assign{};
  /// Returns the config's value as it would be written; null if it is not set.
  std::function<nlohmann::ordered_json(const Config&)> show{};
};

struct ConfigSection {
  std::string path;     ///< dotted
  std::string meaning;  ///< as that of a key
  /// The key of the section that a value in the section's place means; empty: none is allowed.
  std::string short_for{};
};

/// Returns all keys, in the order in which they are listed to people. Thread-safe.
const std::vector<ConfigKey>& config_keys();

/// Returns all inner nodes of the keys' paths. Thread-safe.
const std::vector<ConfigSection>& config_sections();

/// Returns the key of that dotted path, or null.
const ConfigKey* find_config_key(std::string_view path);

/// Returns the inner node of that dotted path, or null.
const ConfigSection* find_config_section(std::string_view path);

/// Whether it is an inner node of the keys' paths: "partition".
bool is_config_section(std::string_view path);

/// Returns the place in a document that a dotted path leads to.
nlohmann::ordered_json::json_pointer json_pointer_to(std::string path);

bool accepts(const ConfigKey& key, const nlohmann::ordered_json& value);

/// Describes an entry of a list for KeyKind::levels, as a key of kind integer.
ConfigKey level_entry(const ConfigKey& key);

/// Describes the values that accepts() takes, for messages: "an integer from 4 to 32768".
std::string expectation(const ConfigKey& key);

}  // namespace meshhier::config

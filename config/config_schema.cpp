#include "config/config_schema.h"

#include "execution/size_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshhier::config {
namespace {

using Json = nlohmann::ordered_json;

bool is_number_within(const ConfigKey& key, const Json& value) {
  if (!value.is_number() || !(value.get<double>() <= key.maximum))
    return false;
  return key.takes_minimum ? value.get<double>() >= key.minimum : value.get<double>() > key.minimum;
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

bool is_choice(const ConfigKey& key, const Json& value) {
  if (!value.is_string())
    return false;
  const std::string_view text = value.get_ref<const std::string&>();
  if (!key.prefix.empty() && text.starts_with(key.prefix))
    return is_attribute_name(text.substr(key.prefix.size()));
  return std::ranges::find(key.choices, text) != key.choices.end();
}

bool is_list_of_names(const ConfigKey& key, const Json& value) {
  return value.is_array() && static_cast<double>(value.size()) <= key.maximum &&
         std::all_of(value.begin(), value.end(), [](const Json& name) {
           return name.is_string() && is_attribute_name(name.get_ref<const std::string&>());
         });
}

bool is_usable_path(const Json& value) {
  if (!value.is_string())
    return false;
  const auto& text = value.get_ref<const std::string&>();
  return !text.empty() && text.find('\0') == std::string::npos;
}

}  // namespace

const std::vector<ConfigSection>& config_sections() {
  static const std::vector<ConfigSection> sections = {
      {"objects",
       "the things that the mesh consists of, with names and properties; a text is the key `from`",
       "from"},
      {"partition", "how the mesh is cut into partitions, the finest tiles"},
      {"simplify", "how the coarser tiles are made"},
      {"outline", "the shape-outline, the lines that are shown first"},
      {"first_view", "from where the model is looked at before anybody turns it"},
      {"view",
       "how the model is shown first, in `preview.webp`, viewers and `meshhier preview`, unless "
       "they are told otherwise; `meshhier view` changes it later"},
      {"storage", "how tiles are stored"},
      {"storage.positions", "how positions are rounded; without it they keep every bit"},
      {"normal_map", "what normal maps of simplified tiles are like"},
      {"texture", "what becomes of the pictures of a textured mesh"},
      {"placement",
       "where the tileset puts the model: on the globe (WGS 84), x to the east; where its map "
       "coordinates are; or anywhere by a transform"},
      {"tileset", "what viewers of 3D Tiles are told"}};
  return sections;
}

const ConfigKey* find_config_key(std::string_view path) {
  const std::vector<ConfigKey>& keys = config_keys();
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const ConfigKey& key) { return key.path == path; });
  return found == keys.end() ? nullptr : &*found;
}

const ConfigSection* find_config_section(std::string_view path) {
  const std::vector<ConfigSection>& sections = config_sections();
  const auto found = std::ranges::find(sections, path, &ConfigSection::path);
  return found == sections.end() ? nullptr : &*found;
}

bool is_config_section(std::string_view path) {
  return find_config_section(path) != nullptr;
}

Json::json_pointer json_pointer_to(std::string path) {
  std::replace(path.begin(), path.end(), '.', '/');
  return Json::json_pointer('/' + path);
}

bool accepts(const ConfigKey& key, const Json& value) {
  switch (key.kind) {
    case KeyKind::text:
      return value.is_string() &&
             static_cast<double>(value.get_ref<const std::string&>().size()) <= key.maximum;
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
      return is_number_within(key, value);
    case KeyKind::numbers:
      return is_list_of_numbers(key, value);
    case KeyKind::levels:
      return is_integer_within(key, value) || is_list_of_levels(key, value);
    case KeyKind::size:
      return is_size_within(key, value);
    case KeyKind::choice:
      return is_choice(key, value);
    case KeyKind::names:
      return is_choice(key, value) || is_list_of_names(key, value);
    case KeyKind::view:
      return storage::accepts(*key.view, value);
  }
  return false;
}

ConfigKey level_entry(const ConfigKey& key) {
  return {.path = key.path,
          .meaning = key.meaning,
          .kind = KeyKind::integer,
          .minimum = key.minimum,
          .maximum = key.maximum};
}

std::string expectation(const ConfigKey& key) {
  switch (key.kind) {
    case KeyKind::text:
      return fmt::format("a string of at most {:.0f} bytes", key.maximum);
    case KeyKind::path:
      return "a path";
    case KeyKind::paths:
      return fmt::format("a path or a list of 1 to {:.0f} paths", key.maximum);
    case KeyKind::boolean:
      return "true or false";
    case KeyKind::integer:
      return fmt::format("an integer from {:.0f} to {:.0f}", key.minimum, key.maximum);
    case KeyKind::number:
      return key.takes_minimum
                 ? fmt::format("a number from {} to {}", key.minimum, key.maximum)
                 : fmt::format("a number above {} and at most {}", key.minimum, key.maximum);
    case KeyKind::numbers:
      return fmt::format("a list of {:.0f} numbers", key.maximum);
    case KeyKind::levels:
      return fmt::format("{} or a list of 1 to {} of them", expectation(level_entry(key)),
                         key.most_levels);
    case KeyKind::size:
      return std::string(execution::kSizeSyntax);
    case KeyKind::view:
      return storage::expectation(*key.view);
    case KeyKind::choice:
    case KeyKind::names:
      break;
  }
  return fmt::format("{}\"{}\"{}", key.choices.size() > 1 ? "one of " : "",
                     fmt::join(key.choices, "\", \""),
                     key.kind == KeyKind::names ? " or a list of names"
                     : !key.prefix.empty()      ? fmt::format(" or \"{}NAME\"", key.prefix)
                                                : "");
}

}  // namespace meshhier::config

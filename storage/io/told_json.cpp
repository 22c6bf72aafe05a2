#include "storage/io/told_json.h"

#include "base/percent_code.h"
#include "base/utf8.h"

#include <algorithm>
#include <optional>
#include <string>

namespace meshhier::storage {
namespace {

/// Returns the bytes of a value of an object; nothing if it is UTF-8, or no text.
std::optional<std::string> bytes_told(const nlohmann::ordered_json& value) {
  if (!value.is_string() || is_utf8(value.get_ref<const std::string&>()))
    return std::nullopt;
  return percent_encoded(value.get_ref<const std::string&>());
}

nlohmann::ordered_json with_bytes(const nlohmann::ordered_json& value) {
  nlohmann::ordered_json told = value;
  if (value.is_array())
    std::ranges::transform(value, told.begin(), with_bytes);
  if (!value.is_object())
    return told;
  told.clear();
  for (const auto& [key, one] : value.items()) {
    told[key] = with_bytes(one);
    if (const auto bytes = bytes_told(one))
      told[key + "_escaped"] = *bytes;
  }
  return told;
}

}  // namespace

std::string told_json_text(const nlohmann::ordered_json& value, JsonLayout layout) {
  return json_text(with_bytes(value), layout);
}

}  // namespace meshhier::storage

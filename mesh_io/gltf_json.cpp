#include "mesh_io/gltf_json.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "mesh_io/input_error.h"
#include "mesh_io/json_value.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace meshhier::mesh_io {
namespace {

using Json = nlohmann::json;

/// The memory that the parser takes for each: a node of a map with its key, or an item of a list
/// that has just grown. Characters of texts come on top.
constexpr std::uint64_t kKeyBytes = 128;
constexpr std::uint64_t kValueBytes = 48;
constexpr std::size_t kLongestJsonText = 200;

std::string brief(const Json& value) {
  if (value.is_structured())
    return value.is_array() ? "a list" : "an object";
  return plain_text(storage::json_text(value, {.only_ascii = true}), 60);
}

bool is_count(const Json& value) {
  if (value.is_number_unsigned())
    return true;
  constexpr double kEnd = 9007199254740992;  // 2^53: up to there doubles are integers
  if (!value.is_number_float())
    return false;
  const double number = value.get<double>();
  return number >= 0 && number < kEnd && number == std::floor(number);
}

std::uint64_t count_of(const Json& value) {
  return value.is_number_float() ? static_cast<std::uint64_t>(value.get<double>())
                                 : value.get<std::uint64_t>();
}

/// Counts what the parser takes, as it goes.
class ParseGuard {
 public:
  ParseGuard(const std::filesystem::path& path, std::uint64_t text_bytes, std::uint64_t most_bytes,
             int most_depth)
      : path_(path), taken_(2 * text_bytes), most_(most_bytes), most_depth_(most_depth) {
    check();
  }
  bool operator()(int depth, Json::parse_event_t event, const Json&) {
    if (depth > most_depth_)
      fail_file(path_, fmt::format("its JSON is nested deeper than {} levels", most_depth_));
    taken_ += event == Json::parse_event_t::key ? kKeyBytes : kValueBytes;
    check();
    return true;
  }

 private:
  void check() const {
    if (taken_ > most_) {
      throw Error(ErrorCode::budget,
                  fmt::format("{}: its JSON takes more than the {} bytes of memory that the import "
                              "has for it; give a larger memory_budget",
                              path_.string(), most_));
    }
  }

  const std::filesystem::path& path_;
  std::uint64_t taken_;
  std::uint64_t most_;
  int most_depth_;
};

}  // namespace

Json parse_gltf_json(std::string text, const std::filesystem::path& path, std::uint64_t most_bytes,
                     int most_depth) {
  ParseGuard guard(path, text.size(), most_bytes, most_depth);
  try {
    return storage::parse_json_text(text, std::ref(guard));
  } catch (const Json::exception& error) {
    fail_file(path, "is not valid JSON: " + plain_text(json_fault(error.what()), kLongestJsonText));
  }
}

GltfObject::GltfObject(const Json& object, const std::filesystem::path& path, std::string place)
    : object_(&object), path_(&path), place_(std::move(place)) {
  if (!object.is_object())
    fail("is " + brief(object) + ", expected an object");
}

void GltfObject::fail(const std::string& message) const {
  fail_file(*path_, (place_.empty() ? "its JSON" : place_) + " " + message);
}

const Json* GltfObject::find(const char* key) const {
  const auto found = object_->find(key);
  return found == object_->end() ? nullptr : &*found;
}

bool GltfObject::has_object(const char* key) const {
  const Json* value = find(key);
  return value != nullptr && value->is_object();
}

const Json* GltfObject::find_list(const char* key) const {
  const Json* list = find(key);
  if (list != nullptr && !list->is_array())
    fail_value(key, "a list");
  return list;
}

std::string GltfObject::place_of(std::string_view key) const {
  return (place_.empty() ? "" : place_ + ".") + plain_text(key, kLongestJsonText);
}

void GltfObject::fail_value(const char* key, const std::string& expected) const {
  fail_file(*path_,
            fmt::format("{} is {}, expected {}", place_of(key), brief(*find(key)), expected));
}

std::uint64_t GltfObject::checked_count(const Json& value, const char* key,
                                        std::uint64_t most) const {
  if (!is_count(value) || count_of(value) > most) {
    fail_file(*path_, fmt::format("{} is {}, expected an integer from 0 to {}", place_of(key),
                                  brief(value), most));
  }
  return count_of(value);
}

std::optional<std::uint64_t> GltfObject::count(const char* key, std::uint64_t most) const {
  const Json* value = find(key);
  return value == nullptr ? std::nullopt : std::optional(checked_count(*value, key, most));
}

std::uint64_t GltfObject::require_count(const char* key, std::uint64_t most) const {
  const auto value = count(key, most);
  if (!value)
    fail(fmt::format("has no \"{}\"", key));
  return *value;
}

std::optional<std::uint32_t> GltfObject::index(const char* key, std::size_t size) const {
  const Json* value = find(key);
  if (value == nullptr)
    return std::nullopt;
  if (size == 0)
    fail_value(key, "none: there is nothing that it could name");
  return static_cast<std::uint32_t>(checked_count(*value, key, size - 1));
}

std::uint32_t GltfObject::require_index(const char* key, std::size_t size) const {
  const auto value = index(key, size);
  if (!value)
    fail(fmt::format("has no \"{}\"", key));
  return *value;
}

double GltfObject::number(const char* key, double otherwise) const {
  const Json* value = find(key);
  if (value == nullptr)
    return otherwise;
  if (!value->is_number())
    fail_value(key, "a number");
  return value->get<double>();
}

bool GltfObject::flag(const char* key) const {
  const Json* value = find(key);
  if (value != nullptr && !value->is_boolean())
    fail_value(key, "true or false");
  return value != nullptr && value->get<bool>();
}

std::optional<std::string> GltfObject::text(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr)
    return std::nullopt;
  if (!value->is_string())
    fail_value(key, "a text");
  return value->get<std::string>();
}

bool GltfObject::has_text(const char* key, std::string_view start) const {
  const Json* value = find(key);
  return value != nullptr && value->is_string() &&
         value->get_ref<const std::string&>().starts_with(start);
}

std::optional<std::vector<double>> GltfObject::numbers(const char* key, std::size_t size) const {
  const Json* list = find_list(key);
  if (list == nullptr)
    return std::nullopt;
  std::vector<double> numbers;
  for (const Json& value : *list) {
    if (value.is_number())
      numbers.push_back(value.get<double>());
  }
  if (list->size() != size || numbers.size() != size)
    fail_value(key, fmt::format("{} numbers", size));
  return numbers;
}

std::vector<std::uint32_t> GltfObject::indices(const char* key, std::size_t size) const {
  std::vector<std::uint32_t> indices;
  if (const Json* list = find_list(key)) {
    for (const Json& value : *list) {
      if (!is_count(value) || count_of(value) >= size)
        fail_file(*path_, fmt::format("{} has {}, expected integers below {}", place_of(key),
                                      brief(value), size));
      indices.push_back(static_cast<std::uint32_t>(count_of(value)));
    }
  }
  return indices;
}

std::vector<std::string> GltfObject::texts(const char* key) const {
  std::vector<std::string> texts;
  if (const Json* list = find_list(key)) {
    for (const Json& value : *list) {
      if (!value.is_string())
        fail_value(key, "a list of texts");
      texts.push_back(value.get<std::string>());
    }
  }
  return texts;
}

std::vector<std::string> GltfObject::keys(std::size_t most) const {
  std::vector<std::string> keys;
  for (auto at = object_->begin(); at != object_->end() && keys.size() < most; ++at)
    keys.push_back(at.key());
  return keys;
}

bool GltfObject::has_numbers(const char* key, std::size_t size) const {
  const Json* value = find(key);
  return value != nullptr && value->is_array() && value->size() == size &&
         std::all_of(value->begin(), value->end(), [](const Json& v) { return v.is_number(); });
}

std::vector<std::pair<std::string, ObjectValue>> GltfObject::values(const char* key) const {
  std::vector<std::pair<std::string, ObjectValue>> values;
  if (!has_object(key))
    return values;
  for (const auto& [name, value] : find(key)->items())
    values.emplace_back(name, value_of_json(value));
  return values;
}

ObjectValue GltfObject::value(const char* key) const {
  return has(key) ? value_of_json(*find(key)) : ObjectValue();
}

std::shared_ptr<const Json> GltfObject::copy() const {
  return std::make_shared<const Json>(*object_);
}

std::optional<GltfObject> GltfObject::object(const char* key) const {
  const Json* value = find(key);
  return value == nullptr ? std::nullopt : std::optional(GltfObject(*value, *path_, place_of(key)));
}

GltfObject GltfObject::require_object(const char* key) const {
  auto value = object(key);
  if (!value)
    fail(fmt::format("has no \"{}\"", key));
  return *std::move(value);
}

std::optional<GltfObject> GltfObject::extension(const char* name) const {
  const auto extensions = object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

void GltfObject::for_each(const char* key,
                          const std::function<void(const GltfObject&)>& visit) const {
  const Json* list = find_list(key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i)
    visit(*item(key, i));
}

std::optional<GltfObject> GltfObject::item(const char* key, std::size_t number) const {
  if (number >= item_count(key))
    return std::nullopt;
  return GltfObject((*find_list(key))[number], *path_,
                    fmt::format("{}[{}]", place_of(key), number));
}

std::size_t GltfObject::item_count(const char* key) const {
  const Json* list = find_list(key);
  return list == nullptr ? 0 : list->size();
}

void GltfObject::for_each_index(
    std::size_t size, const std::function<void(const std::string&, std::uint32_t)>& visit) const {
  for (const auto& [key, value] : object_->items())
    visit(key, require_index(key.c_str(), size));
}

}  // namespace meshhier::mesh_io

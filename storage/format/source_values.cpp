#include "storage/format/source_values.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

/// The least and most of ValueStatistics::bin_exponent.
constexpr double kMostExponent = 1100;

Json value_json(const ScalarAttribute& attribute, const ValueStatistics& statistics) {
  Json json{{"name", attribute.name},
            {"type", name_of(attribute.type)},
            {"kind", name_in(kValueKinds, kind_of(attribute))},
            {"missing", statistics.missing},
            {"min", statistics.min},
            {"max", statistics.max},
            {"bin_exponent", statistics.bin_exponent},
            {"first_bin", statistics.first_bin},
            {"bins", statistics.bins}};
  if (statistics.labels.empty())
    return json;
  Json labels = Json::array(), vertices = Json::array(), names = Json::array();
  for (const auto& [label, count, name] : statistics.labels) {
    labels.push_back(label);
    vertices.push_back(count);
    names.push_back(name);
  }
  json["labels"] = std::move(labels);
  json["label_vertices"] = std::move(vertices);
  if (std::ranges::any_of(statistics.labels, [](const auto& label) { return !label.name.empty(); }))
    json["label_names"] = std::move(names);
  return json;
}

std::vector<double> numbers_of(const JsonObject& object, const char* key, std::size_t most) {
  const Json& list = object.at(key);
  const bool is_sound = list.is_array() && list.size() <= most &&
                        std::all_of(list.begin(), list.end(), [](const Json& number) {
                          return number.is_number() && std::isfinite(number.get<double>());
                        });
  if (!is_sound)
    object.wrong(key, "a short list of numbers");
  return list.get<std::vector<double>>();
}

std::vector<std::uint64_t> counts_of(const JsonObject& object, const char* key, std::size_t most) {
  const Json& list = object.at(key);
  const bool is_sound =
      list.is_array() && list.size() <= most &&
      std::all_of(list.begin(), list.end(), [](const Json& n) { return n.is_number_unsigned(); });
  if (!is_sound)
    object.wrong(key, "a short list of counts");
  return list.get<std::vector<std::uint64_t>>();
}

/// Returns the names of labels; empty ones if there are none.
std::vector<std::string> names_of(const JsonObject& object, std::size_t count) {
  if (!object.has("label_names"))
    return std::vector<std::string>(count);
  const Json& list = object.at("label_names");
  const bool is_sound =
      list.is_array() && list.size() == count &&
      std::all_of(list.begin(), list.end(), [](const Json& name) { return name.is_string(); });
  if (!is_sound)
    object.wrong("label_names", "as many texts as labels");
  return list.get<std::vector<std::string>>();
}

std::int64_t integer_of(const JsonObject& object, const char* key, double most) {
  const Json& number = object.at(key);
  if (!number.is_number_integer() || std::abs(number.get<double>()) > most)
    object.wrong(key, "an integer");
  return number.get<std::int64_t>();
}

ScalarAttribute attribute_of(const JsonObject& object) {
  ScalarAttribute attribute;
  attribute.name = object.text("name");
  if (!is_attribute_name(attribute.name))
    object.wrong("name", "a name without spaces");
  const auto type = value_type_of(object.text("type"));
  if (!type)
    object.wrong("type", "one of i8, u8, i16, u16, i32, u32, f32, f64");
  attribute.type = *type;
  const auto kind = value_named(kValueKinds, object.text("kind"));
  if (!kind)
    object.wrong("kind", names_in(kValueKinds));
  set_kind(attribute, *kind);
  if (attribute.is_object && attribute.type != ValueType::u32)
    object.wrong("type", "u32 of objects");
  return attribute;
}

ValueStatistics statistics_of(const JsonObject& object) {
  constexpr double kMostBin = 9007199254740992.0;  // 2^53
  ValueStatistics statistics;
  statistics.missing = object.count("missing");
  statistics.min = object.number("min");
  statistics.max = object.number("max");
  if (statistics.min > statistics.max)
    object.wrong("min", "at most max");
  statistics.bin_exponent = static_cast<int>(integer_of(object, "bin_exponent", kMostExponent));
  statistics.first_bin = integer_of(object, "first_bin", kMostBin);
  statistics.bins = counts_of(object, "bins", ValueStatistics::kMostBins);
  if (!object.has("labels"))
    return statistics;
  const std::vector<double> labels = numbers_of(object, "labels", ValueStatistics::kMostLabels);
  const std::vector<std::uint64_t> vertices =
      counts_of(object, "label_vertices", ValueStatistics::kMostLabels);
  if (labels.empty() || labels.size() != vertices.size())
    object.wrong("label_vertices", "as many as labels");
  const std::vector<std::string> names = names_of(object, labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i)
    statistics.labels.push_back({labels[i], vertices[i], names[i]});
  return statistics;
}

}  // namespace

Json source_values_json(const SourceSummary& source) {
  Json values = Json::array();
  for (std::size_t i = 0; i < source.attributes.values.size(); ++i)
    values.push_back(value_json(source.attributes.values[i], source.values[i]));
  return values;
}

void read_source_values(const JsonObject& object, SourceSummary& source) {
  std::vector<ScalarAttribute>& attributes = source.attributes.values;
  for (const JsonObject& value : object.objects("values")) {
    attributes.push_back(attribute_of(value));
    source.values.push_back(statistics_of(value));
    const auto known =
        std::ranges::find(attributes, attributes.back().name, &ScalarAttribute::name);
    if (known != attributes.end() - 1)
      value.wrong("name", "another one than before");
    if (attributes.back().is_object &&
        std::ranges::count_if(attributes, &ScalarAttribute::is_object) > 1)
      value.wrong("kind", "object of one value alone");
    if (source.attributes.value_channels() > kMaxValueChannels)
      object.wrong("values", "fewer of them");
  }
}

}  // namespace meshhier::storage

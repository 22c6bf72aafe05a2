#include "storage/format/object_facts.h"

#include <algorithm>
#include <utility>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

ObjectProperty property_of(const JsonObject& object) {
  const std::string name = object.text("name");
  if (name.empty() || name.size() > kMostPropertyNameBytes)
    object.wrong("name", "1 to 255 bytes");
  const auto type = object_property_type_of(object.text("type"));
  if (!type)
    object.wrong("type", "one of number, boolean, text, date");
  return {name, *type};
}

std::vector<ObjectProperty> properties_of(const JsonObject& object) {
  std::vector<ObjectProperty> properties;
  for (const JsonObject& property : object.objects("properties")) {
    properties.push_back(property_of(property));
    const std::string& name = properties.back().name;
    if (std::ranges::find(properties, name, &ObjectProperty::name) != properties.end() - 1)
      property.wrong("name", "another one than before");
  }
  if (properties.size() > kMostObjectProperties)
    object.wrong("properties", "at most 64");
  return properties;
}

}  // namespace

Json object_facts_json(const ObjectTableFacts& facts, const std::filesystem::path& file) {
  Json properties = Json::array();
  for (const auto& [name, type] : facts.properties)
    properties.push_back({{"name", name}, {"type", name_of(type)}});
  return {{"file", file.string()},
          {"bytes", facts.bytes},
          {"checksum", hex_digits(facts.checksum)},
          {"count", facts.objects},
          {"directory",
           {{"bytes", facts.directory_bytes}, {"checksum", hex_digits(facts.directory_checksum)}}},
          {"properties", std::move(properties)}};
}

ObjectTableFacts read_object_facts(const JsonObject& object, const std::filesystem::path& file) {
  if (object.text("file") != file.string())
    object.wrong("file", file.string());
  const JsonObject directory = object.object("directory");
  return {object.count("bytes"),
          object.hash("checksum"),
          static_cast<std::uint32_t>(object.count("count", kMostObjects)),
          directory.count("bytes"),
          directory.hash("checksum"),
          properties_of(object)};
}

std::vector<ObjectFile> object_files(const std::optional<ObjectsSummary>& objects) {
  std::vector<ObjectFile> files;
  if (objects)
    files.push_back({objects_path({}), objects->table.bytes, objects->table.checksum});
  if (objects && objects->words)
    files.push_back({object_words_path({}), objects->words->bytes, objects->words->checksum});
  return files;
}

std::uint64_t object_file_bytes(const std::optional<ObjectsSummary>& objects) {
  std::uint64_t bytes = 0;
  for (const ObjectFile& file : object_files(objects))
    bytes += file.bytes;
  return bytes;
}

}  // namespace meshhier::storage

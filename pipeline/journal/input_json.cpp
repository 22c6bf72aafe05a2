#include "pipeline/journal/input_json.h"

#include "pipeline/journal/binary_text.h"

#include <span>
#include <string>

namespace meshhier::pipeline {
namespace {

nlohmann::json to_json(const images::ImageSource& image) {
  return {{"name", to_binary(image.name)}, {"file", to_binary(image.file.string())},
          {"offset", image.offset},        {"bytes", image.bytes},
          {"data", to_binary(image.data)}, {"packed", image.is_packed},
          {"drape", image.is_drape}};
}

images::ImageSource image_source(const nlohmann::json& json) {
  images::ImageSource image;
  image.name = text_of(json.at("name"));
  image.file = text_of(json.at("file"));
  image.offset = json.at("offset");
  image.bytes = json.at("bytes");
  const auto data = std::as_bytes(std::span(json.at("data").get_binary()));
  image.data.assign(data.begin(), data.end());
  image.is_packed = json.at("packed");
  image.is_drape = json.at("drape");
  return image;
}

nlohmann::json to_json(const images::Material& material) {
  nlohmann::json json{{"name", to_binary(material.name)},
                      {"colour", material.colour},
                      {"factor", material.factor},
                      {"light", material.light},
                      {"wraps", {material.wrap_u, material.wrap_v}},
                      {"alpha", material.alpha},
                      {"cutoff", material.alpha_cutoff},
                      {"alpha_unsaid", material.is_alpha_unsaid}};
  if (material.image)
    json["image"] = *material.image;
  return json;
}

images::Material material_of(const nlohmann::json& json) {
  images::Material material;
  material.name = text_of(json.at("name"));
  material.colour = json.at("colour");
  material.factor = json.at("factor");
  material.light = json.at("light");
  material.wrap_u = json.at("wraps").at(0);
  material.wrap_v = json.at("wraps").at(1);
  material.alpha = json.at("alpha");
  material.alpha_cutoff = json.at("cutoff");
  material.is_alpha_unsaid = json.at("alpha_unsaid");
  if (json.contains("image"))
    material.image = json.at("image").get<std::uint32_t>();
  return material;
}

}  // namespace

nlohmann::json to_json(const images::MaterialList& list) {
  nlohmann::json images = nlohmann::json::array();
  for (const images::ImageSource& image : list.images)
    images.push_back(to_json(image));
  nlohmann::json materials = nlohmann::json::array();
  for (const images::Material& material : list.materials)
    materials.push_back(to_json(material));
  return {{"images", std::move(images)}, {"materials", std::move(materials)}};
}

images::MaterialList material_list(const nlohmann::json& json) {
  images::MaterialList list;
  for (const nlohmann::json& image : json.at("images"))
    list.images.push_back(image_source(image));
  for (const nlohmann::json& material : json.at("materials"))
    list.materials.push_back(material_of(material));
  return list;
}

nlohmann::json to_json(const importing::InputRecord& record) {
  nlohmann::json files = nlohmann::json::array(), awaited = nlohmann::json::array();
  for (const importing::ReadFile& file : record.files) {
    const storage::FileIdentity& identity = file.identity;
    files.push_back({to_binary(file.path.string()), file.part, identity.bytes, identity.modified_ns,
                     identity.changed_ns, file.checksum});
  }
  for (const std::filesystem::path& place : record.awaited)
    awaited.push_back(to_binary(place.string()));
  return {{"files", std::move(files)}, {"awaited", std::move(awaited)}};
}

importing::InputRecord input_record(const nlohmann::json& json) {
  importing::InputRecord record;
  for (const nlohmann::json& file : json.at("files")) {
    record.files.push_back(
        {text_of(file.at(0)), file.at(1), {file.at(2), file.at(3), file.at(4)}, file.at(5)});
  }
  for (const nlohmann::json& place : json.at("awaited"))
    record.awaited.emplace_back(text_of(place));
  return record;
}

}  // namespace meshhier::pipeline

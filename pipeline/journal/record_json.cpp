#include "pipeline/journal/record_json.h"

#include "pipeline/journal/binary_text.h"

namespace meshhier::pipeline {

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

#include "config/view_config.h"

#include "storage/format/view_keys.h"

#include <utility>

namespace meshhier::config {
namespace {

using Json = nlohmann::ordered_json;

ConfigKey row_of(const storage::ViewKey& key) {
  ConfigKey row{.path = "view." + std::string(key.name),
                .meaning = std::string(key.meaning),
                .unset = std::string(key.unset),
                .decides_result = true,
                .kind = KeyKind::view,
                .choices = key.words,
                .view = &key};
  row.assign = [&key](Config& config, const Json& value) {
    storage::assign(key, value, config.view);
  };
  row.show = [&key](const Config& config) { return storage::value_json(key, config.view); };
  if (key.name == "box")
    row.excludes = {"cut"};
  return row;
}

}  // namespace

std::vector<ConfigKey> view_config_keys() {
  std::vector<ConfigKey> rows;
  for (const storage::ViewKey& key : storage::view_keys())
    rows.push_back(row_of(key));
  return rows;
}

}  // namespace meshhier::config

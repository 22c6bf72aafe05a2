#include "export/manifest_config.h"

#include "storage/io/json_text.h"

#include <nlohmann/json.hpp>

namespace meshhier::exporting {

config::Config config_of(const storage::Manifest& manifest) {
  nlohmann::ordered_json text = {{"input", "input.ply"}, {"output", "output.hier"}};
  text.update(manifest.config);
  return config::parse_config(storage::json_text(text), {"\"config\"", {}}, {});
}

}  // namespace meshhier::exporting

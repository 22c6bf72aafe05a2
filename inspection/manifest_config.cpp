#include "inspection/manifest_config.h"

#include <nlohmann/json.hpp>

namespace meshhier::inspection {

config::Config config_of(const storage::Manifest& manifest) {
  nlohmann::ordered_json text = {{"input", "input.ply"}, {"output", "output.hier"}};
  text.update(manifest.config);
  return config::parse_config(text.dump(), {"\"config\"", {}}, {});
}

}  // namespace meshhier::inspection

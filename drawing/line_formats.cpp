#include "drawing/line_formats.h"

#include "export/manifest_config.h"

#include <fmt/format.h>

namespace meshhier::drawing {

bool has_place_on_globe(const storage::Manifest& manifest) {
  return exporting::config_of(manifest).placement.crs || exporting::map_frame(manifest).is_on_globe;
}

std::string level_text(double height) {
  return fmt::format("{:.12g}", height);
}

}  // namespace meshhier::drawing

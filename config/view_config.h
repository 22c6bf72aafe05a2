// The config's section "view", made from the table of what a view is (storage/format/view_keys.h).
#pragma once

#include "config/config_schema.h"
#include "hierarchy/model_view.h"

#include <span>
#include <string>
#include <vector>

namespace meshhier::config {

/// Returns the keys of the section, "view.camera" first.
std::vector<ConfigKey> view_config_keys();

/// Returns a view with settings on top, "view.ramp=turbo" each, or "view={...}" for all of it.
/// Throws Error(usage) as parse_config(), and for a setting of anything else.
ModelView with_settings(const ModelView& view, std::span<const std::string> settings);

}  // namespace meshhier::config

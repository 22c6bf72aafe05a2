// The config that a hierarchy was made by.
#pragma once

#include "config/config.h"
#include "storage/format/manifest.h"

namespace meshhier::exporting {

/// Returns the config that the manifest tells, without the paths of its files. Throws Error(usage)
/// if it is none.
config::Config config_of(const storage::Manifest& manifest);

}  // namespace meshhier::exporting

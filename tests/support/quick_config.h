// The configuration of most small builds of tests.
#pragma once

#include "config/config.h"

namespace meshhier::tests {

/// The defaults without normal maps: to bake one takes longer than all else of so small a build.
inline config::Config smooth_config() {
  config::Config config;
  config.storage.normals = config::Normals::smooth;
  return config;
}

/// The same without a preview, for the same reason.
inline config::Config quick_config() {
  config::Config config = smooth_config();
  config.preview = false;
  return config;
}

}  // namespace meshhier::tests

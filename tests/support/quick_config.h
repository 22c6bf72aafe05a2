// The configuration of most small builds of tests.
#pragma once

#include "config/config.h"

namespace meshhier::tests {

/// The defaults without a preview: to draw and to look at one takes longer than all else of so
/// small a build.
inline config::Config quick_config() {
  config::Config config;
  config.preview = false;
  return config;
}

}  // namespace meshhier::tests

// The error by which a tile is refused.
#pragma once

#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/tile_glb.h"
#include "tests/support/error_message.h"

#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {

inline constexpr const char* kTileName = "some/tile.glb";

/// The message with which decoding fails, which begins with kTileName; empty if it does not.
inline std::string decode_failure(const std::vector<std::byte>& bytes, NodeId node,
                                  const SampleHierarchy& sample) {
  return error_message(
      ErrorCode::corrupt,
      [&] { storage::decode_tile(bytes, node, sample.tree, sample.format, kTileName); }, kTileName);
}

}  // namespace meshhier::tests

// The error by which a tile is refused.
#pragma once

#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/tile_glb.h"

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
  try {
    storage::decode_tile(bytes, node, sample.tree, sample.format, kTileName);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_THAT(error.what(), testing::StartsWith(kTileName));
    return error.what();
  }
  return {};
}

}  // namespace meshhier::tests

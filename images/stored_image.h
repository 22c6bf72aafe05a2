// The facts by which a later process reads a picture that was stored.
#pragma once

#include "images/image_codec.h"

#include <cstdint>
#include <vector>

namespace meshhier::images {

/// The place of a row of blocks in the scratch file.
struct StoredStrip {
  std::uint64_t offset = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64
  friend bool operator==(const StoredStrip&, const StoredStrip&) = default;
};

struct StoredImage {
  ImageInfo info;
  std::vector<StoredStrip> strips;  ///< strips of all levels (block_grid.h)
  friend bool operator==(const StoredImage&, const StoredImage&) = default;
};

}  // namespace meshhier::images

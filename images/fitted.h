// Encodes a picture into a file of limited size.
#pragma once

#include "images/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {

struct FittedImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::byte> file;  ///< a WebP
};

/// Encodes the picture at the best quality that fits; where none does, the picture with half of its
/// sides, again and again. Deterministic for one version of libwebp, whatever the processor.
/// Requires `most_bytes` of 1,000 or more: a picture of one pixel fits.
FittedImage encode_to_fit(Image picture, std::uint64_t most_bytes);

}  // namespace meshhier::images

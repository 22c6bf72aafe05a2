// Pictures in UASTC: rows in, blocks out.
//
//       rows of level 0 --> strip of 4 rows --> blocks
//            | means of each two
//       rows of level 1 --> strip of 4 rows --> blocks
//            | ...
//
// A side is half of the larger one's, rounded down as devices have it: an odd last row or column
// has no part in the means. A block that reaches over the picture's edge has its last texels again.
#pragma once

#include "images/image.h"
#include "images/ktx2_writer.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {

/// Returns a KTX2 file of a picture with all smaller ones, down to a single texel: means of 2 x 2
/// in linear light, of directions brought to unit length. Thread-safe.
std::vector<std::byte> encode_uastc(const Image& image, Ktx2Meaning meaning);

/// Returns the memory of encoding, besides the picture.
std::uint64_t uastc_encoder_bytes(std::uint64_t texels);

}  // namespace meshhier::images

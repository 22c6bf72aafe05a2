// PNG that is not packed: it goes through a socket, and is unpacked at once.
//
//   signature, IHDR | IDAT: 2 bytes of zlib; blocks of 5 bytes and up to 65,535 of rows; a sum |
//   IEND ^ the start: it tells the size, and how many bytes follow
#pragma once

#include "images/image.h"

#include <cstdint>
#include <string>

namespace meshhier::mesh_io::osgb {

struct PngSize {
  std::uint32_t width, height, channels;
};

/// Returns the first bytes of the PNG of a picture of that size. Throws std::runtime_error if it
/// has too many texels for one chunk, about 2^31 bytes.
std::string png_start(const PngSize& size);

/// Returns the PNG of a picture with 3 or 4 channels. Throws as png_start().
std::string png_of(const images::Image& image);

}  // namespace meshhier::mesh_io::osgb

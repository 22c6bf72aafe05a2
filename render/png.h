// Pictures as files.
#pragma once

#include "render/shade.h"

#include <cstddef>
#include <vector>

namespace meshhier::render {

/// A PNG file: 8 bits a channel, with alpha, sRGB, without a time. Requires a picture of a pixel or
/// more. Equal bytes for equal pictures, as long as libpng and zlib are the same.
std::vector<std::byte> encode_png(const Picture& picture);

}  // namespace meshhier::render

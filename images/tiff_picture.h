// Pictures in TIFF that lie on a map: orthophotos, of any size up to kMaxSourceSide.
//
// Red, green and blue, grey, palettes; 8 or 16 bits; with an alpha, with a mask beside, or with a
// number for no colour. What is not seen has the colour of bare ground. So has a frame of one
// texel around the picture: coordinates that are held at the edge show bare ground beyond it.
#pragma once

#include "images/image_codec.h"
#include "storage/io/file.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace meshhier::images {

/// The colour of ground that no picture shows, sRGB.
inline constexpr std::array<std::uint8_t, 3> kBareGround{190, 190, 190};

/// The width of the frame, in texels.
inline constexpr std::uint32_t kPictureFrame = 1;

/// Opens the first image of full resolution; reads tags and nothing else. The picture has three
/// channels, and the frame around it. Throws Error(input) that starts with `name` if it is no such
/// picture, or too large; Error(io).
std::unique_ptr<ImageReader> open_framed_tiff(std::unique_ptr<storage::File> file,
                                              const std::string& name);

}  // namespace meshhier::images

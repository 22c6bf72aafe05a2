// A picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {

/// A picture of 8 bits a channel, sRGB, row by row from the top, without padding.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::uint32_t channels = 3;        ///< 3: red, green, blue; 4: alpha too, not premultiplied
  std::vector<std::uint8_t> texels;  ///< width * height * channels

  Image() = default;
  Image(std::uint32_t w, std::uint32_t h, std::uint32_t c)
      : width(w), height(h), channels(c), texels(std::size_t{w} * h * c) {}

  std::uint8_t* at(std::uint32_t x, std::uint32_t y) {
    return texels.data() + (std::size_t{y} * width + x) * channels;
  }
  const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const {
    return texels.data() + (std::size_t{y} * width + x) * channels;
  }
  friend bool operator==(const Image&, const Image&) = default;
};

/// Copies a texel of 3 or 4 channels.
inline void copy_texel(const std::uint8_t* from, std::uint8_t* to, std::uint32_t channels) {
  to[0] = from[0], to[1] = from[1], to[2] = from[2];
  if (channels == 4)
    to[3] = from[3];
}

}  // namespace meshhier::images

// A picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::images {

/// 8 bits a channel, sRGB, row by row from the top, without padding.
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

}  // namespace meshhier::images

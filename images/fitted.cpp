#include "images/fitted.h"

#include "images/image_codec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace meshhier::images {
namespace {

/// Below, a smaller picture shows more.
constexpr std::array kQualities{90, 80, 70, 60, 50, 40};

/// The mean of four pixels, weighted by their alpha.
void put_mean(const Image& from, std::uint32_t x, std::uint32_t y, std::uint8_t* to) {
  const auto right = std::min(2 * x + 1, from.width - 1),
             below = std::min(2 * y + 1, from.height - 1);
  std::array<std::uint32_t, 3> sums{};
  std::uint32_t alpha = 0;
  for (const std::uint8_t* pixel : {from.at(2 * x, 2 * y), from.at(right, 2 * y),
                                    from.at(2 * x, below), from.at(right, below)}) {
    const std::uint32_t weight = from.channels == 4 ? pixel[3] : 255;
    for (std::size_t c = 0; c < sums.size(); ++c)
      sums[c] += weight * pixel[c];
    alpha += weight;
  }
  for (std::size_t c = 0; c < sums.size(); ++c)
    to[c] = static_cast<std::uint8_t>(alpha > 0 ? (sums[c] + alpha / 2) / alpha : 0);
  if (from.channels == 4)
    to[3] = static_cast<std::uint8_t>((alpha + 2) / 4);
}

Image with_half_sides(const Image& picture) {
  Image half((picture.width + 1) / 2, (picture.height + 1) / 2, picture.channels);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    for (std::uint32_t x = 0; x < half.width; ++x)
      put_mean(picture, x, y, half.at(x, y));
  }
  return half;
}

}  // namespace

FittedImage encode_to_fit(Image picture, std::uint64_t most_bytes) {
  for (;; picture = with_half_sides(picture)) {
    for (const int quality : kQualities) {
      std::vector<std::byte> file = encode_image(picture, ImageFormat::webp, quality);
      const bool is_last = picture.width == 1 && picture.height == 1;
      if (file.size() <= most_bytes || is_last)
        return {picture.width, picture.height, std::move(file)};
    }
  }
}

}  // namespace meshhier::images

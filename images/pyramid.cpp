#include "images/pyramid.h"

#include "base/srgb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace meshhier::images {
namespace {

/// A square of texels.
struct Four {
  const std::uint8_t *a, *b, *c, *d;
};

void mean_of_opaque(const LightTable& table, const Four& texels, std::uint8_t* mean) {
  const auto mean_of = [&](std::size_t c) {
    return table.value((table.light(texels.a[c]) + table.light(texels.b[c]) +
                        table.light(texels.c[c]) + table.light(texels.d[c]) + 2) /
                       4);
  };
  mean[0] = mean_of(0), mean[1] = mean_of(1), mean[2] = mean_of(2);
}

/// Weighs colours by alpha; where all is transparent, they count alike.
void mean_of_transparent(const LightTable& table, const Four& texels, std::uint8_t* mean) {
  const std::array all = {texels.a, texels.b, texels.c, texels.d};
  std::uint32_t alpha = 0;
  for (const std::uint8_t* texel : all)
    alpha += texel[3];
  mean_of_opaque(table, texels, mean);
  mean[3] = static_cast<std::uint8_t>((alpha + 2) / 4);
  for (std::size_t c = 0; c < 3 && alpha > 0; ++c) {
    std::uint32_t sum = alpha / 2;
    for (const std::uint8_t* texel : all)
      sum += table.light(texel[c]) * texel[3];
    mean[c] = table.value(sum / alpha);
  }
}

void mean_of_directions(const Four& texels, std::uint8_t* mean) {
  constexpr float kHalf = 127.5F, kZero = 4 * kHalf;
  std::array<float, 3> sum{};
  for (std::size_t c = 0; c < 3; ++c)
    sum[c] = static_cast<float>(texels.a[c] + texels.b[c] + texels.c[c] + texels.d[c]) - kZero;
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  const float scale = length > 0 ? kHalf / length : 0;
  for (std::size_t c = 0; c < 3; ++c)
    mean[c] = static_cast<std::uint8_t>(kHalf + sum[c] * scale + 0.5F);
}

template <std::size_t kChannels, class Mean>
void halve(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
           std::uint8_t* means, const Mean& mean) {
  for (std::size_t x = 0; x < width; x += 2) {
    const std::size_t left = kChannels * x;
    const std::size_t right = kChannels * std::min<std::size_t>(x + 1, width - 1);
    mean(Four{above + left, above + right, below + left, below + right},
         means + kChannels * (x / 2));
  }
}

}  // namespace

std::uint32_t level_count(TexelSize picture) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(picture.width, picture.height) - 1)) +
         1;
}

TexelSize level_size(TexelSize picture, std::uint32_t level) {
  const auto halved = [level](std::uint64_t side) {
    return static_cast<std::uint32_t>((side + (std::uint64_t{1} << level) - 1) >> level);
  };
  return {halved(picture.width), halved(picture.height)};
}

void halve_rows(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
                std::uint32_t channels, std::uint8_t* means) {
  const LightTable& table = LightTable::get();
  if (channels == 4) {
    halve<4>(above, below, width, means, [&](const Four& texels, std::uint8_t* mean) {
      mean_of_transparent(table, texels, mean);
    });
  } else {
    halve<3>(above, below, width, means,
             [&](const Four& texels, std::uint8_t* mean) { mean_of_opaque(table, texels, mean); });
  }
}

void halve_directions(const std::uint8_t* above, const std::uint8_t* below, std::uint32_t width,
                      [[maybe_unused]] std::uint32_t channels, std::uint8_t* means) {
  assert(channels == 3);
  halve<3>(above, below, width, means, mean_of_directions);
}

}  // namespace meshhier::images

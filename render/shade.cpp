#include "render/shade.h"

#include "images/srgb.h"

#include <algorithm>

namespace meshhier::render {
namespace {

/// A lamp far away, by the view's axes.
struct Lamp {
  Vec3d towards;  ///< of length 1
  double light = 0;
  double wrap = 0;  ///< how far it reaches around the edge of a shadow, >= 0: soft lamps do

  double on(Vec3d normal) const {
    return light * std::max(0.0, (dot(normal, towards) + wrap) / (1 + wrap));
  }
};

// A white surface that looks to the key lamp gets about 1.2: bright places of a grey one, and no
// more, come near to white. The darkest place has a tenth of that, so that its shape is seen.
constexpr Lamp kKey{{-0.48, 0.64, 0.6}, 1, 0.1};
constexpr Lamp kFill{{0.8, 0, 0.6}, 0.15, 0};
constexpr double kSky = 0.16, kFloor = 0.06;

double light_on(Vec3d normal) {
  const double upward = (1 + normal.y) / 2;
  return kKey.on(normal) + kFill.on(normal) + kFloor + (kSky - kFloor) * upward;
}

/// The samples of a pixel.
struct PixelSum {
  Vec3d light;
  std::uint32_t covered = 0;

  void add(const Sample& sample, Light kind) {
    if (!sample.covered())
      return;
    const double share = kind == Light::lamps ? light_on(to_double(sample.normal)) : 1;
    light = light + to_double(sample.colour) * share;
    ++covered;
  }
};

PixelSum sum_of_pixel(const Raster& raster, std::size_t column, std::size_t row, Light light) {
  const std::size_t side = raster.framing().samples;
  PixelSum sum;
  for (std::size_t y = 0; y < side; ++y) {
    const std::size_t first = (row * side + y) * raster.columns() + column * side;
    for (const Sample& sample : raster.samples().subspan(first, side))
      sum.add(sample, light);
  }
  return sum;
}

void put(const PixelSum& sum, std::uint32_t samples, std::uint8_t* texel) {
  const Vec3d mean = sum.covered > 0 ? sum.light * (1.0 / sum.covered) : Vec3d{};
  for (const double light : {mean.x, mean.y, mean.z})
    *texel++ = images::screen_value(light);
  *texel = static_cast<std::uint8_t>((255 * sum.covered + samples / 2) / samples);
}

}  // namespace

images::Image shade(const Raster& raster, Light light) {
  const Framing& framing = raster.framing();
  images::Image picture(framing.width, framing.height, 4);
  for (std::uint32_t row = 0; row < framing.height; ++row) {
    for (std::uint32_t column = 0; column < framing.width; ++column)
      put(sum_of_pixel(raster, column, row, light), framing.samples * framing.samples,
          picture.at(column, row));
  }
  return picture;
}

}  // namespace meshhier::render

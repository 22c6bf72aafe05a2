#include "render/shade.h"

#include "hierarchy/srgb.h"
#include "render/occlusion.h"

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

/// Of the key lamp's light, the part that is hidden with the sky.
constexpr double kSoftness = 0.6;
/// Of pictures that have their light already, what hollows lose of it.
constexpr double kPictureShade = 0.35;

/// What falls on a surface; `sky`: how much of it the place sees. The key lamp is wide, so some of
/// it is hidden with the sky.
double light_on(Vec3d normal, double sky) {
  const double upward = (1 + normal.y) / 2;
  const double soft = kFill.on(normal) + kFloor + (kSky - kFloor) * upward;
  return kKey.on(normal) * (1 - kSoftness * (1 - sky)) + soft * sky;
}

/// As if slopes were `relief` times as steep.
Vec3d in_relief(Vec3f normal, double relief) {
  if (relief == 1)
    return to_double(normal);
  const Vec3d steeper{normal.x * relief, normal.y * relief, normal.z};
  return steeper * (1 / length(steeper));
}

double light_on(const Sample& sample, const Lighting& lighting, double sky) {
  if (lighting.kind == Light::none)
    return 1 - kPictureShade * (1 - sky);
  return lighting.exposure * light_on(in_relief(sample.normal, lighting.relief), sky);
}

double sky_of_pixel(const Raster& raster, std::size_t column, std::size_t row,
                    const Occlusion* occlusion) {
  if (occlusion == nullptr)
    return 1;
  const Framing& framing = raster.framing();
  return occlusion->sky_at(
      (static_cast<double>(column) + 0.5) / framing.width,
      (static_cast<double>(raster.pixel_rows().first + row) + 0.5) / framing.height);
}

/// The samples of a pixel.
struct PixelSum {
  Vec3d light;
  std::uint32_t covered = 0;

  void add(const Sample& sample, const Lighting& lighting, double sky) {
    if (!sample.covered())
      return;
    light = light + to_double(sample.colour) * light_on(sample, lighting, sky);
    ++covered;
  }
};

/// `row`: of those that the raster has.
PixelSum sum_of_pixel(const Raster& raster, std::size_t column, std::size_t row,
                      const Lighting& lighting) {
  const std::size_t side = raster.framing().samples;
  const double sky = sky_of_pixel(raster, column, row, lighting.occlusion);
  PixelSum sum;
  for (std::size_t y = 0; y < side; ++y) {
    const std::size_t first = (row * side + y) * raster.columns() + column * side;
    for (const Sample& sample : raster.samples().subspan(first, side))
      sum.add(sample, lighting, sky);
  }
  return sum;
}

void put(const PixelSum& sum, std::uint32_t samples, std::uint8_t* texel) {
  const Vec3d mean = sum.covered > 0 ? sum.light * (1.0 / sum.covered) : Vec3d{};
  for (const double light : {mean.x, mean.y, mean.z})
    *texel++ = screen_value(light);
  *texel = static_cast<std::uint8_t>((255 * sum.covered + samples / 2) / samples);
}

}  // namespace

images::Image shade(const Raster& raster, const Lighting& lighting) {
  const Framing& framing = raster.framing();
  images::Image picture(framing.width, raster.pixel_rows().count, 4);
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < framing.width; ++column)
      put(sum_of_pixel(raster, column, row, lighting), framing.samples * framing.samples,
          picture.at(column, row));
  }
  return picture;
}

}  // namespace meshhier::render

#include "render/painting.h"

#include "render/occlusion.h"
#include "render/raster.h"
#include "render/shade.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshhier::render {
namespace {

/// Shadows are soft: they are made of a picture with so many times fewer pixels a side,
constexpr std::uint32_t kShadowParts = 2;
/// and need no more than this; its longer side.
constexpr std::uint32_t kMostShadowPixels = 1024;

/// Slopes are made so steep on the average, as far as kMostRelief lets them.
constexpr double kWantedSlope = 0.6, kMostRelief = 40;

/// So that white surfaces that face the key lamp are not burnt.
constexpr double kExposure = 0.82;

Framing coarser(Framing framing) {
  const std::uint32_t longer = std::max(framing.width, framing.height);
  const std::uint32_t parts =
      std::max(kShadowParts, (longer + kMostShadowPixels - 1) / kMostShadowPixels);
  framing.width = std::max(framing.width / parts, 1U);
  framing.height = std::max(framing.height / parts, 1U);
  framing.samples = 1;
  return framing;
}

/// How steep what is seen is, on the average: the tangent of its angle with the picture.
double mean_slope(const Raster& raster) {
  double sum = 0;
  std::uint64_t count = 0;
  for (const Sample& sample : raster.samples()) {
    if (!sample.covered())
      continue;
    const double across = std::sqrt(double{sample.normal.x} * sample.normal.x +
                                    double{sample.normal.y} * sample.normal.y);
    sum += across / std::max<double>(sample.normal.z, 0.1);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

double relief_for(const Raster& raster) {
  const double slope = mean_slope(raster);
  return slope > 0 ? std::clamp(kWantedSlope / slope, 1.0, kMostRelief) : 1;
}

/// Whether anything of a box may be seen in the rows of a raster.
bool may_be_seen(const Raster& raster, const Camera& camera, const Bounds& box) {
  if (box.empty())
    return false;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f place{corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                      corner & 4 ? box.max.z : box.min.z};
    const double y = camera.on_grid(place).y;
    least = std::min(least, y);
    most = std::max(most, y);
  }
  // A sample more on each side: for what is rounded.
  const double first = 1.0 * raster.pixel_rows().first * raster.framing().samples;
  return most >= first - 1 && least <= first + raster.rows() + 1;
}

void draw(const Scene& scene, const Camera& camera, const PaintingOptions& options,
          Raster& raster) {
  for (std::size_t tile = 0; tile < scene.boxes.size(); ++tile) {
    options.step();
    if (!may_be_seen(raster, camera, scene.boxes[tile]))
      continue;
    if (scene.held.empty())
      scene.load(tile).draw(raster);
    else
      scene.held[tile].draw(raster);
  }
}

std::uint32_t band_rows(const Framing& framing, std::uint64_t band_bytes) {
  const std::uint64_t row =
      std::uint64_t{framing.width} * framing.samples * framing.samples * sizeof(Sample);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(band_bytes / row, 1, framing.height));
}

}  // namespace

std::uint64_t painting_steps(const Scene& scene, const Camera& camera,
                             const PaintingOptions& options) {
  const std::uint32_t rows = band_rows(camera.framing(), options.band_bytes);
  return scene.boxes.size() * (1 + std::uint64_t{camera.framing().height + rows - 1} / rows);
}

images::Image paint(const Scene& scene, const Camera& camera, const PaintingOptions& options) {
  const Framing framing = camera.framing();
  Lighting lighting{.kind = scene.light, .exposure = kExposure};
  const Occlusion occlusion = [&] {
    const Camera coarse = camera.with(coarser(framing));
    Raster raster(coarse);
    draw(scene, coarse, options, raster);
    lighting.relief = relief_for(raster);
    return Occlusion(raster, lighting.relief);
  }();
  lighting.occlusion = &occlusion;
  images::Image picture(framing.width, framing.height, 4);
  const std::uint32_t rows = band_rows(framing, options.band_bytes);
  for (std::uint32_t first = 0; first < framing.height; first += rows) {
    Raster raster(camera, {first, std::min(rows, framing.height - first)});
    draw(scene, camera, options, raster);
    const images::Image band = shade(raster, lighting);
    std::ranges::copy(band.texels, picture.at(0, first));
  }
  return picture;
}

}  // namespace meshhier::render

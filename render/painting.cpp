#include "render/painting.h"

#include "render/raster.h"
#include "render/shade.h"

#include <algorithm>
#include <limits>

namespace meshhier::render {
namespace {

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
  return scene.boxes.size() * (std::uint64_t{camera.framing().height + rows - 1} / rows);
}

images::Image paint(const Scene& scene, const Camera& camera, const PaintingOptions& options) {
  const Framing framing = camera.framing();
  const Lighting lighting = lighting_of(scene.look, camera);
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

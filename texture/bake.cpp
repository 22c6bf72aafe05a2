#include "texture/bake.h"

#include "texture/charted_tile.h"
#include "texture/fill.h"
#include "texture/finer_points.h"
#include "texture/texel_fit.h"
#include "texture/texel_light.h"
#include "texture/texel_sampler.h"
#include "texture/texel_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace meshhier::texture {
namespace {

std::uint32_t channels_of(std::span<const TexturedSurface> surfaces) {
  std::uint32_t channels = 3;
  for (const TexturedSurface& surface : surfaces) {
    if (surface.image != nullptr)
      channels = std::max(channels, surface.image->channels);
  }
  return channels;
}

/// Takes the colours of samples from finer surfaces.
class Painter {
 public:
  Painter(const ChartedTile& tile, std::span<const TexturedSurface> finer)
      : samples_(tile.samples),
        texel_(1 / samples_.layout().density),
        finer_(tile.finer),
        points_(tile.points),
        sampler_(finer, texel_),
        channels_(channels_of(finer)) {}

  images::Image paint() {
    const ChartLayout& layout = samples_.layout();
    TexelMeans means(layout.width, layout.height);
    for (const ChartPlane& plane : layout.planes) {
      measure(plane, means);
      if (!plane.is_point)
        fit_texels(means, TexelSamples::range_of(plane));
    }
    return stored(means, layout.height);
  }

  /// How large a pixel is that shows what the finer surfaces do, but for the least visible
  /// difference.
  double lost(const images::Image& image) {
    Difference difference;
    for (const ChartPlane& plane : samples_.layout().planes) {
      for (std::uint32_t y = plane.top + kBakeGutter; y + 1 < plane.bottom; y += kLostStep) {
        for (std::uint32_t x = plane.left + kBakeGutter; x + 1 < plane.right; x += kLostStep)
          compare(plane, x, y, image, difference);
      }
    }
    return texel_ * difference.mean() / kLeastVisible;
  }

 private:
  /// One in so many texels along each side of a picture is compared.
  static constexpr std::uint32_t kLostStep = 4;
  /// The least visible difference of 8-bit values: 32 decibels.
  static constexpr double kLeastVisible = 6.4;

  /// A mean square of differences.
  struct Difference {
    double squares = 0, count = 0;
    void add(const std::uint8_t* a, const std::uint8_t* b) {
      for (std::size_t k = 0; k < 3; ++k)
        squares += double(a[k] - b[k]) * (a[k] - b[k]);
      count += 3;
    }
    double mean() const { return count > 0 ? std::sqrt(squares / count) : 0; }
  };

  void measure(const ChartPlane& plane, TexelMeans& means) {
    for_each_texel(TexelSamples::range_of(plane), [&](std::uint32_t x, std::uint32_t y) {
      const std::size_t number = samples_.index(x, y);
      if (number + kAhead < points_.size())
        sampler_.prefetch(points_[number + kAhead]);
      if (points_[number].triangle == FinerPoint::kNone)
        return;
      means.lights[number] = sampler_.around(points_[number]);
      means.is_known[number] = 1;
    });
  }

  images::Image stored(const TexelMeans& means, std::uint32_t height) const {
    images::Image image(means.width, height, channels_);
    for (std::size_t i = 0; i < means.lights.size(); ++i) {
      if (means.is_known[i] != 0)
        store_texel(means.lights[i], image.texels.data() + i * channels_, channels_);
    }
    fill_blocks(image, means.is_known);
    return image;
  }

  /// A pixel amid four texels shows the mean of them.
  void compare(const ChartPlane& plane, std::uint32_t x, std::uint32_t y,
               const images::Image& image, Difference& difference) {
    const auto amid = finer_.amid_texels(samples_, TexelSamples::range_of(plane), points_, x, y);
    if (!amid || amid->finer.triangle == FinerPoint::kNone)
      return;
    TexelLight shown{};
    for (const auto& [i, j] : four_texels(x, y))
      add_texel(shown, image.at(i, j), channels_, 0.25f);
    std::array<std::uint8_t, 4> own{}, finer{};
    store_texel(shown, own.data(), channels_);
    store_texel(sampler_.pixel(amid->finer), finer.data(), channels_);
    difference.add(own.data(), finer.data());
  }

  const TexelSamples& samples_;
  double texel_;
  const FinerSurfaces& finer_;
  const std::span<const FinerPoint> points_;
  TexelSampler sampler_;
  std::uint32_t channels_;
};

}  // namespace

BakedTexture bake(const ChartedTile& tile, std::span<const TexturedSurface> finer) {
  const TexelSamples& samples = tile.samples;
  Painter painter(tile, finer);
  BakedTexture baked;
  baked.image = painter.paint();
  baked.corners = tile.distinct.expanded(samples.texcoords());
  baked.texel = static_cast<float>(1 / samples.layout().density);
  baked.lost = static_cast<float>(painter.lost(baked.image));
  baked.charts = static_cast<std::uint32_t>(samples.layout().planes.size());
  return baked;
}

float texel_size(const TexturedSurface& surface, std::uint32_t width, std::uint32_t height) {
  double area = 0, texels = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) {
      return to_double(surface.positions[raw(surface.triangles[t][k])]);
    };
    area += length(cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
    texels += area_of(surface.corners[t]) * width * height;
  }
  return area > 0 && texels > 0 ? static_cast<float>(std::sqrt(area / texels)) : 0;
}

}  // namespace meshhier::texture

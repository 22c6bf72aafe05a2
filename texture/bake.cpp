#include "texture/bake.h"

#include "hierarchy/bounds.h"
#include "texture/fill.h"
#include "texture/nearest_triangle.h"
#include "texture/texel_fit.h"
#include "texture/texel_light.h"
#include "texture/texel_sampler.h"
#include "texture/texel_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace meshhier::texture {
namespace {

/// How far a surface that faces alike may be, in texels, so that it is taken before a nearer one
/// that does not.
constexpr double kReach = 32;

/// The triangles of several surfaces, numbered through.
NearestTriangle joined(std::span<const TexturedSurface> surfaces, std::span<const Vec3f> tile) {
  std::vector<NearestTriangle::Corners> triangles;
  for (const TexturedSurface& surface : surfaces) {
    for (const TileTriangle& t : surface.triangles)
      triangles.push_back({surface.positions[raw(t[0])], surface.positions[raw(t[1])],
                           surface.positions[raw(t[2])]});
  }
  const Bounds box = bounds_of(tile);
  const Vec3d low = to_double(box.min), high = to_double(box.max);
  const double size = length(high - low);
  return {triangles, (low + high) * 0.5, size > 0 ? size : 1};
}

std::uint32_t channels_of(std::span<const TexturedSurface> surfaces) {
  std::uint32_t channels = 3;
  for (const TexturedSurface& surface : surfaces) {
    if (surface.image != nullptr)
      channels = std::max(channels, surface.image->channels);
  }
  return channels;
}

/// Triangles, each once.
class DistinctTriangles {
 public:
  explicit DistinctTriangles(std::span<const TileTriangle> all) : number_(all.size()) {
    std::vector<std::uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return all[a] != all[b] ? all[a] < all[b] : a < b;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool again = i > 0 && all[order[i]] == all[order[i - 1]];
      number_[order[i]] = again ? number_[order[i - 1]] : order[i];
    }
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      if (number_[t] == t) {
        number_[t] = static_cast<std::uint32_t>(triangles_.size());
        triangles_.push_back(all[t]);
      } else {
        number_[t] = number_[number_[t]];  // of the first, which came before
      }
    }
  }
  std::span<const TileTriangle> triangles() const { return triangles_; }
  /// Of all triangles, from one entry for each distinct one.
  std::vector<CornerTexcoords> expanded(const std::vector<CornerTexcoords>& of_distinct) const {
    std::vector<CornerTexcoords> all;
    all.reserve(number_.size());
    for (const std::uint32_t number : number_)
      all.push_back(of_distinct[number]);
    return all;
  }

 private:
  std::vector<std::uint32_t> number_;  ///< in triangles_, of each triangle
  std::vector<TileTriangle> triangles_;
};

/// Takes the colours of samples from finer surfaces.
class Painter {
 public:
  Painter(const TexelSamples& samples, std::span<const TexturedSurface> finer,
          std::span<const Vec3f> tile)
      : samples_(samples),
        texel_(1 / samples.layout().density),
        nearest_(joined(finer, tile)),
        sampler_(finer, texel_),
        channels_(channels_of(finer)) {}

  images::Image paint() {
    const ChartLayout& layout = samples_.layout();
    TexelMeans means(layout.width, layout.height);
    for (const ChartPlane& plane : layout.planes) {
      measure(plane, means);
      if (!plane.is_point)
        fit_texels(means, range_of(plane));
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
  /// Texels of a block along each side.
  static constexpr std::uint32_t kBlock = 8;
  /// What is compared of a picture: one in so many texels along each side.
  static constexpr std::uint32_t kLostStep = 4;
  /// Of 8-bit values: 32 decibels.
  static constexpr double kLeastVisible = 6.4;

  /// Of values, the mean square.
  struct Difference {
    double squares = 0, count = 0;
    void add(const std::uint8_t* a, const std::uint8_t* b) {
      for (std::size_t k = 0; k < 3; ++k)
        squares += double(a[k] - b[k]) * (a[k] - b[k]);
      count += 3;
    }
    double mean() const { return count > 0 ? std::sqrt(squares / count) : 0; }
  };

  static TexelRange range_of(const ChartPlane& plane) {
    return {plane.left, plane.top, plane.right, plane.bottom};
  }

  /// Block by block of texels, which have much around them in common.
  void measure(const ChartPlane& plane, TexelMeans& means) {
    for (std::uint32_t top = plane.top; top < plane.bottom; top += kBlock) {
      for (std::uint32_t left = plane.left; left < plane.right; left += kBlock) {
        const TexelRange block{left, top, std::min(left + kBlock, plane.right),
                               std::min(top + kBlock, plane.bottom)};
        look_around(block);
        measure(plane, block, means);
      }
    }
  }

  void measure(const ChartPlane& plane, const TexelRange& block, TexelMeans& means) {
    for (std::uint32_t y = block.top; y < block.bottom; ++y) {
      for (std::uint32_t i = block.left; i < block.right; ++i) {
        // To and fro: each texel is beside the last one.
        const std::uint32_t x = (y - block.top) % 2 == 0 ? i : block.left + block.right - 1 - i;
        const std::size_t number = std::size_t{y} * means.width + x;
        const TexelSample& sample = samples_.at(x, y);
        if (sample.triangle == kNoFace || means.is_known[number] != 0)
          continue;
        if (const NearestTriangle::Found found = find(plane, sample, sample.point);
            found.triangle != NearestTriangle::kNone) {
          means.lights[number] = sampler_.around(found);
          means.is_known[number] = 1;
        }
      }
    }
  }

  void look_around(const TexelRange& block) {
    BoundsD box;
    for (std::uint32_t y = block.top; y < block.bottom; ++y) {
      for (std::uint32_t x = block.left; x < block.right; ++x) {
        const TexelSample& sample = samples_.at(x, y);
        if (sample.triangle != kNoFace)
          box.add(sample.point);
      }
    }
    if (!box.empty())
      nearest_.look_around(box);
  }

  NearestTriangle::Found find(const ChartPlane& plane, const TexelSample& sample,
                              const Vec3d& point) {
    return nearest_(point, samples_.facing(plane, sample), kReach * texel_);
  }

  images::Image stored(const TexelMeans& means, std::uint32_t height) const {
    images::Image image(means.width, height, channels_);
    for (std::size_t i = 0; i < means.lights.size(); ++i) {
      if (means.is_known[i] != 0)
        store_texel(means.lights[i], image.texels.data() + i * channels_, channels_);
    }
    fill_unknown(image, means.is_known);
    return image;
  }

  /// A pixel amid four texels shows the mean of them.
  void compare(const ChartPlane& plane, std::uint32_t x, std::uint32_t y,
               const images::Image& image, Difference& difference) {
    Vec3d point;
    Light shown{};
    for (const auto& [i, j] : {std::pair(x, y), {x + 1, y}, {x, y + 1}, {x + 1, y + 1}}) {
      if (!samples_.at(i, j).is_inside())
        return;
      point = point + samples_.at(i, j).point * 0.25;
      add_texel(shown, image.at(i, j), channels_, 0.25f);
    }
    const NearestTriangle::Found found = find(plane, samples_.at(x, y), point);
    if (found.triangle == NearestTriangle::kNone)
      return;
    std::array<std::uint8_t, 4> own{}, finer{};
    store_texel(shown, own.data(), channels_);
    store_texel(sampler_.pixel(found), finer.data(), channels_);
    difference.add(own.data(), finer.data());
  }

  const TexelSamples& samples_;
  double texel_;
  NearestTriangle nearest_;
  TexelSampler sampler_;
  std::uint32_t channels_;
};

}  // namespace

BakedTexture bake(const TexturedSurface& tile, std::span<const TexturedSurface> finer,
                  const BakeSize& size) {
  if (tile.triangles.empty())
    return {};
  const DistinctTriangles distinct(tile.triangles);
  TexturedSurface surface = tile;
  surface.triangles = distinct.triangles();
  const TexelSamples samples(surface, size);
  Painter painter(samples, finer, tile.positions);
  BakedTexture baked;
  baked.image = painter.paint();
  baked.corners = distinct.expanded(samples.texcoords());
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

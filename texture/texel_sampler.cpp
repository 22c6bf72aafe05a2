#include "texture/texel_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace meshhier::texture {
namespace {

/// Pictures are taken at a half and a quarter, as far as charts are aligned for sure: where the
/// texels asked for are wider than so many of a picture.
constexpr std::uint32_t kHalvings = 2;
constexpr double kWidestWhole = 2.5;
constexpr float kMostSize = 4;
/// A tent of so much of a pixel's size has its spread.
constexpr float kPixel = 0.7f;
constexpr std::uint32_t kLanes = 4;
constexpr std::uint32_t kMostTaps = 12;
static_assert(kMostTaps >= 2 * kMostSize + 1 && kMostTaps % kLanes == 0);

/// The radius of a tent over a picture whose texels are tents as well: squares add up. But beyond
/// two texels, which charts have around them, it is no wider than it must be.
float with_own_filter(float radius) {
  constexpr float kGutter = 2;
  return std::max(radius, std::min(std::sqrt(radius * radius + 1), kGutter));
}

/// Tents of one radius have no more texels along an axis.
std::uint32_t most_texels(float radius) {
  constexpr float kRounding = 1.0f / 32;
  return static_cast<std::uint32_t>(2 * radius + kRounding) + 1;
}

/// The texels of a row that a tent has, with their weights: as many as a tent of its radius may
/// have, the last ones without a weight, so that loops over them have one length.
struct Taps {
  std::uint32_t first = 0, count = 0;
  std::array<float, kMostTaps> weights;
  float sum = 0;  ///< of the weights

  Taps(float at, float radius, std::uint32_t side) : count(most_texels(radius)) {
    const auto most = static_cast<float>(side - 1);
    at = at > 0.5f ? std::min(at - 0.5f, most) : 0;
    first = not_below(std::max(at - radius, 0.0f));
    const std::uint32_t own = static_cast<std::uint32_t>(std::min(at + radius, most)) + 1 - first;
    FourFloats sums{};
    for (std::uint32_t i = 0; i < count; i += kLanes) {
      const FourFloats weight = tent(static_cast<float>(first + i) - at, radius, own, i);
      store_four(weights.data() + i, weight);
      sums += weight;
    }
    sum = sum_of(sums);
    if (first + count > side)
      move_inside(own, side);
  }

 private:
  static std::uint32_t not_below(float value) {
    const auto below = static_cast<std::uint32_t>(value);
    return below + (static_cast<float>(below) < value ? 1 : 0);
  }
  /// The weights of texels from `off` on beside the middle; those from `own` on have none.
  static FourFloats tent(float off, float radius, std::uint32_t own, std::uint32_t begin) {
    const FourFloats away = FourFloats{0, 1, 2, 3} + off;
    const FourFloats weight = radius - (away < 0 ? -away : away);
    const FourFloats none{};
    const auto left = static_cast<std::int32_t>(own) - static_cast<std::int32_t>(begin);
    return (weight > none) & first_lanes(left) ? weight : none;
  }
  /// Begins earlier where a row ends.
  void move_inside(std::uint32_t own, std::uint32_t side) {
    count = std::min(count, side);
    const std::uint32_t earlier = first + count - side;
    std::copy_backward(weights.begin(), weights.begin() + own, weights.begin() + own + earlier);
    std::fill_n(weights.begin(), earlier, 0.0f);
    first -= earlier;
  }
};

/// `kCount`: of the taps, if both have so many; 0: any number.
template <std::uint32_t kChannels, std::uint32_t kCount>
FourFloats weighted_sum(const images::Image& picture, const Taps& columns, const Taps& rows) {
  const std::uint32_t width = kCount > 0 ? kCount : columns.count;
  const std::uint32_t height = kCount > 0 ? kCount : rows.count;
  FourFloats sum{};
  for (std::uint32_t j = 0; j < height; ++j) {
    const std::uint8_t* texel = picture.at(columns.first, rows.first + j);
    FourFloats row{};
#pragma GCC unroll 8
    for (std::uint32_t i = 0; i < width; ++i, texel += kChannels)
      row += weighted_light(texel, kChannels, columns.weights[i]);
    sum += row * rows.weights[j];
  }
  return sum;
}

template <std::uint32_t kChannels>
FourFloats mix(const images::Image& picture, const Taps& columns, const Taps& rows) {
  const auto sum = [&] {
    switch (columns.count == rows.count ? columns.count : 0) {
      case 3:
        return weighted_sum<kChannels, 3>(picture, columns, rows);
      case 4:
        return weighted_sum<kChannels, 4>(picture, columns, rows);
      case 5:
        return weighted_sum<kChannels, 5>(picture, columns, rows);
      case 6:
        return weighted_sum<kChannels, 6>(picture, columns, rows);
      default:
        return weighted_sum<kChannels, 0>(picture, columns, rows);
    }
  };
  return sum() * (1 / (columns.sum * rows.sum));
}

}  // namespace

TexelSampler::TexelSampler(std::span<const TexturedSurface> surfaces, double texel) {
  std::size_t count = 0;
  for (const TexturedSurface& surface : surfaces)
    count += surface.triangles.size();
  spots_.reserve(count);
  smaller_.reserve(surfaces.size() * kHalvings);
  for (const TexturedSurface& surface : surfaces) {
    if (surface.triangles.empty())
      continue;
    const images::Image& picture = *surface.image;
    std::array<std::uint32_t, kHalvings + 1> levels;
    levels.fill(~std::uint32_t{0});
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const CornerTexcoords& at = surface.corners[t];
      const auto corner = [&](std::size_t k) {
        return to_double(surface.positions[raw(surface.triangles[t][k])]);
      };
      const Vec3d normal = cross(corner(1) - corner(0), corner(2) - corner(0));
      const double covered = area_of(at) * picture.width * picture.height;
      const double size = length(normal) / 2;
      double wide = std::max(1.0, size > 0 ? texel * std::sqrt(covered / size) : 1);
      std::uint32_t level = 0;
      while (wide >= kWidestWhole && level < kHalvings && picture.width % (2U << level) == 0 &&
             picture.height % (2U << level) == 0) {
        wide /= 2;
        ++level;
      }
      if (levels[level] == ~std::uint32_t{0}) {
        levels[level] = static_cast<std::uint32_t>(pictures_.size());
        if (level > 0)
          smaller_.push_back(reduced(picture, surface.corners, 1U << level));
        pictures_.push_back(level > 0 ? &smaller_.back() : &picture);
      }
      const images::Image& used = *pictures_[levels[level]];
      const auto x = [&](std::size_t k) { return float(double(at[k].u) * used.width); };
      const auto y = [&](std::size_t k) { return float(double(at[k].v) * used.height); };
      const auto asked = static_cast<float>(std::min<double>(wide, kMostSize));
      spots_.push_back({x(0), y(0), x(1) - x(0), y(1) - y(0), x(2) - x(0), y(2) - y(0),
                        with_own_filter(asked), with_own_filter(kPixel * asked), levels[level]});
    }
  }
}

TexelLight TexelSampler::mean(const FinerPoint& at, float Spot::*radius) const {
  const Spot& spot = spots_[at.triangle];
  const images::Image& picture = *pictures_[spot.picture];
  const auto b = static_cast<float>(at.on_b), c = static_cast<float>(at.on_c);
  const Taps columns(spot.x + b * spot.bx + c * spot.cx, spot.*radius, picture.width);
  const Taps rows(spot.y + b * spot.by + c * spot.cy, spot.*radius, picture.height);
  TexelLight light;
  store_four(&light, picture.channels == 4 ? mix<4>(picture, columns, rows)
                                           : mix<3>(picture, columns, rows));
  return light;
}

}  // namespace meshhier::texture

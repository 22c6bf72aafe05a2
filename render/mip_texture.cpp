#include "render/mip_texture.h"

#include "images/pyramid.h"
#include "images/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace meshhier::render {
namespace {

images::Image without_alpha(images::Image picture) {
  if (picture.channels == 3)
    return picture;
  images::Image opaque(picture.width, picture.height, 3);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x)
      std::copy_n(picture.at(x, y), 3, opaque.at(x, y));
  }
  return opaque;
}

images::Image halved(const images::Image& picture) {
  images::Image half((picture.width + 1) / 2, (picture.height + 1) / 2, 3);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    const std::uint32_t below = std::min(2 * y + 1, picture.height - 1);
    images::halve_rows(picture.at(0, 2 * y), picture.at(0, below), picture.width, 3, half.at(0, y));
  }
  return half;
}

/// 0 to 1.
double within_picture(float coordinate, Wrap wrap) {
  const double at = std::isfinite(coordinate) ? coordinate : 0;
  if (wrap == Wrap::clamp)
    return std::clamp(at, 0.0, 1.0);
  if (wrap == Wrap::repeat)
    return at - std::floor(at);
  const double in_two = at - 2 * std::floor(at / 2);
  return in_two <= 1 ? in_two : 2 - in_two;
}

/// Of a row or column next to a place in the picture: at most one beyond its border.
std::uint32_t wrapped(std::int64_t texel, std::uint32_t count, Wrap wrap) {
  if (wrap == Wrap::repeat)
    return static_cast<std::uint32_t>((texel + count) % count);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(texel, 0, count - std::int64_t{1}));
}

/// Two texels side by side, and the share of the second one.
struct TexelPair {
  std::array<std::uint32_t, 2> texels{};
  double share = 0;
};

/// `size`: of the whole picture in texels of the level, whose last one may reach beyond it.
TexelPair pair_at(double coordinate, double size, std::uint32_t count, Wrap wrap) {
  const double at = coordinate * size - 0.5, first = std::floor(at);
  const auto texel = static_cast<std::int64_t>(first);
  return {{wrapped(texel, count, wrap), wrapped(texel + 1, count, wrap)}, at - first};
}

Vec3d light_of_texel(const images::LightTable& table, const std::uint8_t* texel) {
  const auto light = [&](std::size_t c) { return static_cast<double>(table.light(texel[c])); };
  return {light(0), light(1), light(2)};
}

Vec3d mix(Vec3d a, Vec3d b, double share) {
  return a + (b - a) * share;
}

}  // namespace

MipTexture::MipTexture(images::Image picture, Wraps wraps) : wraps_(wraps) {
  levels_.push_back(without_alpha(std::move(picture)));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(halved(levels_.back()));
}

Vec3f MipTexture::light_at(Vec2f texcoord, double level) const {
  const double most = static_cast<double>(levels_.size() - 1);
  const double at = std::isfinite(level) ? std::clamp(level, 0.0, most) : 0;
  const auto finer = static_cast<std::uint32_t>(at);
  const Vec3d light = light_on(finer, texcoord);
  const double share = at - finer;
  return to_float(share > 0 ? mix(light, light_on(finer + 1, texcoord), share) : light);
}

Vec3d MipTexture::light_on(std::uint32_t level, Vec2f texcoord) const {
  const images::Image& image = levels_[level];
  const images::LightTable& table = images::LightTable::get();
  const double scale = 1.0 / static_cast<double>(std::uint64_t{1} << level);
  const TexelPair across =
      pair_at(within_picture(texcoord.u, wraps_.u), width() * scale, image.width, wraps_.u);
  const TexelPair down =
      pair_at(within_picture(texcoord.v, wraps_.v), height() * scale, image.height, wraps_.v);
  const auto row = [&](std::uint32_t y) {
    return mix(light_of_texel(table, image.at(across.texels[0], y)),
               light_of_texel(table, image.at(across.texels[1], y)), across.share);
  };
  return mix(row(down.texels[0]), row(down.texels[1]), down.share) * (1.0 / 65535);
}

double level_for(double texels_a_sample) {
  if (!(texels_a_sample > 1) || !std::isfinite(texels_a_sample))
    return 0;
  int exponent = 0;
  const double part = std::frexp(texels_a_sample, &exponent);  // 0.5 to 1
  return 0.5 * (exponent - 1 + (2 * part - 1));
}

}  // namespace meshhier::render

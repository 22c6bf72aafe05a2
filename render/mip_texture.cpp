#include "render/mip_texture.h"

#include "base/srgb.h"
#include "images/pyramid.h"

#include <algorithm>
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
  images::Image half((picture.width + 1) / 2, (picture.height + 1) / 2, picture.channels);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    const std::uint32_t below = std::min(2 * y + 1, picture.height - 1);
    images::halve_rows(picture.at(0, 2 * y), picture.at(0, below), picture.width, picture.channels,
                       half.at(0, y));
  }
  return half;
}

/// The same of numbers: a mean of four.
images::Image halved_numbers(const images::Image& picture) {
  images::Image half((picture.width + 1) / 2, (picture.height + 1) / 2, picture.channels);
  const std::uint32_t channels = picture.channels;
  for (std::uint32_t y = 0; y < half.height; ++y) {
    const std::uint8_t* above = picture.at(0, 2 * y);
    const std::uint8_t* below = picture.at(0, std::min(2 * y + 1, picture.height - 1));
    std::uint8_t* to = half.at(0, y);
    for (std::uint32_t x = 0; x < half.width; ++x) {
      const std::size_t beside = 2 * x + 1 < picture.width ? channels : 0;
      for (std::size_t c = 0, at = std::size_t{2} * x * channels; c < channels; ++c, ++at) {
        const int sum = above[at] + above[at + beside] + below[at] + below[at + beside];
        *to++ = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
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

/// The row or column in the picture for one that is at most one beyond its border.
std::uint32_t wrapped(std::int64_t texel, std::uint32_t count, Wrap wrap) {
  if (wrap == Wrap::repeat)
    return static_cast<std::uint32_t>((texel + count) % count);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(texel, 0, count - std::int64_t{1}));
}

/// `size`: of the whole picture in texels of the level, whose last one may reach beyond it.
MipTexture::TexelPair pair_at(double coordinate, double size, std::uint32_t count, Wrap wrap) {
  const double at = coordinate * size - 0.5;
  auto texel = static_cast<std::int64_t>(at);
  texel -= static_cast<double>(texel) > at ? 1 : 0;  // std::floor() is a call
  return {{wrapped(texel, count, wrap), wrapped(texel + 1, count, wrap)},
          at - static_cast<double>(texel)};
}

/// 0 to 65535.
Vec3d number_of_texel(const std::uint8_t* texel) {
  return Vec3d{double(texel[0]), double(texel[1]), double(texel[2])} * 257;
}
Vec3d light_of_texel(const LightTable& table, const std::uint8_t* texel) {
  const auto light = [&](std::size_t c) { return static_cast<double>(table.light(texel[c])); };
  return {light(0), light(1), light(2)};
}

template <class Value>
Value mix(Value a, Value b, double share) {
  return a + (b - a) * share;
}

/// A texture's levels on both sides of one that is no whole number.
struct LevelPair {
  std::uint32_t finer = 0;
  double share = 0;  ///< of the next one
};

LevelPair levels_at(double level, std::size_t count) {
  const double most = static_cast<double>(count - 1);
  const double at = std::isfinite(level) ? std::clamp(level, 0.0, most) : 0;
  const auto finer = static_cast<std::uint32_t>(at);
  return {finer, at - finer};
}

}  // namespace

MipTexture::MipTexture(images::Image picture, Wraps wraps, AlphaMode alpha, TexelKind kind)
    : wraps_(wraps), alpha_(picture.channels == 4 ? alpha : AlphaMode::opaque), kind_(kind) {
  levels_.push_back(alpha_ == AlphaMode::opaque ? without_alpha(std::move(picture))
                                                : std::move(picture));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(kind == TexelKind::light ? halved(levels_.back())
                                               : halved_numbers(levels_.back()));
}

Vec3f MipTexture::light_at(Vec2f texcoord, double level) const {
  const auto [finer, share] = levels_at(level, levels_.size());
  const Vec3d light = light_on(finer, texcoord);
  return to_float(share > 0 ? mix(light, light_on(finer + 1, texcoord), share) : light);
}

bool MipTexture::is_seen_at(Vec2f texcoord, double level, double threshold) const {
  constexpr double kCutoff = 0.5;  // of glTF, unless a material says another one
  if (alpha_ == AlphaMode::opaque)
    return true;
  const auto [finer, share] = levels_at(level, levels_.size());
  double alpha = alpha_on(finer, texcoord);
  if (share > 0)
    alpha = mix(alpha, alpha_on(finer + 1, texcoord), share);
  return alpha_ == AlphaMode::mask ? alpha >= kCutoff : alpha > threshold;
}

MipTexture::TexelSquare MipTexture::square_on(std::uint32_t level, Vec2f texcoord) const {
  const images::Image& image = levels_[level];
  const double scale = 1.0 / static_cast<double>(std::uint64_t{1} << level);
  return {pair_at(within_picture(texcoord.u, wraps_.u), width() * scale, image.width, wraps_.u),
          pair_at(within_picture(texcoord.v, wraps_.v), height() * scale, image.height, wraps_.v)};
}

/// Mixes the four; `texel`: what one of them stands for.
template <class Texel>
Vec3d MipTexture::mixed(const images::Image& image, const TexelSquare& square, const Texel& texel) {
  const auto& [across, down] = square;
  const auto row = [&, &across = across](std::uint32_t y) {
    return mix(texel(image.at(across.texels[0], y)), texel(image.at(across.texels[1], y)),
               across.share);
  };
  return mix(row(down.texels[0]), row(down.texels[1]), down.share) * (1.0 / 65535);
}

Vec3d MipTexture::light_on(std::uint32_t level, Vec2f texcoord) const {
  const images::Image& image = levels_[level];
  const TexelSquare square = square_on(level, texcoord);
  if (kind_ == TexelKind::numbers)
    return mixed(image, square, number_of_texel);
  const LightTable& table = LightTable::get();
  return mixed(image, square,
               [&](const std::uint8_t* texel) { return light_of_texel(table, texel); });
}

double MipTexture::alpha_on(std::uint32_t level, Vec2f texcoord) const {
  const images::Image& image = levels_[level];
  const auto [across, down] = square_on(level, texcoord);
  const auto row = [&, &across = across](std::uint32_t y) {
    return mix<double>(image.at(across.texels[0], y)[3], image.at(across.texels[1], y)[3],
                       across.share);
  };
  return mix(row(down.texels[0]), row(down.texels[1]), down.share) * (1.0 / 255);
}

double level_for(double texels_a_sample) {
  if (!(texels_a_sample > 1) || !std::isfinite(texels_a_sample))
    return 0;
  int exponent = 0;
  const double part = std::frexp(texels_a_sample, &exponent);  // 0.5 to 1
  return 0.5 * (exponent - 1 + (2 * part - 1));
}

}  // namespace meshhier::render

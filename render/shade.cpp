#include "render/shade.h"

#include "base/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace meshhier::render {
namespace {

/// Samples of a pixel that lie farther apart, in its sides, are of two surfaces.
constexpr double kFarApart = 4;

/// How a normal turns from one pixel to the next, to the right and up.
struct Turn {
  Vec3d right, up;
};

double smooth_step(double from, double to, double value) {
  const double part = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return part * part * (3 - 2 * part);
}

/// The samples of a pixel, row by row.
class Pixel {
 public:
  /// `row`: of those that the raster has.
  Pixel(const Raster& raster, std::size_t column, std::size_t row)
      : raster_(raster),
        side_(raster.framing().samples),
        first_(row * side_ * raster.columns() + column * side_) {}

  std::span<const Sample> row(std::size_t y) const {
    return raster_.samples().subspan(first_ + y * raster_.columns(), side_);
  }
  std::size_t side() const { return side_; }

  /// It covers all of it.
  bool is_of_one_surface() const {
    float nearest = row(0)[0].depth, farthest = nearest;
    for (std::size_t y = 0; y < side_; ++y) {
      for (const Sample& sample : row(y)) {
        if (!sample.covered())
          return false;
        nearest = std::min(nearest, sample.depth);
        farthest = std::max(farthest, sample.depth);
      }
    }
    return farthest - nearest <= kFarApart * static_cast<double>(side_);
  }

  /// In its middle. Requires that it is of one surface.
  Sample middle() const {
    Vec3d normal, colour;
    for (std::size_t y = 0; y < side_; ++y) {
      for (const Sample& sample : row(y)) {
        normal = normal + to_double(sample.normal);
        colour = colour + to_double(sample.colour);
      }
    }
    const double part = 1.0 / static_cast<double>(side_ * side_);
    return {row(0)[0].depth, unit_or_zero(to_float(normal)), to_float(colour * part)};
  }

  /// Requires likewise.
  Turn turn() const {
    if (side_ < 2)
      return {};
    Turn turn;
    for (std::size_t i = 0; i < side_; ++i) {
      turn.right = turn.right + to_double(row(i).back().normal) - to_double(row(i).front().normal);
      turn.up = turn.up + to_double(row(0)[i].normal) - to_double(row(side_ - 1)[i].normal);
    }
    const double a_pixel = 1.0 / static_cast<double>(side_ - 1);  // a mean of `side_` of them
    return {turn.right * a_pixel, turn.up * a_pixel};
  }

 private:
  const Raster& raster_;
  std::size_t side_;
  std::size_t first_;
};

/// Hollows are darker, edges lighter: away from itself the normal turns over an edge, towards
/// itself in a hollow. Along silhouettes neither is seen.
double crease(const Turn& turn, double facing) {
  const double bend = (turn.right.x + turn.up.y) * smooth_step(0.4, 0.8, std::abs(facing));
  return std::clamp(1 + 1.8 * bend, 0.5, 1.4);
}

/// A surface that turns within a pixel mirrors in more directions: it looks rougher.
double rougher(const Turn& turn, double roughness) {
  double most = 0;
  for (const Vec3d& side : {turn.right, turn.up})
    most = std::max({most, std::abs(side.x), std::abs(side.y), std::abs(side.z)});
  return std::min(roughness + most, 1.0);
}

Vec3d lit(const Sample& sample, const Turn& turn, const Lighting& lighting) {
  if (lighting.kind == Light::none)
    return to_double(sample.colour);
  const Vec3d normal = to_double(sample.normal);
  const Vec3d colour =
      to_double(sample.colour) * (lighting.has_cavities ? crease(turn, normal.z) : 1);
  return reflected({normal, colour, rougher(turn, lighting.roughness)}, lighting.rig);
}

/// The samples of a pixel.
struct PixelSum {
  Vec3d light;
  std::uint32_t covered = 0;
};

PixelSum sum_of(const Pixel& pixel, const Lighting& lighting) {
  if (lighting.kind == Light::lamps && pixel.is_of_one_surface()) {
    const auto samples = static_cast<std::uint32_t>(pixel.side() * pixel.side());
    return {lit(pixel.middle(), pixel.turn(), lighting) * samples, samples};
  }
  PixelSum sum;
  for (std::size_t y = 0; y < pixel.side(); ++y) {
    for (const Sample& sample : pixel.row(y)) {
      if (!sample.covered())
        continue;
      sum.light = sum.light + lit(sample, {}, lighting);
      ++sum.covered;
    }
  }
  return sum;
}

void put(const PixelSum& sum, std::uint32_t samples, Light kind, std::uint8_t* texel) {
  const Vec3d mean = sum.covered > 0 ? sum.light * (1.0 / sum.covered) : Vec3d{};
  const Vec3d shown = kind == Light::none ? mean : toned(mean);
  for (const double light : {shown.x, shown.y, shown.z})
    *texel++ = screen_value(light);
  *texel = static_cast<std::uint8_t>((255 * sum.covered + samples / 2) / samples);
}

}  // namespace

images::Image shade(const Raster& raster, const Lighting& lighting) {
  const Framing& framing = raster.framing();
  images::Image picture(framing.width, raster.pixel_rows().count, 4);
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    for (std::uint32_t column = 0; column < framing.width; ++column)
      put(sum_of(Pixel(raster, column, row), lighting), framing.samples * framing.samples,
          lighting.kind, picture.at(column, row));
  }
  return picture;
}

}  // namespace meshhier::render

#include "bench/solid_paint.h"

#include "bench/noise.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace meshhier::bench {
namespace {

/// The longest wave: about half of a shape, which fits [-1, 1]^3.
constexpr double kLongestWave = 1;
/// Height of an octave relative to the one before: photographs keep about so much.
constexpr double kGain = 0.88;
/// The heights of all octaves sum up to this: no colour leaves 0 to 255.
constexpr double kLightHeight = 72, kTintHeight = 36;
/// Added to phases, so that they are positive where a point may lie (a whole number of cycles; at
/// most 4 * sqrt(3) / finest_wave are needed).
constexpr double kCyclesAhead = 1 << 22;

/// A direction, evenly spread over the sphere but for rounding: a point of a ball, normalised.
Vec3d direction_at(std::uint64_t seed, std::uint64_t item) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    const std::uint64_t first = (item << 16) + 3 * attempt;
    const Vec3d p{signed_unit(random_at(seed, first)), signed_unit(random_at(seed, first + 1)),
                  signed_unit(random_at(seed, first + 2))};
    const double size = length(p);
    if (size > 0.1 && size <= 1)
      return p * (1 / size);
  }
}

/// Returns nearly sin(2 pi t), for t >= 0, from parabolas.
float wave_at(double t) {
  const auto whole = static_cast<std::int32_t>(t);
  const auto f = static_cast<float>(t - whole) - 0.5F;
  return f * (16 * std::fabs(f) - 8);
}

/// Points are painted in blocks of this many: compilers make vector instructions of loops whose
/// length they know.
constexpr std::size_t kPaintBlock = 32;

struct PaintBlock {
  std::array<double, kPaintBlock> x{}, y{}, z{};
  std::array<std::array<float, kPaintBlock>, 3> sums{};
};

}  // namespace

SolidPaint::SolidPaint(const Options& options) {
  double height = 1 - kGain;
  std::uint64_t item = 0;
  const auto add = [&](double cycles, double red, double green, double blue) {
    const double phase = uniform_at(options.seed ^ 0x7068617365, item);
    waves_.push_back(
        {direction_at(options.seed, item) * cycles,
         phase + kCyclesAhead,
         {static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)}});
    ++item;
  };
  for (double wave = kLongestWave; wave >= options.finest_wave; wave /= 2) {
    const double light = kLightHeight * height / 2, tint = kTintHeight * height;
    add(1 / wave, light, light, light);
    add(1 / wave, light, light, light);
    add(1 / wave, tint, -tint / 2, -tint / 2);
    add(1 / wave, tint / 4, tint / 2, -tint);
    height *= kGain;
  }
}

void SolidPaint::paint(std::span<const Vec3d> points, std::span<std::uint8_t> colours) const {
  assert(colours.size() == 3 * points.size());
  constexpr float kMiddle = 128;
  PaintBlock block;
  for (std::size_t first = 0; first < points.size(); first += kPaintBlock) {
    const std::size_t count = std::min(kPaintBlock, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      block.x[i] = points[first + i].x;
      block.y[i] = points[first + i].y;
      block.z[i] = points[first + i].z;
    }
    for (auto& sums : block.sums)
      sums.fill(kMiddle);
    for (const Wave& wave : waves_) {
      for (std::size_t i = 0; i < kPaintBlock; ++i) {
        const float height = wave_at(wave.direction.x * block.x[i] + wave.direction.y * block.y[i] +
                                     wave.direction.z * block.z[i] + wave.phase);
        block.sums[0][i] += wave.height[0] * height;
        block.sums[1][i] += wave.height[1] * height;
        block.sums[2][i] += wave.height[2] * height;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = std::clamp(block.sums[c][i], 0.0F, 255.0F) + 0.5F;
        colours[3 * (first + i) + c] = static_cast<std::uint8_t>(value);
      }
    }
  }
}

}  // namespace meshhier::bench

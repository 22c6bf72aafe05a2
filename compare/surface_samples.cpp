#include "compare/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace meshhier::comparing {
namespace {

/// The finalizer of SplitMix64 (Steele, Lea & Flood 2014): every bit of x changes half of the
/// result's.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

/// The three numbers that a sample takes: its place in the stratum, and two within the triangle.
enum class Draw : std::uint64_t { stratum, first, second };

double chance(std::uint64_t stream, std::uint64_t sample, Draw draw) {
  /// Returns a number in [0, 1), with 53 bits.
  const std::uint64_t bits = mix(mix(mix(stream) + sample) + static_cast<std::uint64_t>(draw));
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Returns a point, uniform over the triangle (Turk 1990).
Vec3d point_in(const SurfaceTriangle& triangle, double first, double second) {
  const double root = std::sqrt(first);
  return to_double(triangle[0]) * (1 - root) + to_double(triangle[1]) * (root * (1 - second)) +
         to_double(triangle[2]) * (root * second);
}

/// Bits 0 .. 20 of x moved to places 0, 3, 6 ...
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x001F00000000FFFFU;
  x = (x | x << 16) & 0x001F0000FF0000FFU;
  x = (x | x << 8) & 0x100F00F00F00F00FU;
  x = (x | x << 4) & 0x10C30C30C30C30C3U;
  return (x | x << 2) & 0x1249249249249249U;
}

}  // namespace

SurfaceSampler::SurfaceSampler(const CutSurface& surface, std::uint64_t count, std::uint64_t stream)
    : areas_{0}, count_(count), stream_(stream) {
  for (std::size_t i = 0; i < surface.size(); ++i) {
    areas_.push_back(areas_.back() + surface.facts(i).area);
    if (surface.facts(i).area > 0)
      last_ = i;
  }
  if (!(areas_.back() > 0))
    count_ = 0;
}

/// The area before the place of a sample; ascending with the sample's number.
double SurfaceSampler::target(std::uint64_t sample) const {
  const double place = static_cast<double>(sample) + chance(stream_, sample, Draw::stratum);
  return place / static_cast<double>(count_) * areas_.back();
}

/// The first sample whose target is `area` or more.
std::uint64_t SurfaceSampler::first_from(double area) const {
  std::uint64_t low = 0, high = count_;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (target(middle) < area) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

SampleRange SurfaceSampler::on_tile(std::size_t position) const {
  const std::uint64_t begin = first_from(areas_[position]);
  if (position > last_)
    return {count_, count_};
  // Rounding may put the last sample at the very end of the area.
  return {begin, position == last_ ? count_ : first_from(areas_[position + 1])};
}

std::vector<SurfaceSample> SurfaceSampler::draw(std::size_t position, const TileSurface& tile,
                                                SampleRange range) const {
  std::vector<SurfaceSample> samples;
  samples.reserve(range.size());
  double before = 0;
  std::uint32_t with_area = 0;
  std::uint64_t sample = range.begin;
  const auto place = [&](std::uint32_t triangle) {
    samples.push_back({point_in(tile.triangles[triangle], chance(stream_, sample, Draw::first),
                                chance(stream_, sample, Draw::second)),
                       triangle});
    ++sample;
  };
  for (std::uint32_t i = 0; i < tile.triangles.size() && sample < range.end; ++i) {
    const double area = doubled_area(tile.triangles[i]) / 2;
    if (!(area > 0))
      continue;
    with_area = i;
    before += area;
    // Samples whose places lie in this triangle's part of the line.
    while (sample < range.end && target(sample) - areas_[position] < before)
      place(i);
  }
  while (sample < range.end)  // left by rounding at the end of the tile
    place(with_area);
  return samples;
}

ZCurve::ZCurve(const BoundsD& box)
    : corner_(box.min),
      side_(std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z})) {}

std::uint64_t ZCurve::place_of(Vec3d point) const {
  constexpr double kCells = 0x1FFFFF;
  const auto cell = [this](double from_corner) {
    const double part = side_ > 0 ? std::clamp(from_corner / side_, 0.0, 1.0) : 0;
    return spread_bits(static_cast<std::uint64_t>(part * kCells));
  };
  const Vec3d p = point - corner_;
  return cell(p.x) | cell(p.y) << 1 | cell(p.z) << 2;
}

std::vector<std::uint32_t> curve_order(const std::vector<Vec3d>& points) {
  BoundsD box;
  for (Vec3d p : points)
    box.add(p);
  const ZCurve curve(box);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i)
    keys[i] = {curve.place_of(points[i]), i};
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(),
                 [](const auto& key) { return key.second; });
  return order;
}

}  // namespace meshhier::comparing

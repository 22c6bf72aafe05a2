#include "bench/noise.h"

#include <cmath>

namespace meshhier::bench {
namespace {

/// Weight of the upper lattice neighbour: 6t^5 - 15t^4 + 10t^3 and its derivative (Perlin,
/// Improving Noise, 2002).
struct Blend {
  explicit Blend(double t)
      : weight(t * t * t * (t * (t * 6 - 15) + 10)), slope(30 * t * t * (t - 1) * (t - 1)) {}
  double weight;
  double slope;
};

/// Large odd numbers keep lattice neighbours apart before they are mixed.
std::uint64_t lattice_hash(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) {
  return mix(seed + static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u +
             static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu +
             static_cast<std::uint64_t>(z) * 0x165667b19e3779f9u);
}

/// Returns random values at the integer lattice, blended between.
NoiseSample value_noise(std::uint64_t seed, Vec3d p) {
  const Vec3d base{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const auto x = static_cast<std::int64_t>(base.x);
  const auto y = static_cast<std::int64_t>(base.y);
  const auto z = static_cast<std::int64_t>(base.z);
  const Blend u(p.x - base.x);
  const Blend v(p.y - base.y);
  const Blend w(p.z - base.z);
  const auto corner = [&](int dx, int dy, int dz) {
    return signed_unit(lattice_hash(seed, x + dx, y + dy, z + dz));
  };
  // Coefficients of 1, u, v, w, uv, vw, wu and uvw.
  const double c000 = corner(0, 0, 0), c100 = corner(1, 0, 0);
  const double c010 = corner(0, 1, 0), c110 = corner(1, 1, 0);
  const double c001 = corner(0, 0, 1), c101 = corner(1, 0, 1);
  const double c011 = corner(0, 1, 1), c111 = corner(1, 1, 1);
  const double ku = c100 - c000;
  const double kv = c010 - c000;
  const double kw = c001 - c000;
  const double kuv = c000 - c100 - c010 + c110;
  const double kvw = c000 - c010 - c001 + c011;
  const double kwu = c000 - c100 - c001 + c101;
  const double kuvw = -c000 + c100 + c010 - c110 + c001 - c101 - c011 + c111;
  const double a = u.weight;
  const double b = v.weight;
  const double c = w.weight;
  return {
      c000 + ku * a + kv * b + kw * c + kuv * a * b + kvw * b * c + kwu * c * a + kuvw * a * b * c,
      {u.slope * (ku + kuv * b + kwu * c + kuvw * b * c),
       v.slope * (kv + kvw * c + kuv * a + kuvw * c * a),
       w.slope * (kw + kwu * a + kvw * b + kuvw * a * b)}};
}

/// A quarter-free turn with rational entries (rows of unit length: 2/3, 1/3, 2/3 and so on), so
/// that no two octaves share lattice planes.
Vec3d turned(Vec3d a) {
  return {(2 * a.x - a.y + 2 * a.z) / 3, (2 * a.x + 2 * a.y - a.z) / 3,
          (-a.x + 2 * a.y + 2 * a.z) / 3};
}

}  // namespace

FractalNoise::FractalNoise(const FractalOptions& options) {
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  double height = options.height;
  double frequency = options.frequency;
  for (int octave = 0; octave < options.octaves; ++octave) {
    for (Vec3d& axis : axes)
      axis = turned(axis);
    octaves_.push_back({{axes[0] * frequency, axes[1] * frequency, axes[2] * frequency},
                        height,
                        random_at(options.seed, static_cast<std::uint64_t>(octave))});
    height *= options.gain;
    frequency *= 2;
  }
}

NoiseSample FractalNoise::at(Vec3d p) const {
  NoiseSample sum;
  for (const Octave& octave : octaves_) {
    const auto& [ax, ay, az] = octave.axes;
    const NoiseSample sample = value_noise(octave.seed, {dot(ax, p), dot(ay, p), dot(az, p)});
    sum.value += octave.height * sample.value;
    const Vec3d slope = ax * sample.gradient.x + ay * sample.gradient.y + az * sample.gradient.z;
    sum.gradient = sum.gradient + slope * octave.height;
  }
  return sum;
}

}  // namespace meshhier::bench

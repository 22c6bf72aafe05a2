// Small vectors of three, in single and double precision.
#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace meshhier {

template <class Scalar>
struct Vec3 {
  Scalar x{}, y{}, z{};

  constexpr Scalar operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, Scalar s) { return {a.x * s, a.y * s, a.z * s}; }
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
static_assert(sizeof(Vec3f) == 12, "positions are read and written as three packed floats");

template <class Scalar>
constexpr Scalar dot(Vec3<Scalar> a, Vec3<Scalar> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Scalar>
constexpr Vec3<Scalar> cross(Vec3<Scalar> a, Vec3<Scalar> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Scalar>
Scalar length(Vec3<Scalar> a) {
  return std::sqrt(dot(a, a));
}

constexpr Vec3d to_double(Vec3f a) {
  return {a.x, a.y, a.z};
}
constexpr Vec3f to_float(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

template <class Scalar>
bool is_finite(Vec3<Scalar> p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Whether all three coordinates are floats.
inline bool fits_float(Vec3d p) {
  constexpr double kMost = std::numeric_limits<float>::max();
  const bool in_range = std::abs(p.x) <= kMost && std::abs(p.y) <= kMost && std::abs(p.z) <= kMost;
  return in_range && to_double(to_float(p)) == p;
}

}  // namespace meshhier

// How stored positions lie in space.
#pragma once

#include "base/vec.h"

#include <array>
#include <string_view>

namespace meshhier {

/// Which axis of the input points up. glTF's is y; 3D Tiles' is z.
enum class UpAxis { y, z };

/// "y" or "z".
constexpr std::string_view name_of(UpAxis up) {
  return up == UpAxis::z ? "z" : "y";
}

/// The direction up, of length 1.
constexpr Vec3d direction_of(UpAxis up) {
  return up == UpAxis::z ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
}

/// The frame that the nodes of all files of a hierarchy share.
struct Frame {
  Vec3d origin;           ///< added to every position
  UpAxis up = UpAxis::y;  ///< z: then turned, so that (x, y, z) becomes (x, z, -y)
  friend bool operator==(const Frame&, const Frame&) = default;
};

/// From input coordinates to those of 3D Tiles, where z is up. Viewers turn glTF's content, which
/// is y-up, in the same way.
constexpr Vec3d to_z_up(Vec3d p, UpAxis up) {
  return up == UpAxis::z ? p : Vec3d{p.x, -p.z, p.y};
}

/// A 4 x 4 matrix, column by column.
using Transform = std::array<double, 16>;

/// The transform of points that are scaled before.
constexpr Transform scaled(Transform transform, double scale) {
  for (std::size_t i = 0; i < 12; ++i)
    transform[i] *= scale;
  return transform;
}

inline constexpr Transform kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

}  // namespace meshhier

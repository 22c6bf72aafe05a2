// Corners of triangles that are cut, with all that a vertex has.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/texture.h"
#include "hierarchy/vec.h"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace meshhier::inspection {

inline constexpr std::size_t kNewVertex = std::numeric_limits<std::size_t>::max();

/// A hundred bytes: polygons are small.
struct ClippedCorner {
  std::size_t vertex = kNewVertex;  ///< of what was cut; kNewVertex: made by cutting
  Vec3f position;
  std::array<float, kMaxChannels> attributes{};
  Vec3f normal;
  Vec2f texcoord;
};

/// Convex, the corners in order. Fewer than three: nothing.
using ClippedPolygon = std::vector<ClippedCorner>;

/// All that a corner has, for an order that does not depend on the triangle.
inline auto key_of(const ClippedCorner& c) {
  return std::tie(c.position.x, c.position.y, c.position.z, c.attributes, c.normal.x, c.normal.y,
                  c.normal.z, c.texcoord.u, c.texcoord.v);
}

/// Makes corners between others.
class CornerMixer {
 public:
  /// `channels`: of the corners' attributes, as `layout` has them; those that it does not have are
  /// plain numbers.
  CornerMixer(const AttributeLayout& layout, std::size_t channels)
      : layout_(layout), light_(layout), channels_(channels) {}

  /// `from` plus the weights' parts of the ways to `to`, as many: positions, normals of unit
  /// length, texture coordinates and attributes; colours by their light, those of integers rounded.
  ClippedCorner mixed(const ClippedCorner& from, std::span<const ClippedCorner* const> to,
                      std::span<const double> weights) const;
  ClippedCorner between(const ClippedCorner& from, const ClippedCorner& to, double t) const {
    const ClippedCorner* end = &to;
    return mixed(from, {&end, 1}, {&t, 1});
  }

 private:
  AttributeLayout layout_;
  ColourLight light_;
  std::size_t channels_;
};

}  // namespace meshhier::inspection

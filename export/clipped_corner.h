// Corners of triangles that are cut, with all that a vertex has.
#pragma once

#include "base/vec.h"
#include "hierarchy/attribute_rules.h"
#include "hierarchy/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace meshhier::exporting {

inline constexpr std::size_t kNewVertex = std::numeric_limits<std::size_t>::max();

/// A corner takes some hundred bytes: polygons are small.
struct ClippedCorner {
  /// Number in the part that was cut; kNewVertex: made by cutting.
  std::size_t vertex = kNewVertex;
  Vec3f position;
  std::array<float, kMaxChannels> attributes{};
  Vec3f normal;
  Vec2f texcoord;
};

/// A convex polygon, its corners in order. Fewer than three: nothing.
using ClippedPolygon = std::vector<ClippedCorner>;

/// Returns all that a corner has, for an order that does not depend on the triangle.
inline auto key_of(const ClippedCorner& c) {
  // Channels of values need not be numbers.
  std::array<std::uint32_t, kMaxChannels> bits;
  std::ranges::transform(c.attributes, bits.begin(),
                         [](float x) { return std::bit_cast<std::uint32_t>(x); });
  return std::tuple(c.position.x, c.position.y, c.position.z, bits, c.normal.x, c.normal.y,
                    c.normal.z, c.texcoord.u, c.texcoord.v);
}

/// Makes corners between others. Thread-safe.
class CornerMixer {
 public:
  /// `channels`: how many attributes corners have; those beyond the rules are plain numbers.
  CornerMixer(const AttributeRules& rules, std::size_t channels)
      : rules_(rules), channels_(channels) {}

  /// Returns `from` plus the weights' parts of the ways to `to`; there are as many weights. It
  /// mixes positions, normals (made of unit length again), texture coordinates and attributes;
  /// colours by their light, those of integers rounded; values as ValueMixer makes them.
  ClippedCorner mixed(const ClippedCorner& from, std::span<const ClippedCorner* const> to,
                      std::span<const double> weights) const;
  ClippedCorner between(const ClippedCorner& from, const ClippedCorner& to, double t) const {
    const ClippedCorner* end = &to;
    return mixed(from, {&end, 1}, {&t, 1});
  }

 private:
  void mix_values(const ClippedCorner& from, std::span<const ClippedCorner* const> to,
                  std::span<const double> weights, ClippedCorner& made) const;

  AttributeRules rules_;
  std::size_t channels_;
};

}  // namespace meshhier::exporting

// That two tiles are the same, bit for bit.
#pragma once

#include "base/vec.h"
#include "hierarchy/published.h"

#include <bit>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::tests {

inline std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values)
    bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

inline std::vector<std::uint32_t> bits_of(const std::vector<Vec3f>& points) {
  std::vector<float> values;
  for (const Vec3f& p : points)
    values.insert(values.end(), {p.x, p.y, p.z});
  return bits_of(values);
}

/// Everything but the attributes.
inline void expect_same_mesh(const PublishedTile& a, const PublishedTile& b) {
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(bits_of(a.mesh.vertices.positions), bits_of(b.mesh.vertices.positions));
  EXPECT_EQ(a.mesh.vertices.channels, b.mesh.vertices.channels);
  EXPECT_EQ(a.mesh.own_count, b.mesh.own_count);
  EXPECT_EQ(a.mesh.boundary_count, b.mesh.boundary_count);
  EXPECT_EQ(a.mesh.ghosts, b.mesh.ghosts);
  EXPECT_EQ(a.mesh.interior, b.mesh.interior);
  EXPECT_EQ(a.mesh.border, b.mesh.border);
  EXPECT_EQ(a.parent_map, b.parent_map);
  EXPECT_EQ(a.chains, b.chains);
  EXPECT_EQ(bits_of(a.mesh.copies.vertices.positions), bits_of(b.mesh.copies.vertices.positions));
  EXPECT_EQ(a.mesh.copies.places, b.mesh.copies.places);
  EXPECT_EQ(a.mesh.interior_wedges, b.mesh.interior_wedges);
  EXPECT_EQ(a.mesh.border_wedges, b.mesh.border_wedges);
  EXPECT_TRUE(a.shading == b.shading);
  EXPECT_TRUE(a.image == b.image);
  EXPECT_TRUE(a.objects == b.objects);
}

inline void expect_same_attributes(const PublishedTile& a, const PublishedTile& b) {
  EXPECT_EQ(bits_of(a.mesh.vertices.attributes), bits_of(b.mesh.vertices.attributes));
  EXPECT_EQ(bits_of(a.mesh.copies.vertices.attributes), bits_of(b.mesh.copies.vertices.attributes));
}

}  // namespace meshhier::tests

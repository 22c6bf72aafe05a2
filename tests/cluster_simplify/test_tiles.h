// Tiles and meshes that the tests of the contraction methods share.
#pragma once

#include "cluster_simplify/seams.h"
#include "hierarchy/build_tile.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <string>
#include <vector>

namespace meshhier::tests {

inline std::uint32_t count_of(const auto& list) {
  return static_cast<std::uint32_t>(list.size());
}

Vec3f vec3f(double x, double y, double z);

/// A tile of a mesh whose vertices from `own_count` on belong to a neighbour. Triangles of ghosts
/// alone are not part of a tile.
BuildTile tile_of(const TestMesh& mesh, std::uint32_t own_count);

/// A tile of own vertices only.
BuildTile tile_of(const TestMesh& mesh);

/// The part of a mesh with x <= limit as a tile, the rest as its ghosts.
BuildTile part_of(TestMesh mesh, float limit);

/// Gives the tile's vertices all attributes: normals of unit length, colours 0 .. 255 with alpha,
/// texture coordinates; functions of the place and noise.
void add_attributes(BuildTile& tile);
inline constexpr AttributeLayout kAllAttributes{true, ColourType::u8, true, true};

/// The surface of [-1, 1]^3, closed, n x n quads a face, 6 n^2 + 2 vertices; the corners are there
/// exactly.
TestMesh cube(std::uint32_t n);
std::vector<Vec3f> cube_corners();

/// `count` boundary vertices on the unit circle around vertex 0, at `height`, with all triangles
/// between them: a disk.
TestMesh wheel(std::uint32_t count, float height);

/// Two own vertices, 0 and 1, in a ring of ghosts shaped like a Z: no place in the plane sees all
/// of the ring from inside. All triangles face up.
TestMesh z_ring();

/// Few vertices, many triangles between any of them: repeated, mirrored, edges of many triangles.
TestMesh tangle(std::uint32_t vertices, std::uint32_t triangles, std::uint64_t seed);

/// The mesh, each triangle once more with its back.
TestMesh mirrored(TestMesh mesh);

struct NamedMesh {
  std::string name;
  TestMesh mesh;
};

/// Closed and open, with many pieces or none, non-manifold, repeated, without area: what a
/// contraction must take.
std::vector<NamedMesh> nasty_meshes();

/// Vertices with few triangles, with many, with none; every kind of edge: small meshes to look at
/// after each of many collapses.
std::vector<NamedMesh> small_meshes();

/// Returns what a contraction makes of a tile: interior and border triangles, ghosts after the
/// representatives; degenerate ones are gone, of equal ones one is left.
TestMesh image_of(const BuildTile& tile, const cluster_simplify::Contraction& contraction);

double distance(Vec3f a, Vec3f b);

/// Returns the least distance of `points` to `p`; infinite if there are none.
double distance_to_nearest(Vec3f p, const std::vector<Vec3f>& points);

/// Its length is twice the triangle's area.
Vec3d doubled_normal(const TestMesh& mesh, const MeshTriangle& t);

/// How many lines the borders of a manifold make, each closed.
std::size_t border_line_count(const std::vector<MeshTriangle>& triangles);

}  // namespace meshhier::tests

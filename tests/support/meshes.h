// Test meshes made in code, and the counts that say whether a mesh is what it should be.
//
// Independent of the library's readers and writers. Everything is deterministic.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/triangle.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace meshhier::tests {

using MeshTriangle = Triangle<std::uint32_t>;

constexpr TileTriangle tile_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {TileVertex{a}, TileVertex{b}, TileVertex{c}};
}

struct TestMesh {
  std::vector<Vec3f> positions;
  std::vector<MeshTriangle> triangles;  ///< counter-clockwise seen from outside, where there is one
};

/// Appends `other`, scaled, then shifted.
void append(TestMesh& mesh, const TestMesh& other, Vec3f shift = {}, float scale = 1);

// Common parameters: `triangles` asks for at least so many triangles (the next count the shape
// allows is made; see each maker for the factor); `noise` is the largest displacement of a vertex
// in each axis, in units of the shape, which is about 2 across.

/// Closed, genus 0: a unit sphere, 8 n^2 triangles (an octahedron split evenly), 4 n^2 + 2
/// vertices.
TestMesh sphere(std::size_t triangles, float noise = 0);

/// Closed, genus 1: radii 0.7 and 0.3; 6 n^2 triangles, 3 n^2 vertices; n >= 3.
TestMesh torus(std::size_t triangles, float noise = 0);

/// Closed, of the genus asked for (>= 0): a slab with a row of square holes, bent by a smooth wave.
TestMesh genus_n(std::size_t genus, std::size_t triangles, float noise = 0);

/// Closed, two components: a sphere (outward) and half its size within it another (inward), half of
/// the triangles each.
TestMesh nested_shells(std::size_t triangles, float noise = 0);

/// Open: (width + 1)(height + 1) vertices row by row over [0, width] x [0, height], z = 0, with
/// 2 width height triangles. Noise is in grid units here: below 0.5.
TestMesh open_grid(std::size_t width, std::size_t height, float noise = 0);

/// Open, not orientable: a band with half a twist; 16 n^2 triangles; one border line.
TestMesh moebius(std::size_t triangles, float noise = 0);

/// Three sheets (half planes of n x n quads) on one line of n edges, and a bow tie: two cones of
/// eight triangles whose tips are one vertex. 6 n^2 + 16 triangles.
TestMesh non_manifold(std::size_t triangles, float noise = 0);

/// So many triangles that share no vertex, scattered in [-1, 1]^3.
TestMesh soup(std::size_t triangles);

/// So many vertices in [-1, 1]^3, no triangles.
TestMesh points(std::size_t count);

/// A sphere of which every seventh triangle is there twice, every eleventh again with turned
/// corners, every thirteenth again mirrored; every fifth vertex exists twice (equal position), and
/// one of the two copies is used by the triangles of odd number, the other by those of even number.
TestMesh duplicates(std::size_t triangles, float noise = 0);

/// The same surface with vertices and triangles in a pseudo-random order that depends on `seed`.
TestMesh shuffled(const TestMesh& mesh, std::uint64_t seed);

/// The same surface with vertices in the order in which triangles name them, as an STL is welded;
/// those that none names are gone.
TestMesh by_first_appearance(const TestMesh& mesh);

/// A number in [-1, 1) that is a pure function of the two: white noise.
float hash_noise(std::uint64_t index, std::uint64_t stream);

// Counts. Triangles with two equal corners are not expected.

/// Ascending. Corners are vertices of a mesh that is not much larger: their numbers are counted
/// over.
void sort_triangles(std::vector<MeshTriangle>& triangles);

using Edge = std::array<std::uint32_t, 2>;

/// The three directed edges (from, to) of every triangle, ascending, with repeats.
std::vector<Edge> directed_edges(std::span<const MeshTriangle> triangles);

/// The same edges without their direction (lower, higher), ascending, with repeats.
std::vector<Edge> undirected_edges(std::span<const MeshTriangle> triangles);

/// Edges (lower, higher) with exactly one triangle, ascending.
std::vector<Edge> boundary_edges(std::span<const MeshTriangle> triangles);

/// Directed edges that are run along more often than their opposites, ascending, without repeats.
std::vector<Edge> unmatched_edges(std::span<const MeshTriangle> triangles);

/// There are triangles, and every directed edge is matched by its opposite.
bool is_closed(std::span<const MeshTriangle> triangles);

/// V - E + F over the vertices that triangles use.
std::int64_t euler_characteristic(std::span<const MeshTriangle> triangles);

/// Components over shared vertices; unused vertices do not count.
std::size_t component_count(const TestMesh& mesh);

/// Writes a binary little endian PLY: float x y z, then list uchar int vertex_indices. Throws
/// std::runtime_error if the file cannot be written.
void write_ply(const TestMesh& mesh, const std::filesystem::path& path);

}  // namespace meshhier::tests

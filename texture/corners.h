// Texture coordinates by corner, and what becomes of vertices by them.
#pragma once

#include "hierarchy/shading.h"
#include "hierarchy/tangent_code.h"
#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"

#include <array>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Of the three corners of a triangle, in its order.
using CornerTexcoords = std::array<Vec2f, 3>;

/// For a normal map, likewise.
using CornerTangents = std::array<TangentCode, 3>;

/// The part of its picture that a triangle covers.
double area_of(const CornerTexcoords& corners);

/// What the vertices of a tile have in all: `normals` (empty if there are none, and then without
/// splits), and the coordinates that `corners` have, one a triangle, interior ones first. A vertex
/// has the first combination that a corner of it has, in the order of the triangles; for each other
/// one it is split. A vertex that no triangle uses has (0, 0). Pure, O(n log n). Requires equal
/// corners of triangles of equal vertices.
Shading with_texcoords(const TileMesh& mesh, const Shading& normals,
                       std::span<const CornerTexcoords> corners);

/// Of all vertices and splits that with_texcoords() gave: those of their corners, one a triangle,
/// interior ones first; kNoTangent of vertices without a triangle. O(n).
std::vector<TangentCode> tangents_of(const TileMesh& mesh, const Shading& shown,
                                     std::span<const CornerTangents> corners);

}  // namespace meshhier::texture

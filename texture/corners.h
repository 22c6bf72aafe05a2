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

/// The texture coordinates of a triangle's corners, in its order.
using CornerTexcoords = std::array<Vec2f, 3>;

/// Their tangents, for a normal map.
using CornerTangents = std::array<TangentCode, 3>;

/// The part of its picture that a triangle covers.
double area_of(const CornerTexcoords& corners);

/// Gives the vertices of a tile `normals` (empty if there are none, and then without splits) and
/// the coordinates of `corners`, one entry a triangle, interior ones first. A vertex has the first
/// combination that a corner of it has, in the order of the triangles; for each other one it is
/// split. A vertex that no triangle uses has (0, 0). Pure, O(n log n). Requires equal corners of
/// triangles of equal vertices.
Shading with_texcoords(const TileMesh& mesh, const Shading& normals,
                       std::span<const CornerTexcoords> corners);

/// Returns the tangents of all vertices and splits that with_texcoords() gave, from `corners`, one
/// entry a triangle, interior ones first; kNoTangent for vertices without a triangle. O(n).
std::vector<TangentCode> tangents_of(const TileMesh& mesh, const Shading& shown,
                                     std::span<const CornerTangents> corners);

}  // namespace meshhier::texture

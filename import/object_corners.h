// Objects of triangles become a value of their corners.
//
// Problem. A reader says whose each triangle is, and vertices may be shared by triangles of two
// objects. From here on all know values of vertices alone.
//
// Idea. A vertex at a border is several, one for each object (CornerSplitter):
//
//       a---b---c                 a---b b---c       the left triangles have object 3,
//       | \ | \ |                 | \ | | \ |       the right ones object 8;
//       d---e---f                 d---e e---f       b and e are two vertices each
//
// Invariant. The corners of a triangle have the same object. Vertices stay in their order, those of
// one vertex by their objects; vertices of no triangle have object 0.
#pragma once

#include "import/raw_mesh.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace meshhier::importing {

/// Returns the name of the value: "object", or "object_2" and so on if there is one of that name.
std::string object_value_name(const AttributeLayout& layout);

/// Fills `whole` with `mesh`, whose spools are cleared: its vertices have the value of the objects
/// behind all other values. `object_of(triangle)` is asked for ascending triangles. `ends`: counts
/// of vertices up to places in their order, which become those of the new vertices. Returns how
/// many vertices there are more. Throws Error(input) if vertices have no room for the value. Cost:
/// as CornerSplitter.
std::uint64_t put_objects(RawMesh& mesh, RawMesh& whole,
                          const std::function<std::uint32_t(std::uint64_t)>& object_of,
                          std::span<std::uint64_t> ends, const ImportRoom& room);

}  // namespace meshhier::importing

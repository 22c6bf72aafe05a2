// Whether a mesh is rooms, seen from within. The page judges likewise
// (viewer/src/tools/interior.ts).
//
// Problem. A scan of rooms shows its ceilings from above, and a statue is to keep its skin: which
// of the two is a mesh?
//
// Idea. Rays from outside, down to level, through all of its box. Walls and ceilings that were seen
// from within turn their backs to them. Behind such backs lie floors, which are level; a statue
// whose triangles are wound the wrong way has none:
//
//      \  \   rays            ____________  ceiling, seen from its back
//       \  \                 |  \         |
//        v  v                |   v        |  the first front: a floor
//
// Cost. 600 rays against each triangle of the root: 30 thousand triangles take about 0.1 s.
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"

namespace meshhier::render {

/// Judges by a tile's own triangles. One without a border is no room: it is a body, at worst inside
/// out. `up`: of length 1. A pure function; no sine of the C library decides.
bool is_interior(const TileMesh& mesh, Vec3d up);

}  // namespace meshhier::render

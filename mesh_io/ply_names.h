// Names of a PLY header that mean the format's own.
#pragma once

#include "mesh_io/ply_header.h"

#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// Renames elements and properties to the format's names, where others are meant as these: elements
/// `vertices`, `Face` and the like; lists `vertex_indexes` and the like of faces and strips. If
/// faces have no such list, three or four integers of one type side by side, as v1 v2 v3 or a b c,
/// become a list of that length. Where several could be meant, all names stay. Returns how many
/// lines of the header were not as the format has them. Pure.
std::uint64_t settle_ply_names(std::vector<PlyElement>& elements);

}  // namespace meshhier::mesh_io

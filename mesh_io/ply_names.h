// Names of a PLY header that mean the format's own.
#pragma once

#include "mesh_io/ply_header.h"

#include <cstdint>
#include <vector>

namespace meshhier::mesh_io {

/// Gives what is meant the format's names, where it has not got them: elements `vertices`, `Face`
/// and the like; `vertex_indexes` and the like of faces and strips; and of faces without such a
/// list three or four integers of one type side by side, as v1 v2 v3 or a b c, become a list of
/// that length. Where several could be meant all stays. Returns how many lines of the header were
/// not as the format has them. Pure.
std::uint64_t settle_ply_names(std::vector<PlyElement>& elements);

}  // namespace meshhier::mesh_io

// Reads a tile from the bytes of its sections.
#pragma once

#include "base/vec.h"
#include "hierarchy/published.h"
#include "storage/format/section_reader.h"

#include <string>
#include <vector>

namespace meshhier::storage {

// Both throw Error(corrupt) that starts with `name`.

/// Returns the positions of all vertices, copies last, without splits: finite, and on the lattice
/// if there is one.
std::vector<Vec3f> read_positions(const TileSections& sections, const Tree& tree,
                                  const std::string& name);
/// Returns the whole tile. `positions`: from read_positions().
PublishedTile read_tile(const TileSections& sections, std::vector<Vec3f> positions,
                        const Tree& tree, const std::string& name);

}  // namespace meshhier::storage

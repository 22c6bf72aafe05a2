// Reads a tile from the bytes of its sections.
#pragma once

#include "base/vec.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "storage/format/tile_plan.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// The sections of a tile: bytes that nobody vouches for, as many as the plan says.
struct TileSections {
  const TilePlan& plan;
  std::span<const std::byte> bin;
  bool is_packed = false;  ///< triangles are as the codec gave them, turned and in another order
};

// Both throw Error(corrupt) that starts with `name`.

/// Returns the positions of all vertices, copies last, without splits: finite, and on the lattice
/// if there is one.
std::vector<Vec3f> read_positions(const TileSections& sections, const Tree& tree,
                                  const std::string& name);
/// Returns the whole tile. `positions`: from read_positions().
PublishedTile read_tile(const TileSections& sections, std::vector<Vec3f> positions,
                        const Tree& tree, const std::string& name);

}  // namespace meshhier::storage

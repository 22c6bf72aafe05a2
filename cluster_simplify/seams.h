// Seams: how border triangles stay true while every tile contracts on its own
// (docs/architecture.md).
//
// A border triangle's foreign corner is whatever the neighbour's own chain of parent maps says it
// is. These kernels carry foreign corners one level up, join two tiles, and carry a contraction out
// on a joined tile.
#pragma once

#include "cluster_simplify/deviation.h"
#include "hierarchy/build_tile.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Rewrites a fresh tile's border with its foreign corners' places at the tile's own level.
/// `Corner`: ChunkVertex or FinerGhost.
/// `mapped`: one entry per tile.foreign, at the tile's level, as are the wedges of foreign corners.
/// Corners that became one place become one ghost, triangles that became degenerate go; of exact
/// duplicates one stays if `unique` (simplified tiles; partitions keep the input's duplicates),
/// with the same wedges in all tiles that have it: `own_index` is the tile's. The ghosts' positions
/// and attributes are left for fill_ghosts(). O(n log n).
template <class Corner>
BuildTile resolve(WorkTile<Corner> tile, std::span<const GhostRef> mapped, bool unique,
                  std::uint32_t own_index);

/// Appends the ghosts of one neighbour to the tile's vertices; call in ascending order of
/// `neighbour`. Throws Error(internal) if a ghost lies outside the boundary.
void fill_ghosts(BuildTile& tile, std::uint32_t neighbour, const Boundary& boundary);

/// Two neighbouring tiles of one level as one: first's own vertices, then second's; border
/// triangles between them become interior; ghosts of one in the other become own vertices.
BuildTile join(const BuildTile& first, std::uint32_t first_index, const BuildTile& second,
               std::uint32_t second_index);

/// Vertices that went in ways a method avoids while it can, in the order in which they are tried.
struct FallbackCounts {
  std::uint32_t torn = 0;    ///< changed topology, because anything else would have harmed more
  std::uint32_t turned = 0;  ///< let triangles turn over, because nothing else was left
  std::uint32_t forced = 0;  ///< whatever it did to the surface
  std::uint32_t joined = 0;  ///< joined across gaps, no edge between them

  FallbackCounts& operator+=(const FallbackCounts& other);
  /// Those of a tile that could not reach its count with care.
  std::uint32_t without_care() const { return turned + forced + joined; }
};

/// The outcome of a contraction method: which representative stands for each own vertex of a joined
/// tile.
struct Contraction {
  std::vector<std::uint32_t>
      parent_of;  ///< own vertex -> representative, < representatives.size(), onto
  VertexArray representatives;
  Deviation deviation;
  FallbackCounts fallbacks;
};

/// A parent tile and the map that leads to it.
struct ContractedTile {
  SimplifiedTile tile;                    ///< foreign: ghosts of the joined tile
  std::vector<std::uint16_t> parent_map;  ///< own vertex of the joined tile -> vertex of `tile`
  Deviation deviation;                    ///< around: per vertex of `tile`
  WedgeMap wedge_map;                     ///< of the joined tile
  FallbackCounts fallbacks;
};

struct ContractedWedges;  // cluster_simplify/wedges.h

/// Applies a contraction to a joined tile: maps its triangles, drops degenerate and repeated ones,
/// puts the boundary first and sums weights. `wedges`: of the contraction, if the joined tile has
/// copies.
ContractedTile apply(const BuildTile& joined, Contraction contraction, ContractedWedges wedges);
/// Of a joined tile without copies.
ContractedTile apply(const BuildTile& joined, Contraction contraction);

/// The contraction that changes nothing: for a node whose only child stands for it. The parent map
/// is the identity.
ContractedTile keep(const BuildTile& tile);

}  // namespace meshhier::cluster_simplify

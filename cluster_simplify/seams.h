// Seams: border triangles stay true while every tile contracts on its own (docs/architecture.md,
// docs/decisions/004).
//
// Problem. Each tile is contracted alone, on another thread or another machine, and knows nothing
// of what its neighbours do meanwhile. Still any cut must be free of cracks.
//
// Idea. A tile decides about its own places only. It never stores where a neighbour's corner *is*,
// but what its *name* is: (tile, index among that tile's boundary vertices). Whoever wants to draw
// the corner follows the neighbour's own parent maps. So all tiles that hold a border triangle draw
// the same one, whichever of them was contracted first. A border triangle on its way from one level
// to the next coarser one:
//
//      the finer level      A | B | C | D       border triangle (A 7, B 2, C 5)
//                            \ /  |  \ /
//        join()              A+B  |  C+D        A 7 and B 2 are own places of the joined tile,
//                             |   |   |         C 5 is a ghost
//        contract(), apply()  AB  |  CD         own corners have parents, C 5 keeps its old name:
//                             |   |   |         (AB 3, AB 0, foreign C 5)
//        - - - - - - - - - - - - - - - -        the coarser level is complete
//                             |   |   |
//        resolve()            AB  |  CD         CD's parent map says 5 -> 1: (AB 3, AB 0, CD 1)
//        fill_ghosts()        AB  |  CD         the position of CD 1 is one short read
//
// Invariants.
//  - Boundary vertices come first in their tile, so a name is an index below boundary_count, and
//    positions of ghosts and the start of a parent map are short reads.
//  - ghosts and foreign corners ascend by name; triangles are normalized and ascend.
//  - Of triangles that became equal in their places one stays, and all tiles that have them choose
//    the same one: by names, which they share, not by their own numbers, which they do not.
//
// Cost. O(n log n) each for n vertices and triangles; a joined tile has at most 65,536 places.
#pragma once

#include "cluster_simplify/deviation.h"
#include "hierarchy/build_tile.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

// All functions are pure: they may be called for different tiles at the same time.

/// Rewrites a fresh tile's border with its foreign corners' places at the tile's own level.
/// `Corner`: ChunkVertex or FinerGhost.
/// `mapped`: one entry per tile.foreign, at the tile's level, as are the wedges of foreign corners.
/// Corners that became one place become one ghost, and triangles that became degenerate go. If
/// `unique`, one of exact duplicates stays (in simplified tiles; partitions keep the input's
/// duplicates), with the same wedges in all tiles that have it; `own_index` is the tile's. The
/// ghosts' positions and attributes are left for fill_ghosts(). Throws nothing.
template <class Corner>
BuildTile resolve(WorkTile<Corner> tile, std::span<const GhostRef> mapped, bool unique,
                  std::uint32_t own_index);

/// Appends the ghosts of one neighbour to the tile's vertices. Call it in ascending order of
/// `neighbour`. Throws Error(internal) if a ghost lies outside the boundary.
void fill_ghosts(BuildTile& tile, std::uint32_t neighbour, const Boundary& boundary);

/// Makes two neighbouring tiles of one level one: first's own vertices, then second's. Border
/// triangles between them become interior, ghosts of one in the other own vertices.
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
/// The same for a joined tile without copies.
ContractedTile apply(const BuildTile& joined, Contraction contraction);

/// Applies the contraction that changes nothing, for a node whose only child stands for it. The
/// parent map is the identity.
ContractedTile keep(const BuildTile& tile);

}  // namespace meshhier::cluster_simplify

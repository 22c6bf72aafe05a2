// Checks that tiles know the copies at their ghosts' places, and the splits of vertices there, as
// the tiles do that own them.
//
// A tile has only those copies and splits of a neighbour that its own border triangles use. So the
// two do not claim the same: the claims of the one must be among those of the other, in the same
// order. All claims meet in one sort, as in border_pairs.h; tiles without copies and splits make
// none. A tile with texture coordinates claims no splits, and not which normal of a copy is its
// first.
#pragma once

#include "export/vertex_hash.h"
#include "hierarchy/published.h"
#include "hierarchy/tree.h"
#include "partition/external_sort.h"
#include "verify/border_pairs.h"

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace meshhier::verifying {

/// Copies and splits that a tile has at places of a neighbour, but not as the neighbour has them.
struct WrongCopies {
  NodeId tile, neighbour;
  std::uint64_t count = 0;
  std::uint32_t first_place = 0;  ///< the neighbour's
};

/// Gathers the claims of all tiles and compares them. For one thread.
class CopyClaims {
 public:
  /// `tree` must outlive it. `memory_bytes`: those of the sort.
  CopyClaims(const Tree& tree, HasTexcoords has_texcoords, storage::ScratchFile& scratch,
             std::uint64_t memory_bytes)
      : tree_(tree), has_texcoords_(std::move(has_texcoords)), claims_(scratch, memory_bytes) {}

  /// Adds the claims of a tile about its own copies and splits and its neighbours'; for a partition
  /// also claims about copies for the early node above it, if there is one. O(copies and splits).
  void add(const PublishedTile& tile);

  /// Visits the tiles with wrong claims, ascending by neighbour, then tile. Called once, after all
  /// tiles.
  void finish(const std::function<void(const WrongCopies&)>& visit);

 private:
  /// Says that a place has a copy, or a vertex there a split. The owner's claims come first, then
  /// those of one tile after the other.
  struct Claim {
    std::uint16_t level = 0;
    std::uint16_t by_neighbour = 0;  ///< 0: the claim is the owner's
    std::uint32_t owner = 0, place = 0;
    std::uint32_t tile = 0;             ///< the tile whose claim it is
    std::uint32_t wedge = 0;            ///< number in that tile; splits come after all copies
    std::uint32_t normal = kAnyNormal;  ///< its computed normal's bytes
    std::uint64_t vertex = 0;           ///< a hash of the rest

    bool agrees_with(const Claim& other) const {
      return vertex == other.vertex &&
             (normal == other.normal || normal == kAnyNormal || other.normal == kAnyNormal);
    }
  };
  static constexpr std::uint32_t kAnyNormal = UINT32_MAX;  // the fourth byte of others is 0
  struct ClaimKey {
    auto operator()(const Claim& c) const {
      return std::tuple(c.level, c.owner, c.place, c.by_neighbour, c.tile, c.wedge);
    }
  };
  static_assert(sizeof(Claim) == 32, "sorted by bytes: no padding");
  class Judge;

  void add_own(const PublishedTile& tile, NodeId node);
  void add_ghosts(const PublishedTile& tile);
  void add_splits(const PublishedTile& tile);
  Claim claim_of(const PublishedTile& tile, NodeId owner, std::size_t copy);
  std::uint64_t split_hash(const PublishedTile& tile, std::uint32_t vertex);
  static std::uint32_t normal_bits(const PublishedTile& tile, std::size_t number);

  const Tree& tree_;
  HasTexcoords has_texcoords_;
  exporting::VertexHash hash_;
  partition::ExternalSort<Claim, ClaimKey> claims_;
};

}  // namespace meshhier::verifying

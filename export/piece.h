// A piece of the mesh that a cut shows: the part within a region, tile by tile.
#pragma once

#include "export/clip_part.h"
#include "export/cut_part.h"
#include "export/region.h"
#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace meshhier::exporting {

/// Returns positions in the cut of the tiles that may draw something in the region: tiles whose
/// vertices may lie in it, and their finer neighbours, as a ghost moves to the place that a coarser
/// neighbour has for it.
std::vector<std::size_t> tiles_in(const storage::HierarchyReader& reader, const Cut& cut,
                                  const Region& region);

/// A piece of a cut, or of one tile with its border. It reads only tiles that may reach into the
/// region, and coarser neighbours of these. For one thread.
class Piece {
 public:
  /// `region`: relative to the hierarchy's origin. `reader` must outlive it. Throws as CutParts.
  Piece(const storage::HierarchyReader& reader, Cut cut, Region region, Clipping clipping,
        std::uint64_t cache_bytes);
  Piece(const storage::HierarchyReader& reader, NodeId node, Region region, Clipping clipping);

  /// Return how many tiles may have something in the region, and how many the whole cut has.
  std::size_t size() const { return positions_.size(); }
  std::size_t cut_size() const { return parts_ ? parts_->cut().size() : 1; }
  NodeId node(std::size_t i) const { return parts_ ? parts_->cut()[positions_[i]] : node_; }
  /// Returns the part of a tile in the region, perhaps nothing. The result depends on `i` alone.
  /// Throws as CutParts::load().
  CutPart load(std::size_t i);
  /// Returns whether another tile may have a vertex of load(i), too.
  bool is_shared(std::size_t i, std::uint32_t place) const {
    return parts_ && (place == kNoPlace || parts_->is_at_border(positions_[i], place));
  }

 private:
  const storage::HierarchyReader& reader_;
  std::optional<CutParts> parts_;  ///< none: it is of one tile
  NodeId node_{};                  ///< that tile's
  Region region_;
  Clipping clipping_;
  std::vector<std::size_t> positions_;  ///< in the cut
};

/// Numbers the vertices of parts one after another, each once: vertices at one place, or where an
/// edge was cut, with the same attributes are one vertex. For one thread.
class PieceNumbers {
 public:
  /// add() throws Error(usage) if there are 2^32 vertices or more, and Error(budget) if those at
  /// borders of tiles and where edges were cut would take more than `most_bytes`.
  explicit PieceNumbers(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  struct Numbered {
    std::vector<std::uint32_t> numbers;  ///< per vertex of the part
    std::vector<std::uint32_t> fresh;    ///< vertices of the part that are new, in their order
  };
  Numbered add(const Piece& piece, std::size_t i, const CutPart& part);

  std::uint64_t count() const { return count_; }

 private:
  using Numbers = std::unordered_map<std::string, std::uint32_t>;

  std::uint64_t most_bytes_;
  std::uint64_t bytes_ = 0;
  std::uint64_t count_ = 0;
  Numbers shared_;
};

}  // namespace meshhier::exporting

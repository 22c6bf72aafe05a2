// A piece of the mesh that a cut shows: what a region has of it, tile by tile.
#pragma once

#include "export/clip_part.h"
#include "export/cut_part.h"
#include "export/region.h"
#include "hierarchy/cut.h"
#include "storage/format/hierarchy_reader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace meshhier::exporting {

/// Positions in the cut of the tiles that may draw something in the region: those whose vertices
/// do, and, as a ghost moves to where a coarser neighbour has it, finer neighbours of coarser ones
/// of these.
std::vector<std::size_t> tiles_in(const storage::HierarchyReader& reader, const Cut& cut,
                                  const Region& region);

/// Reads only tiles that may reach into the region, and coarser neighbours of these.
class Piece {
 public:
  /// `region`: relative to the hierarchy's origin. As CutParts.
  Piece(const storage::HierarchyReader& reader, Cut cut, Region region, Clipping clipping,
        std::uint64_t cache_bytes);

  /// Tiles that may have something in the region, and those of the whole cut.
  std::size_t size() const { return positions_.size(); }
  std::size_t cut_size() const { return parts_.cut().size(); }
  NodeId node(std::size_t i) const { return parts_.cut()[positions_[i]]; }
  /// What the region has of a tile, perhaps nothing. Depends on `i` alone. Throws as
  /// CutParts::load().
  CutPart load(std::size_t i);
  /// Whether another tile may have a vertex of load(i), too.
  bool is_shared(std::size_t i, std::uint32_t place) const {
    return place == kNoPlace || parts_.is_at_border(positions_[i], place);
  }

 private:
  const storage::HierarchyReader& reader_;
  CutParts parts_;
  Region region_;
  Clipping clipping_;
  std::vector<std::size_t> positions_;  ///< in the cut
};

/// Numbers the vertices of parts one after another, each once: those at one place, or where an edge
/// was cut, with the same attributes are one vertex.
class PieceNumbers {
 public:
  /// Throws Error(budget) if it would hold more bytes than that, of vertices at borders of tiles
  /// and where edges were cut.
  explicit PieceNumbers(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  struct Numbered {
    std::vector<std::uint32_t> numbers;  ///< of each vertex of the part
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

// The surface that a cut shows, or a piece of it, as triangles in space, tile by tile.
#pragma once

#include "base/bounds.h"
#include "compare/triangle_search.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "export/cut_mesh.h"
#include "export/node_cache.h"
#include "export/region.h"
#include "hierarchy/triangle.h"
#include "storage/format/hierarchy_reader.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace meshhier::comparing {

/// Facts about the triangles that a tile draws: interior ones, then border ones.
struct TriangleFacts {
  std::size_t interior_count = 0;
  std::vector<std::uint32_t> border;   ///< of border triangles the indices in the tile's border
  std::vector<std::uint32_t> objects;  ///< of all triangles; empty if the mesh has none
  std::vector<std::uint32_t>
      numbers;  ///< of a piece: number_in_tile() of all triangles; else empty

  /// Returns the number of a triangle among all of the tile's, of which others may draw some:
  /// interior ones, then the border.
  std::uint32_t number_in_tile(std::uint32_t triangle) const {
    if (!numbers.empty())
      return numbers[triangle];
    const auto interior = static_cast<std::uint32_t>(interior_count);
    return triangle < interior ? triangle : interior + border[triangle - interior];
  }
};

/// The triangles that one tile draws in its cut. Corners are where the cut shows them, relative to
/// the origin.
struct TileSurface {
  std::vector<SurfaceTriangle> triangles;
  TriangleFacts facts;
  /// For each border triangle the positions in the cut of the tiles that have its corners.
  std::vector<Triangle<std::uint32_t>> touched;
};

/// The same triangles by places: the tile's own ones in their order, then those of other tiles.
struct PlacedTile {
  /// A place of another tile.
  struct Foreign {
    std::uint32_t number = 0;  ///< number in the cut
    std::uint32_t tile = 0;    ///< the tile's position in the cut
  };

  std::uint32_t base = 0;  ///< number in the cut of the first place
  std::uint32_t own_count = 0;
  std::vector<Vec3f> places;
  std::vector<bool> is_used;     ///< for each own place: a triangle of the tile has it
  std::vector<Foreign> foreign;  ///< places from own_count on, ascending by number
  std::vector<Triangle<std::uint32_t>> triangles;  ///< corners are among places
  TriangleFacts facts;

  std::uint32_t number(std::uint32_t place) const {
    return place < own_count ? base + place : foreign[place - own_count].number;
  }
  /// Returns the place that has a number in the cut; there must be one.
  std::uint32_t place_of(std::uint32_t number) const;
};

/// The facts that are kept of every tile.
struct TileSurfaceFacts {
  std::uint64_t triangles = 0;
  std::uint64_t flat = 0;  ///< triangles without area
  double area = 0;         ///< input units squared
  Bounds bounds;           ///< of the triangles drawn, relative to the origin; empty() if none
};

/// The surface of a cut. Thread-safe once constructed.
class CutSurface {
 public:
  /// Reads every tile once, to gather its facts; of a piece, relative to the origin, those that may
  /// show something of it: the surface has the triangles that touch it, whole, as Piece has.
  /// `cache_bytes`: memory for positions of neighbours. `reader` must outlive it. Advances
  /// `progress` by one for each tile of the cut. Throws Error(io | corrupt | interrupted).
  CutSurface(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes,
             execution::Progress& progress, const execution::CancelToken& cancel,
             exporting::Region piece = {});

  /// Reads no tile: facts are those of the index. In a cut of several levels boxes may be too small
  /// where a ghost is shown coarser; areas and flat triangles are not known.
  CutSurface(const storage::HierarchyReader& reader, Cut cut, std::uint64_t cache_bytes);

  const Cut& cut() const { return numbered_.cut; }
  std::uint64_t place_count() const { return numbered_.vertex_count(); }
  std::size_t size() const { return facts_.size(); }
  const TileSurfaceFacts& facts(std::size_t position) const { return facts_[position]; }
  /// Returns the facts of all tiles together.
  const TileSurfaceFacts& total() const { return total_; }

  /// Both read a tile, and its neighbours that are shown coarser. Throw Error(io | corrupt).
  TileSurface load(std::size_t position) const;
  PlacedTile load_placed(std::size_t position) const;

 private:
  using Positions = std::vector<Vec3f>;
  /// A place of another tile, and where it is.
  struct ForeignPlace {
    PlacedTile::Foreign foreign;
    Vec3f position;
  };

  Vec3f shown_position(const exporting::ShownGhost& ghost) const;
  std::vector<ForeignPlace> foreign_places(const PublishedTile& tile) const;
  TileSurface piece_of(TileSurface tile) const;

  const storage::HierarchyReader& reader_;
  exporting::NumberedCut numbered_;
  exporting::Region piece_;
  mutable std::mutex mutex_;  ///< guards neighbours_
  mutable exporting::NodeCache<Positions> neighbours_;
  std::vector<TileSurfaceFacts> facts_;
  TileSurfaceFacts total_;
};

/// Returns how many tiles are worked on at a time where each takes a thread.
std::size_t tiles_in_flight();

}  // namespace meshhier::comparing

// The shape-outline: the simplified lines along which sectors meet, and the mesh's own borders and
// creases.
//
// Sectors are the tiles of one level, or parts of these. Where two meet, the line runs through the
// triangles with corners in both, from the midpoint of one crossing edge (corners in different
// sectors) to the midpoint of the other; in a triangle with corners in three sectors three lines
// meet at the centroid. The mesh's own borders, edges with exactly one triangle, are lines too; a
// crossing one goes over its midpoint, where the sectors' line ends. Lines between junctions are
// simplified once, so both sectors share them (Douglas & Peucker 1973). Lines of the form are
// creases, edges within a tile whose two triangles meet at an angle, and crests of the whole
// surface.
#pragma once

#include "hierarchy/ids.h"
#include "hierarchy/outline.h"
#include "hierarchy/tile_mesh.h"
#include "outline/crest_lines.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace meshhier::outline {

struct OutlineOptions {
  double tolerance = 0.002;       ///< of Douglas-Peucker, as a part of `diagonal`; > 0
  double diagonal = 1;            ///< of the model's bounding box, input units; >= 0
  std::size_t max_bytes = 32768;  ///< the file may be so large
  /// Size of the file for so many vertices (Outline::vertices.size()) and line segments, growing
  /// with both; unset: no limit.
  std::function<std::size_t(std::size_t vertices, std::size_t segments)> file_bytes;
};

struct OutlineResult {
  Outline outline;
  /// Used for lines that are no form, as a part of `diagonal`: options.tolerance, doubled until all
  /// but specks fit, up to kCoarsestTolerance.
  double tolerance = 0;
  std::uint64_t polylines_found = 0;
  std::uint64_t polylines_dropped = 0;  ///< the shortest, as many as did not fit
};

/// Lines shorter than so many tolerances are specks (no point of theirs is farther than two from
/// the straight line): when there is no room, they go before the others are made coarser. A scan's
/// many small holes would straighten all that matters otherwise: the dragon at 8192 vertices, 659
/// lines, fits 32 kB with a tolerance of 0.002 and 337 lines dropped, without this rule with 0.0156
/// and 26.
inline constexpr double kSpeckLength = 4;

/// Doubling ends at a 64th of the diagonal: lines between 128 sectors (a tenth to a fifth of it
/// long) are little more than their ends there. What does not fit then has too many lines, not too
/// fine ones, and straightening the long ones further would not make room: the short ones go.
inline constexpr double kCoarsestTolerance = 1.0 / 64;

/// As a part of the diagonal: shorter creases and crests are roughness, not form.
inline constexpr double kShortestForm = 0.03;

/// The sector within its tile of each own vertex, by the tile's NodeId::index; empty: each tile is
/// one sector.
using Sectors = std::vector<std::vector<std::uint16_t>>;

/// Collects sectors one by one, then makes the outline. A builder is for one thread; sectors may be
/// made on many. The result does not depend on the order of add().
class OutlineBuilder {
 public:
  /// The parts of one tile that make lines.
  class Sector {
   public:
    /// `index`: the NodeId::index of the tile; ghosts refer to others by theirs. `sectors`: the
    /// same for all tiles. O(t log b), t its triangles, b those in several sectors.
    Sector(std::uint32_t index, const TileMesh& tile, const Sectors& sectors = {});
    Sector(Sector&&) noexcept;
    Sector& operator=(Sector&&) noexcept;
    ~Sector();

   private:
    friend class OutlineBuilder;
    struct Content;
    std::unique_ptr<Content> content_;
  };

  OutlineBuilder();
  OutlineBuilder(OutlineBuilder&&) noexcept;
  OutlineBuilder& operator=(OutlineBuilder&&) noexcept;
  ~OutlineBuilder();

  /// All sectors must be of one level, each added once.
  void add(Sector sector);

  /// Those of the whole surface, once.
  void add(std::vector<CrestLine> crests);

  /// Counts what is held so far: triangles in several sectors, borders and creases. join() holds
  /// up to 220 bytes for such a triangle.
  std::size_t edge_count() const;

  /// Joins the sectors, and leaves none here. Returns the number of line segments: finish() holds
  /// some 45 bytes for each. An open mesh has up to nine for a border triangle.
  std::size_t join();

  /// Makes the outline of what was joined, once. First come the polylines between junctions, then
  /// the closed ones without, both ordered by the tile and index of the vertices at their start.
  /// Closed ones keep at least a triangle, others their ends. O(s log s) in the number of line
  /// segments. Throws Error(internal) if a border triangle's ghost is in no added sector's
  /// boundary.
  OutlineResult finish(const OutlineOptions& options);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace meshhier::outline

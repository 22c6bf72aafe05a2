// A finished hierarchy's words about itself and each tile, as values.
#pragma once

#include "base/bounds.h"
#include "hierarchy/ghost_chains.h"
#include "hierarchy/shading.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/texture.h"
#include "hierarchy/tile_mesh.h"
#include "hierarchy/tile_objects.h"
#include "hierarchy/tree.h"
#include "hierarchy/unit.h"
#include "hierarchy/value_statistics.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier {

/// The index entry of one tile (tiles.bin).
struct TileRecord {
  NodeId node;
  std::uint32_t own_count = 0;
  std::uint32_t boundary_count = 0;
  std::uint32_t ghost_count = 0;
  std::uint32_t copy_count = 0;      ///< vertices at places that have one already
  std::uint32_t split_count = 0;     ///< further normals and texture coordinates of vertices
  std::uint32_t interior_count = 0;  ///< triangles
  std::uint32_t border_count = 0;    ///< triangles, each also listed in the tiles of its ghosts
  std::uint32_t drawn_border_count =
      0;                           ///< those of them that this tile draws in its own level's cut
  std::uint32_t target_count = 0;  ///< vertices asked for; differs from own_count if not reached
  Bounds bounds;                   ///< of all its vertices, relative to the origin
  std::uint32_t torn_count = 0;    ///< vertices that went by changing the surface's topology
  std::uint32_t forced_count = 0;  ///< vertices that went without care for the surface, to reach
                                   ///< the count
  float error = 0;  ///< estimated distance to the original surface, input units; grows from
                    ///< children to parents; 0 for partitions
  float bound = 0;  ///< certain upper bound of the Hausdorff distance to the original surface,
                    ///< input units; grows likewise; 0 for partitions
  float compactness =
      0;  ///< p^2 / (4 pi w) of a partition; 0 if it has no area, and for other tiles
  std::uint32_t image_width = 0, image_height = 0;  ///< of its picture, texels; 0: it has none
  float texel = 0;  ///< mean size of the picture's texels on the surface, input units; 0 without
  bool has_normal_map = false;  ///< `image` and `texel` are those of its normal map, too
  std::uint64_t file_bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of the tile's file
};

/// One tile file, decoded: all that a viewer needs to draw the tile in any cut.
///
/// The drawing rule. A cut shows tiles of any levels that cover each partition once. A tile A of
/// the cut draws all of mesh.interior. It draws a triangle of mesh.border if and only if each ghost
/// of the triangle belongs to a tile B of A's level (mesh.ghosts) whose region the cut shows
///
///   as B itself, and B has a larger index than A: the ghost stays where B has it; or
///   coarser, as an ancestor of B n levels up: the ghost moves to its vertex chains[ghost][n].
///
/// If B's region is shown finer, a tile in there draws the triangle. A triangle whose corners lay
/// at different places and come to one has vanished and is not drawn.
///
///   the input       2/0 | 2/1 | 2/2 | 2/3      a triangle t with corners in 2/1 and 2/2
///   cut of level 2  2/0 [2/1]| 2/2 | 2/3       2/1 draws t: both are shown, 1 < 2
///   a mixed cut     2/0 [2/1]|    1/1          2/1 draws t; its corner in 2/2 is a vertex of 1/1
///   another         [  1/0  ]|    1/1          1/0 draws what t has become on level 1
///
/// So the finest of the shown tiles that t touches draws it, of equals the one with the lowest
/// index. The corners alone say which tiles those are: every image of t comes to the same tile, t
/// is drawn once, and all that is drawn is the image of the input under one map of vertices. A
/// surface that is closed in the input is closed in every cut. An early node has no tile: its
/// partition is shown for it, which is finer, and neighbours leave the border to that.
struct PublishedTile {
  NodeId node;
  TileMesh mesh;
  std::vector<std::uint16_t>
      parent_map;      ///< own vertex -> vertex of the parent's tile; empty for the root
  GhostChains chains;  ///< one per ghost
  Shading shading;     ///< as far as the build computed normals, pictures or normal maps
  TileImage image;     ///< empty unless the mesh is textured
  /// From where the model is looked at first: of the root, unless an older program made it.
  std::optional<Standpoint> first_view{};
  TileImage normal_map{};  ///< empty unless the tile has one: opaque
  TileObjects objects{};   ///< empty unless the hierarchy's tiles have tables of them
};

/// Leaves a tile what its vertices have.
inline void drop_pictures(PublishedTile& tile) {
  tile.image = {};
  tile.normal_map = {};
  tile.shading.texcoords.clear();
  tile.shading.tangents.clear();
}

/// A file that was imported.
struct SourceFile {
  std::string name;
  std::string format;  ///< for people: "OBJ (gzip)"
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;  ///< storage::FileChecksum
};

/// A count of an import, by name.
struct SourceCount {
  std::string name;  ///< "split_vertices"
  std::uint64_t count = 0;
};

/// The textures of the input.
struct SourceTextures {
  std::uint64_t materials = 0;       ///< that triangles use
  std::uint64_t images = 0;          ///< of these
  std::uint64_t missing_images = 0;  ///< of these, shown by their material's colour
  std::uint64_t texels = 0;          ///< of all images that are there
  friend bool operator==(const SourceTextures&, const SourceTextures&) = default;
};

/// The input that a hierarchy was built from.
struct SourceSummary {
  std::string file_name;         ///< of several files, with ", " between them
  std::uint64_t file_bytes = 0;  ///< of all files
  std::uint64_t checksum = 0;    ///< storage::FileChecksum; of several files XXH3-64 over theirs, 8
                                 ///< bytes each, little endian
  std::uint64_t vertices = 0;
  std::uint64_t places = 0;     ///< where vertices lie, <= vertices: what the tree counts
  std::uint64_t triangles = 0;  ///< kept, after polygons became fans
  std::uint64_t faces = 0;      ///< as the file counts them
  std::uint64_t degenerate_triangles = 0;  ///< dropped: two corners are the same vertex
  std::uint64_t unreferenced_vertices = 0;
  BoundsD bounds;                          ///< input coordinates
  bool double_precision = false;           ///< coordinates do not fit float exactly
  std::optional<Unit> units;               ///< of coordinates, if the format says it
  AttributeLayout attributes;              ///< without texture coordinates if it has textures
  std::vector<ValueStatistics> values{};   ///< of each of attributes.values
  std::optional<SourceTextures> textures;  ///< none: no picture, or the build was to ignore them
  std::vector<SourceFile> files;  ///< in their order; empty: one PLY that was read in place
  std::vector<SourceCount>
      counts;  ///< of an import, and of what became 0: those that are not 0; by name
  std::vector<std::string> unused;  ///< what the input has besides, for people: "vertex.intensity"

  /// The length of the bounding box's diagonal.
  double diagonal() const { return length(bounds.max - bounds.min); }
  /// One of `counts`; 0 if there is none of that name.
  std::uint64_t count_of(std::string_view name) const {
    const auto found = std::ranges::find(counts, name, &SourceCount::name);
    return found == counts.end() ? 0 : found->count;
  }
};

}  // namespace meshhier

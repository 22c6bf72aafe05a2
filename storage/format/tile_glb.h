// A tile as a glTF 2.0 binary with the extension MESHHIER_tile (docs/file_format.md).
#pragma once

#include "base/bounds.h"
#include "hierarchy/attributes.h"
#include "hierarchy/frame.h"
#include "hierarchy/lattice.h"
#include "hierarchy/object_row.h"
#include "hierarchy/published.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/texture.h"
#include "hierarchy/tile_objects.h"
#include "hierarchy/tree.h"
#include "storage/format/tile_compression.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// The most own vertices of a tile: parent maps and ghost chains hold their numbers in 16 bits.
inline constexpr std::uint32_t kMaxOwnVertices = 32768;

/// The facts that all tiles of a hierarchy share, without which none can be read.
struct TileFormat {
  AttributeLayout attributes;
  Frame frame;  ///< the node's; Manifest::tile_frame()
  Compression compression = Compression::none;
  std::optional<Lattice> lattice{};  ///< all positions lie on it, if they are quantized
  bool computed_normals = false;     ///< Shading has normals; `attributes` has none then
  /// Tiles with triangles have a picture and a Shading with texture coordinates; `attributes` has
  /// none then.
  std::optional<TextureFormat> textures{};
  /// Format versions up to 7: tiles hold colours as screens have them, else as TileColours says.
  bool screen_colours = false;
  /// Tiles above the partitions may have a normal map, of the sides of their picture if they have
  /// one.
  std::optional<NormalMapFormat> normal_maps{};
  /// Tiles have a table of their objects, which have these properties. Requires an object among the
  /// values.
  std::optional<std::vector<ObjectProperty>> objects{};
};

/// The parts of a tile that its file is made of.
struct TileView {
  NodeId node;
  const TileMesh& mesh;
  const Shading& shading;                     ///< as far as the format says
  const TileImage& image;                     ///< likewise
  Bounds bounds;                              ///< box of the mesh's positions
  std::span<const std::uint16_t> parent_map;  ///< as PublishedTile's
  std::span<const std::uint16_t> chains;      ///< the ghosts' chains, one after another
  std::optional<Standpoint> first_view{};     ///< as PublishedTile's
  const TileImage* normal_map = nullptr;      ///< none, or null: it has none
  const TileObjects* objects = nullptr;       ///< as far as the format says
};

/// Returns the bytes of a tile's file. Deterministic, O(size), thread-safe. Compressed files depend
/// on the versions of zlib and meshoptimizer. Requires a consistent tile (see PublishedTile) with
/// finite positions, on the lattice if there is one, at most kMaxOwnVertices own vertices and
/// boundary vertices below that. Its shading has normals and texture coordinates, and it has a
/// picture, if and only if the format says so; equal triangles have equal shading.
///
/// A partition keeps every attribute bit for bit, NaN included. Other tiles keep what glTF can say:
/// u8 and u16 colours are rounded to the nearest number of their type, float colours clamped to [0,
/// 1], normals brought to unit length ((0, 0, 1) if they have none), NaN and infinities become 0;
/// tile_values.h says what becomes of quantities; labels stay as they are.
std::vector<std::byte> encode_tile(const TileView& tile, const Tree& tree,
                                   const TileFormat& format);
std::vector<std::byte> encode_tile(const PublishedTile& tile, const Tree& tree,
                                   const TileFormat& format);

/// Parses the file of `node`'s tile, which nobody vouches for: every count, offset and index is
/// checked before it is used, every size before memory is taken for it. The picture is not decoded.
/// Requires tree.contains(node). Thread-safe. Throws Error(corrupt) that starts with `name` and
/// says what was expected.
PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                          const TileFormat& format, const std::string& name);

}  // namespace meshhier::storage

// A tile as a glTF 2.0 binary with the extension MESHHIER_tile (docs/file_format.md).
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/bounds.h"
#include "hierarchy/frame.h"
#include "hierarchy/lattice.h"
#include "hierarchy/published.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/texture.h"
#include "hierarchy/tree.h"
#include "storage/format/tile_compression.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::storage {

/// Own vertices of a tile, at most: parent maps and ghost chains hold their numbers in 16 bits.
inline constexpr std::uint32_t kMaxOwnVertices = 32768;

/// What all tiles of a hierarchy share.
struct TileFormat {
  AttributeLayout attributes;
  Frame frame;  ///< the node's; Manifest::tile_frame()
  Compression compression = Compression::none;
  std::optional<Lattice> lattice{};  ///< what all positions lie on, if they are quantized
  bool computed_normals = false;     ///< Shading has normals; `attributes` has none then
  /// Tiles with triangles have a picture and a Shading with texture coordinates; `attributes` has
  /// none then.
  std::optional<TextureFormat> textures{};
  /// Format versions up to 7: tiles hold colours as screens have them, else as TileColours says.
  bool screen_colours = false;
  /// Tiles above the partitions may have a normal map; none has a picture then.
  std::optional<NormalMapFormat> normal_maps{};
};

/// What a tile's file is made of.
struct TileView {
  NodeId node;
  const TileMesh& mesh;
  const Shading& shading;                     ///< as far as the format says
  const TileImage& image;                     ///< likewise
  Bounds bounds;                              ///< of the mesh's positions
  std::span<const std::uint16_t> parent_map;  ///< as PublishedTile's
  std::span<const std::uint16_t> chains;      ///< the ghosts' chains, one after another
  std::optional<Standpoint> first_view{};     ///< as PublishedTile's
  const TileImage* normal_map = nullptr;      ///< none, or null: it has none
};

/// Deterministic, O(size). Requires a consistent tile (see PublishedTile) with finite positions, on
/// the lattice if there is one, at most kMaxOwnVertices own vertices and boundary vertices below
/// that, and normals and texture coordinates in its shading, and a picture, if and only if the
/// format says so, equal of equal triangles. Compressed files depend on the versions of zlib and
/// meshoptimizer.
///
/// A partition keeps every attribute bit for bit, NaN included. Other tiles keep what glTF can say:
/// u8 and u16 colours rounded to the nearest number of their type, float colours clamped to [0, 1],
/// normals brought to unit length ((0, 0, 1) if they have none), NaN and infinities as 0;
/// quantities as tile_values.h says, and labels as they are.
std::vector<std::byte> encode_tile(const TileView& tile, const Tree& tree,
                                   const TileFormat& format);
std::vector<std::byte> encode_tile(const PublishedTile& tile, const Tree& tree,
                                   const TileFormat& format);

/// The inverse of encode_tile, on bytes nobody vouches for: every count, offset and index is
/// checked before it is used, every size before memory is taken for it; but for what is in the
/// picture, which is not decoded. Requires tree.contains(node). Throws Error(corrupt) that starts
/// with `name` and says what was expected.
PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                          const TileFormat& format, const std::string& name);

}  // namespace meshhier::storage

// The places of everything in a tile's GLB: a function of a few counts, for the writer and the
// reader.
#pragma once

#include "base/bounds.h"
#include "hierarchy/attributes.h"
#include "hierarchy/frame.h"
#include "hierarchy/ids.h"
#include "hierarchy/lattice.h"
#include "hierarchy/standpoint.h"
#include "hierarchy/texture.h"
#include "storage/format/tile_colours.h"
#include "storage/format/tile_object_table.h"
#include "storage/format/tile_sums.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace meshhier::storage {

inline constexpr const char* kTileExtension = "MESHHIER_tile";
/// Hierarchies with tables of objects.
inline constexpr unsigned kTileExtensionVersion = 7;
/// No tables; normal maps.
inline constexpr unsigned kNoObjectsVersion = 6;
/// No normal maps; tiles with values.
inline constexpr unsigned kNoMapsVersion = 5;
/// No values either.
inline constexpr unsigned kNoValuesVersion = 4;
/// No values either, and colours as screens have them.
inline constexpr unsigned kScreenColoursVersion = 3;
inline unsigned tile_version(const AttributeLayout& layout, bool screen_colours, bool has_maps,
                             bool has_objects) {
  return has_objects             ? kTileExtensionVersion
         : has_maps              ? kNoObjectsVersion
         : screen_colours        ? kScreenColoursVersion
         : layout.values.empty() ? kNoValuesVersion
                                 : kNoMapsVersion;
}
inline constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";
inline constexpr const char* kQuantizationExtension = "KHR_mesh_quantization";

// The BIN chunk: one section, and one buffer view, for each of these that is not empty, in this
// order, each starting at a multiple of 4. o, g: own places, ghosts; c: copies at either; n = o + g
// + c: vertices, in this order; s: splits of vertices, which have computed normals, and tangents
// and coordinates in the tile's picture or normal map of their own; N = n + s; m: neighbours.
//
//   section        elements          of
//   position       N                 3 f32; 3 u16, stride 8, on a lattice of up to 16 bits
//   normal         N                 3 f32; computed ones 3 i8, stride 4
//   tangent        N or none         4 i8: of tiles with a normal map
//   colour         N                 3 or 4 u8, u16 or f32; the stride is rounded up to 4
//   texcoord       N                 2 f32; of textured tiles those in their picture, and map
//   map_texcoord   N or none         2 u16: of tiles with a normal map and no picture
//   feature        N or none         u16, stride 4, or f32: rows in the table of objects
//   interior       3 a triangle      u16 if N <= 65535, else u32
//   border         3 a triangle      the same
//   values         N                 4 bytes for each value, of which its component type may take
//                                    fewer
//   parent_map     o, root: none     u16
//   neighbours     m                 u32, ascending
//   ghost_starts   m + 1, m = 0: 0   u32
//   ghost_chains   a chain a ghost   u16, Tree::chain_length entries a chain
//   copy_of        c                 u16 if o + g <= 65535, else u32; ascending
//   split_of       s                 u16 if n <= 65535, else u32; ascending
//   raw_normals    n or none         3 f32
//   raw_colours    n or none         3 or 4 f32
//   raw_texcoords  n or none         2 f32
//   raw_values     n or none         f32 or f64 for each value
//   objects        its bytes         u8, from a multiple of 8 on: tile_object_table.h
//   image          its bytes         u8, a picture as it is
//   normal_map     its bytes         u8, the same
enum class TilePart : std::size_t {
  position,
  normal,
  tangent,
  colour,
  texcoord,
  map_texcoord,
  feature,
  interior,
  border,
  values,
  parent_map,
  neighbours,
  ghost_starts,
  ghost_chains,
  copy_of,
  split_of,
  raw_normals,
  raw_colours,
  raw_texcoords,
  raw_values,
  objects,
  image,
  normal_map
};
inline constexpr std::size_t kPartCount = 23;
inline constexpr auto kPartsEnd = static_cast<TilePart>(kPartCount);
constexpr TilePart next(TilePart part) {
  return static_cast<TilePart>(static_cast<std::size_t>(part) + 1);
}

/// A coordinate of 1 in a normal map is stored as this.
inline constexpr float kMaxMapTexcoord = 65535;

/// The key of a part in the extension (from values on), or the name of its attribute (up to
/// feature) where it is shown.
const char* key_of(TilePart part);

/// The kinds of attributes that have a section for each vertex: as glTF shows them, and in
/// partitions, if it cannot hold them as they are, as they were. Values lie in one section
/// together.
struct AttributeSection {
  AttributeKind kind;
  TilePart part, raw;
};
inline constexpr std::array kAttributeSections{
    AttributeSection{AttributeKind::normals, TilePart::normal, TilePart::raw_normals},
    AttributeSection{AttributeKind::colours, TilePart::colour, TilePart::raw_colours},
    AttributeSection{AttributeKind::texcoords, TilePart::texcoord, TilePart::raw_texcoords}};

/// The channels of one attribute within a vertex, and where they are written.
struct ChannelGroup {
  AttributeKind kind{};
  TilePart part{}, raw{};
  std::size_t offset = 0;
  std::size_t channels = 0;
};
using ChannelGroups = std::array<ChannelGroup, kAttributeSections.size()>;

/// A part of a tile of compressed sections is stored as it is, or in a mode of
/// EXT_meshopt_compression. The raw ones have a few bytes, or are compressed already.
enum class ViewMode { raw, attributes, triangles, indices };
ViewMode mode_of(TilePart part);

/// Returns what a part's buffer view is a target for, as glTF has it; 0: nothing.
unsigned target_of(TilePart part);

/// Returns where a part begins behind what ends there: at a multiple of 4, of 8 for tables.
std::uint64_t begin_of(TilePart part, std::uint64_t end);

/// The BIN chunk of a tile of compressed sections: these, each from its begin_of() on, in the order
/// of the parts.
struct Packing {
  std::array<std::uint64_t, kPartCount> bytes{};  ///< size of each section in the file
  bool exponential = false;                       ///< positions went through the filter EXPONENTIAL

  std::uint64_t offset(TilePart part) const;
  /// Returns the bytes of the BIN chunk.
  std::uint64_t total() const;
};

/// Returns the component type in which a kind is shown.
unsigned component_of(AttributeKind kind, const TileColours& colours);

/// Returns a group for each of kAttributeSections; those the layout lacks have no channels.
ChannelGroups groups_of(const AttributeLayout& layout);

/// The picture of a textured tile that has triangles, or a normal map.
struct ImageShape {
  std::uint64_t bytes = 0;  ///< 0: there is none
  std::uint32_t width = 0, height = 0;
  AlphaMode alpha = AlphaMode::opaque;
};

/// The numbers from which the place of everything in the file follows; each below 2^32, so that no
/// size overflows 64 bits.
struct TileShape {
  NodeId node;
  std::uint64_t own = 0, boundary = 0, ghosts = 0, neighbours = 0, chain_entries = 0;
  std::uint64_t interior = 0, border = 0, copies = 0, splits = 0;
  std::array<bool, kAttributeSections.size()>
      raw{};  ///< per ChannelGroup: whether its raw part is there
  bool raw_values = false;
  bool computed_normals = false;
  std::optional<TextureFormat> textures{};  ///< the hierarchy's
  ImageShape image{};
  std::optional<Standpoint> first_view{};        ///< only in the root
  bool screen_colours = false;                   ///< the hierarchy's, see TileFormat
  std::optional<NormalMapFormat> normal_maps{};  ///< likewise
  ImageShape normal_map{};
  std::optional<ObjectTableShape> objects{};  ///< if the hierarchy's tiles have tables

  /// Whether there can be splits.
  bool is_shaded() const { return computed_normals || textures || normal_maps; }
  bool has_image() const { return image.bytes > 0; }
  bool has_normal_map() const { return normal_map.bytes > 0; }
  /// Whether coordinates are those of a normal map alone; beside a picture it has the picture's.
  bool has_map_texcoords() const { return has_normal_map() && !has_image(); }
  std::uint64_t places() const { return own + ghosts; }
  std::uint64_t vertices() const { return places() + copies; }
  /// Corners of triangles are numbers below this.
  std::uint64_t with_splits() const { return vertices() + splits; }
};

struct Section {
  unsigned component = 0;   ///< glTF component type
  unsigned components = 0;  ///< per element
  std::uint64_t count = 0;  ///< elements
  std::uint64_t stride = 0;
  std::uint64_t offset = 0;
  int view = -1;  ///< number of the buffer view; -1 if empty

  std::uint64_t bytes() const { return count * stride; }
};

class TilePlan {
 public:
  /// `lattice`: all positions lie on it, if there is one.
  TilePlan(const TileShape& shape, const AttributeLayout& layout,
           const std::optional<Lattice>& lattice = std::nullopt);

  const TileShape& shape() const { return shape_; }
  const AttributeLayout& layout() const { return layout_; }
  TileColours colours() const { return {layout_, shape_.screen_colours}; }
  const std::optional<Lattice>& lattice() const { return lattice_; }
  /// Whether positions are the lattice's numbers in 16 bits.
  bool has_short_positions() const { return lattice_ && lattice_->is_short(); }
  const Section& operator[](TilePart part) const {
    return sections_[static_cast<std::size_t>(part)];
  }
  /// The number of views with a section each; those of the columns of objects follow.
  int views() const { return views_; }
  /// Bytes of the BIN chunk if nothing is compressed.
  std::uint64_t bytes() const { return bytes_; }

  /// Returns the file's JSON. `bounds`: the box of the positions. `packing`: null unless sections
  /// are compressed.
  nlohmann::ordered_json document(const Bounds& bounds, const Frame& frame,
                                  const Packing* packing = nullptr) const;

 private:
  void add(TilePart part, unsigned component, std::size_t components, std::uint64_t count);

  TileShape shape_;
  AttributeLayout layout_;
  std::optional<Lattice> lattice_;
  std::array<Section, kPartCount> sections_;
  std::uint64_t bytes_ = 0;
  int views_ = 0;
};

/// These turn a coordinate in a normal map, in 0 ... 1, into the number in a file, and back.
inline std::uint16_t map_texcoord_number(float texcoord) {
  return static_cast<std::uint16_t>(texcoord * kMaxMapTexcoord + 0.5f);
}
inline float map_texcoord(std::uint16_t number) {
  return static_cast<float>(number) / kMaxMapTexcoord;
}

/// Returns the bytes of a vertex in a tile's file, beside its position.
std::uint64_t published_attribute_bytes(const AttributeLayout& layout);
/// Returns the bytes of the tiles' files, not compressed. `attribute_bytes`:
/// published_attribute_bytes(). Attributes that glTF cannot hold as they are count once.
double expected_tile_bytes(const TileSums& tiles, std::uint64_t attribute_bytes);
/// Returns the bytes of a split.
double expected_split_bytes(std::uint64_t attribute_bytes);

}  // namespace meshhier::storage

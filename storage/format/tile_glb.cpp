#include "storage/format/tile_glb.h"

#include "hierarchy/error.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "storage/format/tile_pack.h"
#include "storage/format/tile_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

// ---- attributes ----------------------------------------------------------------------------

Vec3f showable_normal(Vec3f normal) {
  if (is_unit_normal(normal))
    return normal;
  const Vec3d wide = to_double(normal);
  const double size = length(wide);
  if (!(size > 0) || !std::isfinite(size))
    return {0, 0, 1};
  return to_float(wide * (1 / size));
}

float showable_colour(float value, ColourType type) {
  if (std::isnan(value))
    return 0;
  if (type == ColourType::f32)
    return std::clamp(value, 0.0F, 1.0F);
  return std::clamp(std::round(value), 0.0F, type == ColourType::u8 ? 255.0F : 65535.0F);
}

/// One vertex's attributes as the standard glTF accessors hold them.
void make_showable(const AttributeLayout& layout, std::span<float> channels) {
  if (layout.normals) {
    float* n = channels.data() + layout.normal_offset();
    const Vec3f normal = showable_normal({n[0], n[1], n[2]});
    n[0] = normal.x;
    n[1] = normal.y;
    n[2] = normal.z;
  }
  for (int i = 0; i < layout.colour_channels(); ++i) {
    float& value = channels[static_cast<std::size_t>(layout.colour_offset() + i)];
    value = showable_colour(value, layout.colour);
  }
  for (int i = 0; layout.texcoords && i < 2; ++i) {
    float& value = channels[static_cast<std::size_t>(layout.texcoord_offset() + i)];
    if (!std::isfinite(value))
      value = 0;
  }
}

std::vector<float> showable_attributes(const AttributeLayout& layout, const VertexArray& vertices) {
  std::vector<float> shown = vertices.attributes;
  const auto channels = static_cast<std::size_t>(layout.channels());
  for (std::size_t v = 0; channels > 0 && v < vertices.size(); ++v) {
    make_showable(layout, std::span(shown).subspan(v * channels, channels));
  }
  return shown;
}

/// Whether the group's channels of any vertex changed by as much as a bit.
bool differs(std::span<const float> a, std::span<const float> b, const ChannelGroup& group,
             int channels) {
  for (std::size_t v = 0; v < a.size(); v += static_cast<std::size_t>(channels)) {
    for (std::size_t i = v + group.offset; i < v + group.offset + group.channels; ++i) {
      if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]))
        return true;
    }
  }
  return false;
}

// ---- writing -------------------------------------------------------------------------------

/// Writes a tile's sections into the BIN chunk of its file.
class Writer {
 public:
  Writer(const TilePlan& plan, std::span<std::byte> bin) : plan_(plan), bin_(bin) {}

  void put_positions(std::span<const Vec3f> positions) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    const Section& section = plan_[Part::position];
    if (plan_.has_short_positions())
      return put_numbers(section, positions);
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(at(section), positions.data(), positions.size_bytes());
    } else {
      for (std::size_t v = 0; v < positions.size(); ++v) {
        const std::array<float, 3> p{positions[v].x, positions[v].y, positions[v].z};
        store_all_little(std::span<const float>(p), at(section) + v * section.stride);
      }
    }
  }

  /// Writes the group's channels into `part`, in that section's component type.
  void put_group(Part part, const ChannelGroup& group, std::span<const float> attributes) {
    const Section& section = plan_[part];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    for (std::size_t v = 0; v < section.count; ++v) {
      for (std::size_t c = 0; c < section.components; ++c) {
        const float value = attributes[v * channels + group.offset + c];
        if (section.component == kU8)
          put(section, v, c, static_cast<std::uint8_t>(value));
        if (section.component == kU16)
          put(section, v, c, static_cast<std::uint16_t>(value));
        if (section.component == kF32)
          put(section, v, c, value);
      }
    }
  }

  void put_triangles(Part part, std::span<const TileTriangle> triangles) {
    const Section& section = plan_[part];
    section.component == kU16 ? put_corners<std::uint16_t>(section, triangles)
                              : put_corners<std::uint32_t>(section, triangles);
  }

  template <Scalar T>
  void put_list(Part part, std::span<const T> values) {
    store_all_little(values, at(plan_[part]));
  }

 private:
  std::byte* at(const Section& section) { return bin_.data() + section.offset; }

  template <Scalar T>
  void put(const Section& section, std::size_t element, std::size_t component, T value) {
    store_little(value, at(section) + element * section.stride + component * sizeof(T));
  }

  void put_numbers(const Section& section, std::span<const Vec3f> positions) {
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3<std::uint32_t> n = plan_.lattice()->numbers_of(positions[v]);
      for (int axis = 0; axis < 3; ++axis)
        put(section, v, static_cast<std::size_t>(axis), static_cast<std::uint16_t>(n[axis]));
    }
  }

  template <class Index>
  void put_corners(const Section& section, std::span<const TileTriangle> triangles) {
    std::byte* to = at(section);
    for (const TileTriangle& t : triangles) {
      for (const TileVertex corner : t) {
        const auto index = static_cast<Index>(raw(corner));
        store_all_little(std::span<const Index>(&index, 1), to);
        to += sizeof index;
      }
    }
  }

  const TilePlan& plan_;
  std::span<std::byte> bin_;
};

/// The ghosts by neighbour: those of tiles[i] are [starts[i], starts[i + 1]).
struct GhostGroups {
  std::vector<std::uint32_t> tiles;
  std::vector<std::uint32_t> starts;
};

GhostGroups group_ghosts(std::span<const GhostRef> ghosts) {
  GhostGroups groups;
  for (std::size_t i = 0; i < ghosts.size(); ++i) {
    if (i > 0 && ghosts[i].tile == ghosts[i - 1].tile)
      continue;
    groups.tiles.push_back(ghosts[i].tile);
    groups.starts.push_back(static_cast<std::uint32_t>(i));
  }
  if (!ghosts.empty())
    groups.starts.push_back(static_cast<std::uint32_t>(ghosts.size()));
  return groups;
}

// ---- reading -------------------------------------------------------------------------------

/// Reads one tile's bytes whose extents were compared with the plan.
class Reader {
 public:
  Reader(const TilePlan& plan, std::span<const std::byte> bin, const Tree& tree,
         const std::string& name)
      : plan_(plan), bin_(bin), tree_(tree), name_(name) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::corrupt, name_ + ": " + what);
  }

  template <Scalar T>
  T get(const Section& section, std::size_t element, std::size_t component = 0) const {
    return load_little<T>(bin_.data() + section.offset + element * section.stride +
                          component * sizeof(T));
  }

  std::vector<Vec3f> positions() const {
    const Section& section = plan_[Part::position];
    std::vector<Vec3f> positions(section.count);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] = position(section, v);
      if (!std::isfinite(positions[v].x) || !std::isfinite(positions[v].y) ||
          !std::isfinite(positions[v].z)) {
        fail(fmt::format("position of vertex {} is not finite", v));
      }
      if (plan_.lattice() && plan_.lattice()->nearest(positions[v]) != positions[v])
        fail(fmt::format("position of vertex {} is not on the lattice", v));
    }
    return positions;
  }

  std::vector<float> attributes() const {
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    std::vector<float> attributes(plan_.shape().vertices() * channels);
    const auto groups = groups_of(plan_.layout());
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const bool is_raw = plan_.shape().raw[i];
      read_group(groups[i], groups[i].part, true, attributes);
      if (is_raw)
        read_group(groups[i], groups[i].raw, false, attributes);
    }
    return attributes;
  }

  /// Canonical, ascending triangles of which every corner is a vertex. `is_packed`: as the codec
  /// gave them, turned and in another order; else they must be so in the file.
  std::vector<TileTriangle> triangles(Part part, bool is_packed) const {
    const Section& section = plan_[part];
    std::vector<TileTriangle> triangles(section.count / 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t index = section.component == kU16
                                        ? get<std::uint16_t>(section, 3 * t + c)
                                        : get<std::uint32_t>(section, 3 * t + c);
        if (index >= plan_.shape().vertices()) {
          fail(fmt::format("index {} of {} triangle {} is not below the {} vertices", index,
                           key_of(part), t, plan_.shape().vertices()));
        }
        triangles[t][c] = static_cast<TileVertex>(index);
      }
      if (is_packed)
        triangles[t] = canonical(triangles[t]);
    }
    if (is_packed)
      std::sort(triangles.begin(), triangles.end());
    for (std::size_t t = 0; t < triangles.size(); ++t)
      check_triangle(part, t, triangles);
    return triangles;
  }

  std::vector<std::uint16_t> parent_map() const {
    return short_list(Part::parent_map, "parent map");
  }

  void read_ghosts(PublishedTile& tile) const {
    const Section& neighbours = plan_[Part::neighbours];
    const Section& starts = plan_[Part::ghost_starts];
    const std::vector<std::uint16_t> chains = short_list(Part::ghost_chains, "ghost chain");
    tile.mesh.ghosts.reserve(plan_.shape().ghosts);
    tile.chains.reserve(plan_.shape().ghosts, chains.size());
    std::span<const std::uint16_t> left = chains;
    for (std::size_t i = 0; i < neighbours.count; ++i) {
      const auto index = get<std::uint32_t>(neighbours, i);
      const bool ascends = i == 0 || index > get<std::uint32_t>(neighbours, i - 1);
      const NodeId neighbour{plan_.shape().node.level, index};
      if (!tree_.contains(neighbour) || neighbour == plan_.shape().node || !ascends) {
        fail(fmt::format(
            "neighbour {} is tile {}, which is not another one of the level, ascending", i, index));
      }
      const std::uint64_t begin = get<std::uint32_t>(starts, i);
      const std::uint64_t end = get<std::uint32_t>(starts, i + 1);
      if (begin != tile.mesh.ghosts.size() || end <= begin || end > plan_.shape().ghosts) {
        fail(fmt::format("ghosts {} to {} of neighbour {} are not a run of the {} from {} on",
                         begin, end, i, plan_.shape().ghosts, tile.mesh.ghosts.size()));
      }
      read_neighbour(neighbour, end - begin, left, tile);
    }
    if (tile.mesh.ghosts.size() != plan_.shape().ghosts || !left.empty()) {
      fail(fmt::format("the neighbours account for {} of {} ghosts and leave {} chain entries",
                       tile.mesh.ghosts.size(), plan_.shape().ghosts, left.size()));
    }
  }

 private:
  /// Takes `count` chains from the front of `left`.
  void read_neighbour(NodeId neighbour, std::size_t count, std::span<const std::uint16_t>& left,
                      PublishedTile& tile) const {
    const auto length = static_cast<std::size_t>(tree_.chain_length(tile.node, neighbour));
    const bool stays = tree_.stands_for_parent(neighbour);
    if (left.size() / length < count) {
      fail(fmt::format("tile {} needs {} chains of {} entries, {} entries are left",
                       neighbour.index, count, length, left.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto chain = left.first(length);
      left = left.subspan(length);
      if (i > 0 && chain[0] <= tile.mesh.ghosts.back().index) {
        fail(
            fmt::format("ghosts of tile {} do not ascend at vertex {}", neighbour.index, chain[0]));
      }
      if (stays && length > 1 && chain[1] != chain[0]) {
        fail(fmt::format("vertex {} of tile {} changes its number to {} without a parent tile",
                         chain[0], neighbour.index, chain[1]));
      }
      tile.mesh.ghosts.push_back({neighbour.index, chain[0]});
      tile.chains.add(chain);
    }
  }

  Vec3f position(const Section& section, std::size_t v) const {
    if (!plan_.has_short_positions()) {
      return {get<float>(section, v, 0), get<float>(section, v, 1), get<float>(section, v, 2)};
    }
    return plan_.lattice()->point({get<std::uint16_t>(section, v, 0),
                                   get<std::uint16_t>(section, v, 1),
                                   get<std::uint16_t>(section, v, 2)});
  }

  /// `require_finite`: of what viewers read; raw values may be anything.
  void read_group(const ChannelGroup& group, Part part, bool require_finite,
                  std::span<float> attributes) const {
    const Section& section = plan_[part];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    for (std::size_t v = 0; v < section.count; ++v) {
      for (std::size_t c = 0; c < section.components; ++c) {
        float& value = attributes[v * channels + group.offset + c];
        value = section.component == kU8    ? get<std::uint8_t>(section, v, c)
                : section.component == kU16 ? get<std::uint16_t>(section, v, c)
                                            : get<float>(section, v, c);
        if (require_finite && !std::isfinite(value)) {
          fail(fmt::format("{} of vertex {} is not finite", key_of(part), v));
        }
      }
    }
  }

  void check_triangle(Part part, std::size_t t, std::span<const TileTriangle> triangles) const {
    const TileTriangle& triangle = triangles[t];
    if (is_degenerate(triangle) || triangle != canonical(triangle) ||
        (t > 0 && triangle < triangles[t - 1])) {
      fail(fmt::format("{} triangle {} ({}, {}, {}) is degenerate, turned or out of order",
                       key_of(part), t, raw(triangle[0]), raw(triangle[1]), raw(triangle[2])));
    }
    std::uint64_t own = 0, boundary = 0;
    for (const TileVertex corner : triangle) {
      own += raw(corner) < plan_.shape().own ? 1 : 0;
      boundary += raw(corner) < plan_.shape().boundary ? 1 : 0;
    }
    const bool fits = part == Part::interior ? own == 3 : own == boundary && (own == 1 || own == 2);
    if (!fits) {
      fail(fmt::format("{} triangle {} has {} own corners, {} of them on the boundary",
                       key_of(part), t, own, boundary));
    }
  }

  std::vector<std::uint16_t> short_list(Part part, const char* what) const {
    const Section& section = plan_[part];
    std::vector<std::uint16_t> list(section.count);
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i] = get<std::uint16_t>(section, i);
      if (list[i] >= kMaxOwnVertices) {
        fail(fmt::format("{} entry {} is {}, expected less than {}", what, i, list[i],
                         kMaxOwnVertices));
      }
    }
    return list;
  }

  const TilePlan& plan_;
  std::span<const std::byte> bin_;
  const Tree& tree_;
  const std::string& name_;
};

/// Counts are bounded by 2^32, so that no product or sum of sizes overflows 64 bits.
TileShape read_shape(const Json& extension, NodeId node, const Tree& tree, const TileFormat& format,
                     const std::string& name) {
  const auto count = [&](const char* key, std::uint64_t max = UINT32_MAX) {
    return require_count(extension, key, max, name);
  };
  TileShape shape;
  shape.node = node;
  shape.own = count("ownCount", kMaxOwnVertices);
  shape.boundary = count("rimCount", shape.own);
  shape.ghosts = count("ghostCount");
  shape.neighbours = count("neighbourCount", shape.ghosts);
  shape.chain_entries = count("chainEntryCount");
  shape.interior = count("interiorCount");
  shape.border = count("borderCount");
  if (shape.own == 0)
    throw Error(ErrorCode::corrupt, name + ": a tile without vertices");
  const auto groups = groups_of(format.attributes);
  for (std::size_t i = 0; tree.is_partition(node) && i < groups.size(); ++i) {
    const char* key = key_of(groups[i].raw);
    shape.raw[i] = groups[i].channels > 0 && extension.contains(key) && extension[key] != -1;
  }
  return shape;
}

PublishedTile decode_glb(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                         const TileFormat& format, const std::string& name) {
  const GlbView glb = split_glb(bytes, name);
  const Json document = parse_json(glb.json, name);
  const Json& extension = require_extension(document, kTileExtension, kTileExtensionVersion, name);
  const TilePlan plan(read_shape(extension, node, tree, format, name), format.attributes,
                      format.lattice);
  const bool is_packed = has_packed_sections(format.compression);
  if (!is_packed && plan.bytes() != glb.bin.size()) {
    throw Error(ErrorCode::corrupt, fmt::format("{}: the BIN chunk has {} bytes, expected {}", name,
                                                glb.bin.size(), plan.bytes()));
  }
  Packing packing;
  std::vector<std::byte> unpacked;
  if (is_packed) {
    packing = read_packing(document, plan, glb.bin, name);
    unpacked = unpack_bin(plan, packing, glb.bin, name);
  }

  const Reader reader(plan, is_packed ? unpacked : glb.bin, tree, name);
  PublishedTile tile;
  tile.node = node;
  tile.mesh.vertices.positions = reader.positions();
  const Bounds bounds = bounds_of(tile.mesh.vertices.positions);
  require_same_json(plan.document(bounds, format.frame, is_packed ? &packing : nullptr), document,
                    name);
  tile.mesh.vertices.attributes = reader.attributes();
  tile.mesh.vertices.channels = format.attributes.channels();
  tile.mesh.own_count = static_cast<std::uint32_t>(plan.shape().own);
  tile.mesh.boundary_count = static_cast<std::uint32_t>(plan.shape().boundary);
  tile.mesh.interior = reader.triangles(Part::interior, is_packed);
  tile.mesh.border = reader.triangles(Part::border, is_packed);
  tile.parent_map = reader.parent_map();
  reader.read_ghosts(tile);
  return tile;
}

}  // namespace

double expected_ratio(Compression compression) {
  switch (compression) {
    case Compression::none:
      return 1;
    case Compression::zlib:
      return 0.79;
    case Compression::meshopt:
      return 0.66;
    case Compression::meshopt_zlib:
      break;
  }
  return 0.56;
}

std::string_view name_of(Compression compression) {
  return kCompressionNames[static_cast<std::size_t>(compression)];
}

bool is_unit_normal(Vec3f normal) {
  constexpr double kTolerance = 0.001;  // the validator's is 0.00674, in single precision
  return std::abs(length(to_double(normal)) - 1) <= kTolerance;
}

std::vector<std::byte> encode_tile(const TileView& tile, const Tree& tree,
                                   const TileFormat& format) {
  const TileMesh& mesh = tile.mesh;
  assert(mesh.own_count > 0 && mesh.own_count <= kMaxOwnVertices);
  assert(mesh.ghosts.size() == mesh.vertices.size() - mesh.own_count);
  assert(tile.parent_map.size() == (tile.node == tree.root() ? 0 : mesh.own_count));
  assert(mesh.vertices.channels == format.attributes.channels());

  const GhostGroups neighbours = group_ghosts(mesh.ghosts);
  const std::vector<float> shown = showable_attributes(format.attributes, mesh.vertices);
  const auto groups = groups_of(format.attributes);

  TileShape shape{tile.node,
                  mesh.own_count,
                  mesh.boundary_count,
                  mesh.ghosts.size(),
                  neighbours.tiles.size(),
                  tile.chains.size(),
                  mesh.interior.size(),
                  mesh.border.size(),
                  {}};
  for (std::size_t i = 0; tree.is_partition(tile.node) && i < groups.size(); ++i) {
    shape.raw[i] = differs(shown, mesh.vertices.attributes, groups[i], mesh.vertices.channels);
  }
  const TilePlan plan(shape, format.attributes, format.lattice);

  // A GLB if it may stay as it is, else the BIN chunk alone.
  const bool packed = has_packed_sections(format.compression);
  std::vector<std::byte> bytes =
      packed ? std::vector<std::byte>(plan.bytes())
             : begin_glb(plan.document(tile.bounds, format.frame).dump(), plan.bytes());
  Writer writer(plan, std::span(bytes).last(plan.bytes()));
  writer.put_positions(mesh.vertices.positions);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    writer.put_group(groups[i].part, groups[i], shown);
    writer.put_group(groups[i].raw, groups[i], mesh.vertices.attributes);
  }
  writer.put_triangles(Part::interior, mesh.interior);
  writer.put_triangles(Part::border, mesh.border);
  writer.put_list<std::uint16_t>(Part::parent_map, tile.parent_map);
  writer.put_list<std::uint32_t>(Part::neighbours, neighbours.tiles);
  writer.put_list<std::uint32_t>(Part::ghost_starts, neighbours.starts);
  writer.put_list<std::uint16_t>(Part::ghost_chains, tile.chains);
  if (packed) {
    const PackedBin bin = pack_bin(plan, bytes);
    bytes = join_glb(plan.document(tile.bounds, format.frame, &bin.packing).dump(), bin.bin);
  }
  return is_gzipped(format.compression) ? gzip(bytes) : bytes;
}

std::vector<std::byte> encode_tile(const PublishedTile& tile, const Tree& tree,
                                   const TileFormat& format) {
  assert(tile.chains.size() == tile.mesh.ghosts.size());
  return encode_tile({tile.node, tile.mesh, bounds_of(tile.mesh.vertices.positions),
                      tile.parent_map, tile.chains.entries()},
                     tree, format);
}

PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                          const TileFormat& format, const std::string& name) {
  assert(tree.contains(node));
  if (!is_gzipped(format.compression))
    return decode_glb(bytes, node, tree, format, name);
  return decode_glb(gunzip_glb(bytes, name), node, tree, format, name);
}

}  // namespace meshhier::storage

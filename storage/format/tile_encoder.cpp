#include "hierarchy/value_channels.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/glb.h"
#include "storage/format/showable.h"
#include "storage/format/tile_colours.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tile_pack.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tile_values.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <optional>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

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

/// Writes a tile's sections into the BIN chunk of its file.
class Writer {
 public:
  Writer(const TilePlan& plan, std::span<std::byte> bin) : plan_(plan), bin_(bin) {}

  void put_positions(std::span<const Vec3f> positions) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    const Section& section = plan_[TilePart::position];
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
  void put_group(TilePart part, const ChannelGroup& group, std::span<const float> attributes) {
    const Section& section = plan_[part];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    for (std::size_t v = 0; v < section.count; ++v) {
      for (std::size_t c = 0; c < group.channels; ++c) {
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

  void put_values(std::span<const float> attributes) {
    const Section& section = plan_[TilePart::values];
    const Section& raw = plan_[TilePart::raw_values];
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    std::size_t to = 0, raw_to = 0;
    for (const PlacedValue& value : placed_values(plan_.layout())) {
      const auto value_at = [&](std::size_t v) {
        return value.in(attributes.data() + v * channels);
      };
      for (std::size_t v = 0; v < section.count; ++v)
        put_stored(value.type, stored_value(value.type, value_at(v)),
                   at(section) + v * section.stride + to);
      for (std::size_t v = 0; v < raw.count; ++v) {
        std::byte* target = at(raw) + v * raw.stride + raw_to;
        takes_two_channels(value.type)
            ? store_little(value_at(v), target)
            : store_little(attributes[v * channels + value.channel], target);
      }
      to += kValueStride;
      raw_to += value.channels() * sizeof(float);
    }
  }

  void put_normals(std::span<const NormalCode> normals) {
    std::ranges::copy(std::as_bytes(normals), at(plan_[TilePart::normal]));
  }

  void put_tangents(std::span<const TangentCode> tangents) {
    std::ranges::copy(std::as_bytes(tangents), at(plan_[TilePart::tangent]));
  }

  /// Writes coordinates in the tile's picture, or in its normal map.
  void put_texcoords(std::span<const Vec2f> texcoords) {
    if (plan_.shape().has_map_texcoords())
      return put_map_texcoords(texcoords);
    const Section& section = plan_[TilePart::texcoord];
    for (std::size_t v = 0; v < texcoords.size(); ++v) {
      put(section, v, 0, texcoords[v].u);
      put(section, v, 1, texcoords[v].v);
    }
  }

  /// Writes the row of each vertex in the table of its objects.
  void put_features(std::span<const float> attributes, const TileObjects& objects) {
    const Section& section = plan_[TilePart::feature];
    if (section.view < 0)
      return;
    const PlacedValue place = placed_object(plan_.layout()).value();
    const auto channels = static_cast<std::size_t>(plan_.layout().channels());
    for (std::size_t v = 0; v < section.count; ++v) {
      const auto object = static_cast<std::uint32_t>(place.in(attributes.data() + v * channels));
      const auto row = std::ranges::lower_bound(objects.objects, object) - objects.objects.begin();
      section.component == kU16 ? put(section, v, 0, static_cast<std::uint16_t>(row))
                                : put(section, v, 0, static_cast<float>(row));
    }
  }

  void put_bytes(TilePart part, std::span<const std::byte> bytes) {
    std::ranges::copy(bytes, at(plan_[part]));
  }

  void put_triangles(TilePart part, std::span<const TileTriangle> triangles) {
    const Section& section = plan_[part];
    section.component == kU16 ? put_corners<std::uint16_t>(section, triangles)
                              : put_corners<std::uint32_t>(section, triangles);
  }

  template <Scalar T>
  void put_list(TilePart part, std::span<const T> values) {
    store_all_little(values, at(plan_[part]));
  }

  /// Writes numbers of vertices, in as many bytes as the section's type has.
  void put_vertices(TilePart part, std::span<const std::uint32_t> vertices) {
    if (plan_[part].component == kU32)
      return put_list(part, vertices);
    const std::vector<std::uint16_t> narrowed(vertices.begin(), vertices.end());
    put_list<std::uint16_t>(part, narrowed);
  }

 private:
  std::byte* at(const Section& section) { return bin_.data() + section.offset; }

  template <Scalar T>
  void put(const Section& section, std::size_t element, std::size_t component, T value) {
    store_little(value, at(section) + element * section.stride + component * sizeof(T));
  }

  void put_map_texcoords(std::span<const Vec2f> texcoords) {
    const Section& section = plan_[TilePart::map_texcoord];
    for (std::size_t v = 0; v < texcoords.size(); ++v) {
      put(section, v, 0, map_texcoord_number(texcoords[v].u));
      put(section, v, 1, map_texcoord_number(texcoords[v].v));
    }
  }

  static void put_stored(ValueType type, double value, std::byte* to) {
    switch (component_of(type)) {
      case kI8:
        return store_little(static_cast<std::uint8_t>(static_cast<std::int8_t>(value)), to);
      case kU8:
        return store_little(static_cast<std::uint8_t>(value), to);
      case kI16:
        return store_little(static_cast<std::uint16_t>(static_cast<std::int16_t>(value)), to);
      case kU16:
        return store_little(static_cast<std::uint16_t>(value), to);
      default:
        return store_little(static_cast<float>(value), to);
    }
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

/// Returns all vertices of a tile, in the order of its file.
VertexArray with_copies(const TileMesh& mesh, const Shading& shading) {
  VertexArray vertices = mesh.vertices;
  vertices.append(mesh.copies.vertices, 0, mesh.copies.size());
  vertices.append(vertices, shading.split_of);
  return vertices;
}

void put_triangles(const TileMesh& mesh, const Shading& shading, Writer& writer) {
  const bool split = !shading.split_of.empty();
  if (split || mesh.copies.empty()) {
    writer.put_triangles(TilePart::interior, split ? shading.interior : mesh.interior);
    writer.put_triangles(TilePart::border, split ? shading.border : mesh.border);
    return;
  }
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  writer.put_triangles(TilePart::interior, numbers.numbered(mesh.interior, mesh.interior_wedges));
  writer.put_triangles(TilePart::border, numbers.numbered(mesh.border, mesh.border_wedges));
}

bool has_map(const TileImage* normal_map) {
  return normal_map != nullptr && !normal_map->empty();
}

/// Whether the tile has texture coordinates and a picture.
[[maybe_unused]] bool is_textured(const TileMesh& mesh, const TileFormat& format) {
  return format.textures && !(mesh.interior.empty() && mesh.border.empty());
}

/// Whether the sizes are as Shading promises.
[[maybe_unused]] bool has_sound_size(const Shading& shading, const TileMesh& mesh,
                                     const TileFormat& format, bool has_map) {
  const std::size_t splits = shading.split_of.size();
  const std::size_t all = mesh.vertices.size() + mesh.copies.size() + splits;
  const bool split = splits > 0;
  return shading.normals.size() == (format.computed_normals ? all : 0) &&
         shading.texcoords.size() == (is_textured(mesh, format) || has_map ? all : 0) &&
         shading.tangents.size() == (has_map ? all : 0) &&
         (!split || format.computed_normals || format.textures || has_map) &&
         shading.interior.size() == (split ? mesh.interior.size() : 0) &&
         shading.border.size() == (split ? mesh.border.size() : 0);
}

[[maybe_unused]] bool has_sound_image(const TileImage& image, const TileMesh& mesh,
                                      const TileFormat& format) {
  if (!is_textured(mesh, format))
    return image == TileImage{};
  return image.format == stored_format(*format.textures, image.alpha) && !image.bytes.empty() &&
         std::min(image.width, image.height) >= 1 &&
         std::max(image.width, image.height) <= kMaxImageSide;
}

[[maybe_unused]] bool has_sound_map(const TileImage* map, const TileMesh& mesh,
                                    const TileFormat& format) {
  return !has_map(map) || (format.normal_maps && map->format == format.normal_maps->format &&
                           map->alpha == AlphaMode::opaque && !map->bytes.empty() &&
                           std::max(map->width, map->height) <= kMaxImageSide &&
                           !(mesh.interior.empty() && mesh.border.empty()));
}

[[maybe_unused]] bool has_sound_layout(const TileFormat& format) {
  return !(format.computed_normals && format.attributes.normals) &&
         !(format.textures && format.attributes.texcoords) && !format.attributes.material;
}

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

/// A tile on its way into its file, and what is worked out for it.
class Encoder {
 public:
  Encoder(const TileView& tile, const Tree& tree, const TileFormat& format)
      : tile_(tile),
        mesh_(tile.mesh),
        format_(format),
        is_partition_(tree.is_partition(tile.node)),
        neighbours_(group_ghosts(mesh_.ghosts)),
        groups_(groups_of(format.attributes)),
        colours_(format.attributes, format.screen_colours) {
    if (!mesh_.copies.empty() || !tile.shading.split_of.empty())
      joined_ = with_copies(mesh_, tile.shading);
    stored_ = colours_.all_stored(showable_attributes(format.attributes, vertices()));
  }

  std::vector<std::byte> encode() const {
    const TilePlan plan(shape(), format_.attributes, format_.lattice);
    // Sections that will be compressed are written into a BIN chunk alone, others into the file
    // itself.
    if (row_of(format_.compression).packs_sections) {
      std::vector<std::byte> sections(plan.bytes());
      write_sections({plan, sections});
      const PackedBin bin = pack_bin(plan, sections);
      return join_glb(json_text(plan.document(tile_.bounds, format_.frame, &bin.packing)), bin.bin);
    }
    std::vector<std::byte> bytes =
        begin_glb(json_text(plan.document(tile_.bounds, format_.frame)), plan.bytes());
    write_sections({plan, std::span(bytes).last(plan.bytes())});
    return bytes;
  }

 private:
  const VertexArray& vertices() const { return joined_ ? *joined_ : mesh_.vertices; }

  TileShape shape() const {
    const Shading& shading = tile_.shading;
    const TileImage& image = tile_.image;
    TileShape shape{tile_.node,
                    mesh_.own_count,
                    mesh_.boundary_count,
                    mesh_.ghosts.size(),
                    neighbours_.tiles.size(),
                    tile_.chains.size(),
                    mesh_.interior.size(),
                    mesh_.border.size(),
                    mesh_.copies.size(),
                    shading.split_of.size(),
                    {},
                    loses_values(format_.attributes, vertices(), !is_partition_),
                    format_.computed_normals,
                    format_.textures,
                    {image.bytes.size(), image.width, image.height, image.alpha},
                    tile_.first_view,
                    format_.screen_colours,
                    format_.normal_maps};
    if (format_.objects) {
      const TileObjects& objects = *tile_.objects;
      shape.objects = {*format_.objects, objects.objects.size(), objects.columns,
                       objects.text_bytes};
    }
    if (const TileImage* map = tile_.normal_map; has_map(map))
      shape.normal_map = {map->bytes.size(), map->width, map->height, AlphaMode::opaque};
    if (is_partition_) {
      const std::vector<float> read = colours_.all_numbers(stored_);
      for (std::size_t i = 0; i < groups_.size(); ++i)
        shape.raw[i] = differs(read, vertices().attributes, groups_[i], vertices().channels);
    }
    return shape;
  }

  void write_sections(Writer writer) const {
    const Shading& shading = tile_.shading;
    writer.put_positions(vertices().positions);
    writer.put_normals(shading.normals);
    writer.put_tangents(shading.tangents);
    writer.put_texcoords(shading.texcoords);
    for (const ChannelGroup& group : groups_) {
      writer.put_group(group.part, group, stored_);
      writer.put_group(group.raw, group, vertices().attributes);
    }
    writer.put_values(vertices().attributes);
    put_triangles(mesh_, shading, writer);
    writer.put_list<std::uint16_t>(TilePart::parent_map, tile_.parent_map);
    writer.put_list<std::uint32_t>(TilePart::neighbours, neighbours_.tiles);
    writer.put_list<std::uint32_t>(TilePart::ghost_starts, neighbours_.starts);
    writer.put_list<std::uint16_t>(TilePart::ghost_chains, tile_.chains);
    writer.put_vertices(TilePart::copy_of, mesh_.copies.places);
    writer.put_vertices(TilePart::split_of, shading.split_of);
    if (format_.objects) {
      writer.put_features(vertices().attributes, *tile_.objects);
      writer.put_bytes(TilePart::objects, tile_.objects->table);
    }
    writer.put_bytes(TilePart::image, tile_.image.bytes);
    if (has_map(tile_.normal_map))
      writer.put_bytes(TilePart::normal_map, tile_.normal_map->bytes);
  }

  const TileView& tile_;
  const TileMesh& mesh_;
  const TileFormat& format_;
  bool is_partition_;
  GhostGroups neighbours_;
  ChannelGroups groups_;
  TileColours colours_;
  std::optional<VertexArray> joined_;  ///< with copies and splits; none: there are neither
  std::vector<float> stored_;          ///< the vertices' channels
};

/// Whether the parts of a tile go together.
[[maybe_unused]] bool is_sound(const TileView& tile, const Tree& tree, const TileFormat& format) {
  const TileMesh& mesh = tile.mesh;
  const bool is_root = tile.node == tree.root();
  return mesh.own_count > 0 && mesh.own_count <= kMaxOwnVertices && (!tile.first_view || is_root) &&
         mesh.ghosts.size() == mesh.vertices.size() - mesh.own_count &&
         tile.parent_map.size() == (is_root ? 0 : mesh.own_count) &&
         mesh.vertices.channels == format.attributes.channels() &&
         mesh.copies.vertices.size() == mesh.copies.size() && has_sound_layout(format) &&
         has_sound_size(tile.shading, mesh, format, has_map(tile.normal_map)) &&
         has_sound_map(tile.normal_map, mesh, format) && has_sound_image(tile.image, mesh, format);
}

}  // namespace

std::vector<std::byte> encode_tile(const TileView& tile, const Tree& tree,
                                   const TileFormat& format) {
  assert(is_sound(tile, tree, format));
  std::vector<std::byte> bytes = Encoder(tile, tree, format).encode();
  const auto pack = row_of(format.compression).pack_file;
  return pack == nullptr ? bytes : pack(bytes);
}

std::vector<std::byte> encode_tile(const PublishedTile& tile, const Tree& tree,
                                   const TileFormat& format) {
  assert(tile.chains.size() == tile.mesh.ghosts.size());
  return encode_tile(
      {tile.node, tile.mesh, tile.shading, tile.image, bounds_of(tile.mesh.vertices.positions),
       tile.parent_map, tile.chains.entries(), tile.first_view, &tile.normal_map, &tile.objects},
      tree, format);
}

}  // namespace meshhier::storage

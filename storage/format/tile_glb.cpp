#include "storage/format/tile_glb.h"

#include "base/error.h"
#include "hierarchy/value_channels.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/glb.h"
#include "storage/format/showable.h"
#include "storage/format/tile_colours.h"
#include "storage/format/tile_pack.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tile_sections.h"
#include "storage/format/tile_values.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

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
        return value_in(value.type, attributes.data() + v * channels + value.channel);
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
      const auto object = static_cast<std::uint32_t>(
          value_in(place.type, attributes.data() + v * channels + place.channel));
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

// ---- reading -------------------------------------------------------------------------------

AlphaMode read_alpha(const Json& document) {
  const Json::json_pointer place("/materials/0/alphaMode");
  const Json mode = document.contains(place) ? document[place] : Json();
  const std::string name = mode.is_string() ? mode.get<std::string>() : "";
  return value_named(kAlphaModes, name).value_or(AlphaMode::opaque);
}

/// The keys of a picture in the extension.
struct ImageKeys {
  const char *view, *width, *height;
};

/// Reads the shape of a picture or normal map, which the tile must have.
ImageShape read_image_shape(const Json& document, const Json& extension, const ImageKeys& keys,
                            const std::string& name) {
  const auto count = [&](const Json& object, const char* key, std::uint64_t max) {
    const std::uint64_t found = require_count(object, key, max, name);
    if (found == 0)
      throw Error(ErrorCode::corrupt, fmt::format("{}: a picture whose {} is 0", name, key));
    return found;
  };
  const auto side = [&](const char* key) {
    return static_cast<std::uint32_t>(count(extension, key, kMaxImageSide));
  };
  const std::uint64_t number = count(extension, keys.view, kPartCount);
  const Json::json_pointer place("/bufferViews/" + std::to_string(number));
  const Json view = document.contains(place) ? document[place] : Json();
  return {count(view, "byteLength", UINT32_MAX), side(keys.width), side(keys.height),
          read_alpha(document)};
}

bool have_same_sides(const ImageShape& a, const ImageShape& b) {
  return a.width == b.width && a.height == b.height;
}

ObjectTableShape read_table_shape(const Json& extension,
                                  const std::vector<ObjectProperty>& properties,
                                  const std::string& name) {
  ObjectTableShape shape;
  shape.properties = properties;
  shape.rows = require_count(extension, "objectCount", kMostObjects, name);
  const std::uint64_t columns =
      require_count(extension, "objectColumns", 2 + properties.size(), name);
  if (shape.rows == 0 || columns == 0)
    throw Error(ErrorCode::corrupt, name + ": a table of objects without a row or a column");
  shape.columns = static_cast<std::uint32_t>(columns);
  const Json texts = extension.value("objectTextBytes", Json());
  const bool is_sound =
      texts.is_array() && texts.size() == text_columns(properties, columns) &&
      std::all_of(texts.begin(), texts.end(), [](const Json& bytes) {
        return bytes.is_number_unsigned() && bytes.get<std::uint64_t>() <= UINT32_MAX;
      });
  if (!is_sound)
    throw Error(ErrorCode::corrupt,
                name + ": JSON: \"objectTextBytes\" is not the bytes of each column of texts");
  shape.text_bytes = texts.get<std::vector<std::uint64_t>>();
  return shape;
}

/// Counts are bounded by 2^32, so that no product or sum of sizes overflows 64 bits.
TileShape read_shape(const Json& document, NodeId node, const Tree& tree, const TileFormat& format,
                     const std::string& name) {
  const Json& extension =
      require_extension(document, kTileExtension,
                        tile_version(format.attributes, format.screen_colours,
                                     format.normal_maps.has_value(), format.objects.has_value()),
                        name);
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
  shape.copies = count("copyCount");
  shape.computed_normals = format.computed_normals;
  shape.textures = format.textures;
  shape.screen_colours = format.screen_colours;
  shape.normal_maps = format.normal_maps;
  if (shape.is_shaded())
    shape.splits = count("splitCount");
  if (shape.textures && shape.interior + shape.border > 0)
    shape.image =
        read_image_shape(document, extension, {"image", "imageWidth", "imageHeight"}, name);
  const char* map = key_of(TilePart::normal_map);
  if (shape.normal_maps && extension.contains(map) && extension[map] != -1) {
    shape.normal_map =
        read_image_shape(document, extension, {map, "normalMapWidth", "normalMapHeight"}, name);
    shape.normal_map.alpha = AlphaMode::opaque;  // the material's is the picture's
    if (tree.is_partition(node) || shape.interior + shape.border == 0)
      throw Error(ErrorCode::corrupt, name + ": a normal map of a partition, or of no triangle");
    if (shape.has_image() && !have_same_sides(shape.image, shape.normal_map))
      throw Error(ErrorCode::corrupt, name + ": picture and normal map have different sides");
  }
  if (format.objects)
    shape.objects = read_table_shape(extension, *format.objects, name);
  if (node == tree.root())
    shape.first_view = read_first_view(document, name);
  if (shape.own == 0)
    throw Error(ErrorCode::corrupt, name + ": a tile without vertices");
  if (shape.with_splits() > UINT32_MAX)
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: {} vertices, expected less than 2^32", name, shape.with_splits()));
  if (shape.splits > most_splits(shape.interior, shape.border))
    throw Error(ErrorCode::corrupt, name + ": more splits than corners of triangles");
  const auto groups = groups_of(format.attributes);
  for (std::size_t i = 0; tree.is_partition(node) && i < groups.size(); ++i) {
    const char* key = key_of(groups[i].raw);
    shape.raw[i] = groups[i].channels > 0 && extension.contains(key) && extension[key] != -1;
  }
  const char* key = key_of(TilePart::raw_values);
  shape.raw_values =
      !format.attributes.values.empty() && extension.contains(key) && extension[key] != -1;
  return shape;
}

PublishedTile decode_glb(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                         const TileFormat& format, const std::string& name) {
  const GlbView glb = split_glb(bytes, name);
  const Json document = parse_json(glb.json, name);
  const TilePlan plan(read_shape(document, node, tree, format, name), format.attributes,
                      format.lattice);
  const bool is_packed = row_of(format.compression).packs_sections;
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

  const TileSections sections{plan, is_packed ? unpacked : glb.bin, is_packed};
  std::vector<Vec3f> positions = read_positions(sections, tree, name);
  require_same_json(
      plan.document(bounds_of(positions), format.frame, is_packed ? &packing : nullptr), document,
      name);
  return read_tile(sections, std::move(positions), tree, name);
}

}  // namespace

std::vector<std::byte> encode_tile(const TileView& tile, const Tree& tree,
                                   const TileFormat& format) {
  const TileMesh& mesh = tile.mesh;
  assert(mesh.own_count > 0 && mesh.own_count <= kMaxOwnVertices);
  assert(!tile.first_view || tile.node == tree.root());
  assert(mesh.ghosts.size() == mesh.vertices.size() - mesh.own_count);
  assert(tile.parent_map.size() == (tile.node == tree.root() ? 0 : mesh.own_count));
  assert(mesh.vertices.channels == format.attributes.channels());
  assert(mesh.copies.vertices.size() == mesh.copies.size());
  const Shading& shading = tile.shading;
  assert(has_sound_layout(format));
  assert(has_sound_size(shading, mesh, format, has_map(tile.normal_map)));
  assert(has_sound_map(tile.normal_map, mesh, format));
  assert(has_sound_image(tile.image, mesh, format));

  const GhostGroups neighbours = group_ghosts(mesh.ghosts);
  const bool places_only = mesh.copies.empty() && shading.split_of.empty();
  const VertexArray joined = places_only ? VertexArray{} : with_copies(mesh, shading);
  const VertexArray& vertices = places_only ? mesh.vertices : joined;
  const TileColours colours(format.attributes, format.screen_colours);
  const std::vector<float> stored =
      colours.all_stored(showable_attributes(format.attributes, vertices));
  const auto groups = groups_of(format.attributes);

  TileShape shape{tile.node,
                  mesh.own_count,
                  mesh.boundary_count,
                  mesh.ghosts.size(),
                  neighbours.tiles.size(),
                  tile.chains.size(),
                  mesh.interior.size(),
                  mesh.border.size(),
                  mesh.copies.size(),
                  shading.split_of.size(),
                  {},
                  loses_values(format.attributes, vertices, !tree.is_partition(tile.node)),
                  format.computed_normals,
                  format.textures,
                  {tile.image.bytes.size(), tile.image.width, tile.image.height, tile.image.alpha},
                  tile.first_view,
                  format.screen_colours,
                  format.normal_maps};
  if (format.objects) {
    const TileObjects& objects = *tile.objects;
    shape.objects = {*format.objects, objects.objects.size(), objects.columns, objects.text_bytes};
  }
  if (has_map(tile.normal_map))
    shape.normal_map = {tile.normal_map->bytes.size(), tile.normal_map->width,
                        tile.normal_map->height, AlphaMode::opaque};
  if (tree.is_partition(tile.node)) {
    const std::vector<float> read = colours.all_numbers(stored);
    for (std::size_t i = 0; i < groups.size(); ++i)
      shape.raw[i] = differs(read, vertices.attributes, groups[i], vertices.channels);
  }
  const TilePlan plan(shape, format.attributes, format.lattice);

  // Sections that will be compressed are written into a BIN chunk alone, others into the file
  // itself.
  const bool packed = row_of(format.compression).packs_sections;
  std::vector<std::byte> bytes =
      packed ? std::vector<std::byte>(plan.bytes())
             : begin_glb(json_text(plan.document(tile.bounds, format.frame)), plan.bytes());
  Writer writer(plan, std::span(bytes).last(plan.bytes()));
  writer.put_positions(vertices.positions);
  writer.put_normals(shading.normals);
  writer.put_tangents(shading.tangents);
  writer.put_texcoords(shading.texcoords);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    writer.put_group(groups[i].part, groups[i], stored);
    writer.put_group(groups[i].raw, groups[i], vertices.attributes);
  }
  writer.put_values(vertices.attributes);
  put_triangles(mesh, shading, writer);
  writer.put_list<std::uint16_t>(TilePart::parent_map, tile.parent_map);
  writer.put_list<std::uint32_t>(TilePart::neighbours, neighbours.tiles);
  writer.put_list<std::uint32_t>(TilePart::ghost_starts, neighbours.starts);
  writer.put_list<std::uint16_t>(TilePart::ghost_chains, tile.chains);
  writer.put_vertices(TilePart::copy_of, mesh.copies.places);
  writer.put_vertices(TilePart::split_of, shading.split_of);
  if (format.objects) {
    writer.put_features(vertices.attributes, *tile.objects);
    writer.put_bytes(TilePart::objects, tile.objects->table);
  }
  writer.put_bytes(TilePart::image, tile.image.bytes);
  if (has_map(tile.normal_map))
    writer.put_bytes(TilePart::normal_map, tile.normal_map->bytes);
  if (packed) {
    const PackedBin bin = pack_bin(plan, bytes);
    bytes = join_glb(json_text(plan.document(tile.bounds, format.frame, &bin.packing)), bin.bin);
  }
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

PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                          const TileFormat& format, const std::string& name) {
  assert(tree.contains(node));
  const auto unpack = row_of(format.compression).unpack_file;
  if (unpack == nullptr)
    return decode_glb(bytes, node, tree, format, name);
  return decode_glb(unpack(bytes, name), node, tree, format, name);
}

}  // namespace meshhier::storage

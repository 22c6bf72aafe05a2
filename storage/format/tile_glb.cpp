#include "storage/format/tile_glb.h"

#include "base/error.h"
#include "storage/format/glb.h"
#include "storage/format/tile_pack.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tile_sections.h"
#include "storage/io/json_text.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

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
TileShape read_tile_counts(const Json& extension, const TileFormat& format,
                           const std::string& name) {
  const auto count = [&](const char* key, std::uint64_t max = UINT32_MAX) {
    return require_count(extension, key, max, name);
  };
  TileShape shape;
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
  return shape;
}

/// Whether a tile has the part, which is the view of that number; -1 stands for none.
bool has_part(const Json& extension, TilePart part) {
  const char* key = key_of(part);
  return extension.contains(key) && extension[key] != -1;
}

/// Reads the shapes of the picture and the normal map, as far as the tile has them.
void read_picture_shapes(const Json& document, const Json& extension, bool is_partition,
                         const std::string& name, TileShape& shape) {
  const bool is_drawn = shape.interior + shape.border > 0;
  if (shape.textures && is_drawn)
    shape.image =
        read_image_shape(document, extension, {"image", "imageWidth", "imageHeight"}, name);
  if (!shape.normal_maps || !has_part(extension, TilePart::normal_map))
    return;
  shape.normal_map =
      read_image_shape(document, extension,
                       {key_of(TilePart::normal_map), "normalMapWidth", "normalMapHeight"}, name);
  shape.normal_map.alpha = AlphaMode::opaque;  // the material's is the picture's
  if (is_partition || !is_drawn)
    throw Error(ErrorCode::corrupt, name + ": a normal map of a partition, or of no triangle");
  if (shape.has_image() && !have_same_sides(shape.image, shape.normal_map))
    throw Error(ErrorCode::corrupt, name + ": picture and normal map have different sides");
}

void require_vertices(const TileShape& shape, const std::string& name) {
  if (shape.own == 0)
    throw Error(ErrorCode::corrupt, name + ": a tile without vertices");
  if (shape.with_splits() > UINT32_MAX)
    throw Error(ErrorCode::corrupt,
                fmt::format("{}: {} vertices, expected less than 2^32", name, shape.with_splits()));
  if (shape.splits > most_splits(shape.interior, shape.border))
    throw Error(ErrorCode::corrupt, name + ": more splits than corners of triangles");
}

TileShape read_shape(const Json& document, NodeId node, const Tree& tree, const TileFormat& format,
                     const std::string& name) {
  const Json& extension =
      require_extension(document, kTileExtension,
                        tile_version(format.attributes, format.screen_colours,
                                     format.normal_maps.has_value(), format.objects.has_value()),
                        name);
  const bool is_partition = tree.is_partition(node);
  TileShape shape = read_tile_counts(extension, format, name);
  shape.node = node;
  read_picture_shapes(document, extension, is_partition, name, shape);
  if (format.objects)
    shape.objects = read_table_shape(extension, *format.objects, name);
  if (node == tree.root())
    shape.first_view = read_first_view(document, name);
  require_vertices(shape, name);
  const auto groups = groups_of(format.attributes);
  for (std::size_t i = 0; is_partition && i < groups.size(); ++i)
    shape.raw[i] = groups[i].channels > 0 && has_part(extension, groups[i].raw);
  shape.raw_values = !format.attributes.values.empty() && has_part(extension, TilePart::raw_values);
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

PublishedTile decode_tile(std::span<const std::byte> bytes, NodeId node, const Tree& tree,
                          const TileFormat& format, const std::string& name) {
  assert(tree.contains(node));
  const auto unpack = row_of(format.compression).unpack_file;
  if (unpack == nullptr)
    return decode_glb(bytes, node, tree, format, name);
  return decode_glb(unpack(bytes, name), node, tree, format, name);
}

}  // namespace meshhier::storage

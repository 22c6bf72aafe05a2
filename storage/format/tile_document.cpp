#include "base/named_value.h"
#include "storage/format/glb.h"
#include "storage/format/glb_material.h"
#include "storage/format/tile_plan.h"
#include "storage/format/tile_values.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

using Json = nlohmann::ordered_json;

// Primitive modes of the glTF 2.0 specification.
constexpr unsigned kPoints = 0;
constexpr unsigned kTriangles = 4;

/// The names that EXT_meshopt_compression has for modes.
constexpr std::array kModes{NamedValue{"ATTRIBUTES", ViewMode::attributes},
                            NamedValue{"TRIANGLES", ViewMode::triangles},
                            NamedValue{"INDICES", ViewMode::indices}};

// Buffers are the BIN chunk, and the one that compressed views are decoded to, which no file holds.
constexpr int kBin = 0;
constexpr int kDecoded = 1;

Json packed_json(const Section& section, TilePart part, const Packing& packing) {
  Json packed = {{"buffer", kBin},
                 {"byteOffset", packing.offset(part)},
                 {"byteLength", packing.bytes[static_cast<std::size_t>(part)]},
                 {"byteStride", section.stride},
                 {"mode", name_in(kModes, mode_of(part))},
                 {"count", section.count}};
  if (part == TilePart::position && packing.exponential)
    packed["filter"] = "EXPONENTIAL";
  return packed;
}

Json view_json(const Section& section, TilePart part, const Packing* packing) {
  const bool packed = packing != nullptr && mode_of(part) != ViewMode::raw;
  const bool moved = packing != nullptr && !packed;
  Json view = {{"buffer", packed ? kDecoded : kBin},
               {"byteOffset", moved ? packing->offset(part) : section.offset},
               {"byteLength", section.bytes()}};
  const bool padded = part == TilePart::values ||
                      section.stride != component_bytes(section.component) * section.components;
  if (padded)
    view["byteStride"] = section.stride;
  if (const unsigned target = target_of(part); target > 0)
    view["target"] = target;
  if (packed)
    view["extensions"][kMeshoptExtension] = packed_json(section, part, *packing);
  return view;
}

/// Returns the smallest or largest values of the accessor of positions.
Json corner_json(const TilePlan& plan, Vec3f corner) {
  if (plan.has_short_positions()) {
    const Vec3<std::uint32_t> n = plan.lattice()->numbers_of(corner);
    return Json::array({n.x, n.y, n.z});
  }
  // They are written as doubles: the shortest decimal form of those is read back as the same float.
  const Vec3d wide = to_double(corner);
  return Json::array({wide.x, wide.y, wide.z});
}

Json accessor_json(const TilePlan& plan, TilePart part, const Bounds& bounds) {
  const Section& section = plan[part];
  Json accessor = {{"bufferView", section.view},
                   {"componentType", section.component},
                   {"count", section.count},
                   {"type", vector_type(section.components)}};
  const bool is_number = section.component != kF32;
  if (is_number && part > TilePart::position && part < TilePart::feature)
    accessor["normalized"] = true;
  if (part == TilePart::position) {
    accessor["min"] = corner_json(plan, bounds.min);
    accessor["max"] = corner_json(plan, bounds.max);
  }
  return accessor;
}

/// Returns the number of the set of coordinates in a normal map; the input's own come first.
unsigned map_texcoord_set(const TilePlan& plan) {
  return plan.layout().texcoords ? 1 : 0;
}

const char* attribute_name(const TilePlan& plan, TilePart part) {
  if (part == TilePart::colour)
    return colour_attribute(plan.layout(), plan.shape().textures.has_value());
  return part == TilePart::map_texcoord && map_texcoord_set(plan) == 1 ? "TEXCOORD_1"
                                                                       : key_of(part);
}

/// Returns the accessor of one value. All values lie in one view.
Json value_accessor_json(const TilePlan& plan, std::size_t value) {
  const Section& section = plan[TilePart::values];
  return {{"bufferView", section.view},
          {"byteOffset", value * kValueStride},
          {"componentType", component_of(plan.layout().values[value].type)},
          {"count", section.count},
          {"type", "SCALAR"}};
}

/// Accessors have the numbers of their buffer views: the parts with an accessor come first, values
/// last.
Json primitives_json(const TilePlan& plan) {
  Json attributes = Json::object();
  attributes[key_of(TilePart::position)] = plan[TilePart::position].view;
  for (TilePart part = TilePart::normal; part < TilePart::interior; part = next(part)) {
    if (plan[part].view >= 0)
      attributes[attribute_name(plan, part)] = plan[part].view;
  }
  const std::vector<std::string> values =
      value_attributes(plan.layout(), plan.shape().objects.has_value());
  for (std::size_t i = 0; i < values.size(); ++i)
    attributes[values[i]] = static_cast<std::size_t>(plan[TilePart::values].view) + i;
  Json primitives = Json::array();
  for (const TilePart part : {TilePart::interior, TilePart::border}) {
    if (plan[part].view < 0)
      continue;
    primitives.push_back(Json::object({{"attributes", attributes},
                                       {"indices", plan[part].view},
                                       {"material", 0},
                                       {"mode", kTriangles}}));
  }
  if (primitives.empty()) {
    primitives.push_back(
        Json::object({{"attributes", attributes}, {"material", 0}, {"mode", kPoints}}));
  }
  for (Json& primitive : primitives) {
    if (const auto& objects = plan.shape().objects)
      primitive["extensions"][kFeaturesExtension]["featureIds"] =
          Json::array({{{"featureCount", objects->rows}, {"attribute", 0}, {"propertyTable", 0}}});
    if (!values.empty())
      primitive["extensions"][kMetadataExtension]["propertyAttributes"] = Json::array({0});
  }
  return primitives;
}

/// A picture or normal map; the texture and the image of its number are it.
struct ShownImage {
  TilePart part;
  ImageFormat format;
};

std::vector<ShownImage> images_of(const TileShape& shape) {
  std::vector<ShownImage> images;
  if (shape.has_image())
    images.push_back({TilePart::image, stored_format(*shape.textures, shape.image.alpha)});
  if (shape.has_normal_map())
    images.push_back({TilePart::normal_map, shape.normal_maps->format});
  return images;
}

Json material_of(const TilePlan& plan) {
  const TileShape& shape = plan.shape();
  Json material = shape.has_image() ? material_json(0, shape.image.alpha, shape.textures->unlit)
                                    : material_json();
  if (shape.has_normal_map())
    material["normalTexture"] =
        normal_texture_json(shape.has_image() ? 1 : 0, map_texcoord_set(plan));
  return material;
}

/// Adds all that leads from the material to the picture and the normal map.
void add_images(const TilePlan& plan, Json& document) {
  const std::vector<ShownImage> shown = images_of(plan.shape());
  if (shown.empty())
    return;
  Json textures = Json::array(), images = Json::array();
  for (const ShownImage& image : shown) {
    textures.push_back(texture_json(images.size(), image.format));
    images.push_back(image_json(plan[image.part].view, image.format));
  }
  document["textures"] = std::move(textures);
  document["samplers"] = Json::array({sampler_json()});
  document["images"] = std::move(images);
}

/// Whether the extension has the key of a part.
bool is_told(TilePart part, const TilePlan& plan) {
  const TileShape& shape = plan.shape();
  if (part == TilePart::values || part == TilePart::raw_values)
    return !plan.layout().values.empty();
  if (part == TilePart::objects)
    return shape.objects.has_value();
  if (part == TilePart::split_of)
    return shape.is_shaded();
  if (part == TilePart::normal_map)
    return shape.normal_maps.has_value();
  return part != TilePart::image || shape.textures;
}

Json extension_json(const TilePlan& plan) {
  const TileShape& shape = plan.shape();
  const bool interior = shape.interior > 0;
  const bool border = shape.border > 0;
  Json extension = {
      {"version", tile_version(plan.layout(), shape.screen_colours, shape.normal_maps.has_value(),
                               shape.objects.has_value())},
      {"level", raw(shape.node.level)},
      {"index", shape.node.index},
      {"ownCount", shape.own},
      {"rimCount", shape.boundary},
      {"ghostCount", shape.ghosts},
      {"copyCount", shape.copies},
      {"neighbourCount", shape.neighbours},
      {"chainEntryCount", shape.chain_entries},
      {"interiorCount", shape.interior},
      {"borderCount", shape.border},
      {"interiorPrimitive", interior ? 0 : -1},
      {"borderPrimitive", border ? (interior ? 1 : 0) : -1}};
  if (shape.objects) {
    extension["objectCount"] = shape.objects->rows;
    extension["objectColumns"] = shape.objects->columns;
    extension["objectTextBytes"] = shape.objects->text_bytes;
  }
  if (shape.is_shaded())
    extension["splitCount"] = shape.splits;
  if (shape.textures) {
    extension["imageWidth"] = shape.image.width;
    extension["imageHeight"] = shape.image.height;
  }
  if (shape.normal_maps) {
    extension["normalMapWidth"] = shape.normal_map.width;
    extension["normalMapHeight"] = shape.normal_map.height;
  }
  for (TilePart part = TilePart::values; part < kPartsEnd; part = next(part)) {
    if (is_told(part, plan))
      extension[key_of(part)] = plan[part].view;
  }
  return extension;
}

/// Returns the node, which leads from stored numbers to the input's coordinates.
Json node_json(const TilePlan& plan, const Frame& frame) {
  if (!plan.has_short_positions())
    return mesh_node(frame);
  return mesh_node({frame.origin + plan.lattice()->corner, frame.up}, plan.lattice()->step);
}

Json buffers_json(const TilePlan& plan, const Packing* packing) {
  if (packing == nullptr)
    return Json::array({Json::object({{"byteLength", plan.bytes()}})});
  Json decoded = {{"byteLength", plan.bytes()}};
  decoded["extensions"][kMeshoptExtension] = {{"fallback", true}};
  return Json::array({Json::object({{"byteLength", packing->total()}}), decoded});
}

/// Adds a view for each column of the table of objects.
void add_column_views(const TilePlan& plan, const Packing* packing, Json& views) {
  const std::uint64_t begin =
      packing != nullptr ? packing->offset(TilePart::objects) : plan[TilePart::objects].offset;
  const auto add = [&](std::uint64_t offset, std::uint64_t bytes) {
    views.push_back({{"buffer", kBin}, {"byteOffset", begin + offset}, {"byteLength", bytes}});
  };
  for (const ObjectColumn& column : ObjectColumns(*plan.shape().objects).columns) {
    add(column.values, std::max<std::uint64_t>(column.value_bytes, 1));
    if (column.start_bytes > 0)
      add(column.starts, column.start_bytes);
  }
}

/// Returns the content of the root's extension. Values are there whenever objects are.
Json metadata_json(const TilePlan& plan) {
  Json metadata = values_metadata(plan.layout(), plan.shape().objects.has_value());
  const auto& objects = plan.shape().objects;
  if (!objects)
    return metadata;
  const ObjectColumns columns(*objects);
  metadata["schema"]["classes"]["object"] = object_class(columns);
  metadata["propertyTables"] =
      Json::array({object_table_json(columns, static_cast<std::size_t>(plan.views()))});
  return metadata;
}

/// Returns the extensions without which a viewer cannot show the tile.
Json required_extensions(const TilePlan& plan, const Packing* packing) {
  Json names = Json::array();
  if (packing != nullptr)
    names.push_back(kMeshoptExtension);
  const TileShape& shape = plan.shape();
  if (plan.has_short_positions() || shape.computed_normals || shape.has_normal_map())
    names.push_back(kQuantizationExtension);
  for (const ShownImage& image : images_of(shape)) {
    const char* const extension = meshhier::row_of(image.format).gltf_extension;
    if (extension != nullptr && std::ranges::find(names, extension) == names.end())
      names.push_back(extension);
  }
  return names;
}

}  // namespace

Json TilePlan::document(const Bounds& bounds, const Frame& frame, const Packing* packing) const {
  Json views = Json::array();
  Json accessors = Json::array();
  for (std::size_t i = 0; i < kPartCount; ++i) {
    const auto part = static_cast<TilePart>(i);
    if (sections_[i].view < 0)
      continue;
    views.push_back(view_json(sections_[i], part, packing));
    if (part <= TilePart::border)
      accessors.push_back(accessor_json(*this, part, bounds));
  }
  if (shape_.objects)
    add_column_views(*this, packing, views);
  for (std::size_t i = 0; i < layout_.values.size(); ++i)
    accessors.push_back(value_accessor_json(*this, i));
  const Json mesh = {{"primitives", primitives_json(*this)}};
  const Json scene = {{"nodes", Json::array({0})}};
  Json required = required_extensions(*this, packing);
  Json used = required;
  if (shape_.has_image() && shape_.textures->unlit)
    used.push_back(kUnlitExtension);
  if (shape_.objects)
    used.push_back(kFeaturesExtension);
  if (!layout_.values.empty())
    used.push_back(kMetadataExtension);
  used.push_back(kTileExtension);

  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "meshhier"}};
  document["extensionsUsed"] = std::move(used);
  if (!required.empty())
    document["extensionsRequired"] = std::move(required);
  document["scene"] = 0;
  document["scenes"] = Json::array({scene});
  document["nodes"] = Json::array({node_json(*this, frame)});
  document["meshes"] = Json::array({mesh});
  document["materials"] = Json::array({material_of(*this)});
  add_images(*this, document);
  document["accessors"] = std::move(accessors);
  document["bufferViews"] = std::move(views);
  document["buffers"] = buffers_json(*this, packing);
  if (!layout_.values.empty())
    document["extensions"][kMetadataExtension] = metadata_json(*this);
  document["extensions"][kTileExtension] = extension_json(*this);
  if (shape_.first_view)
    document["extras"] = first_view_extras(*shape_.first_view);
  return document;
}

}  // namespace meshhier::storage

#include "storage/format/tile_plan.h"

#include "base/named_value.h"
#include "storage/format/glb.h"
#include "storage/format/glb_material.h"
#include "storage/format/tile_values.h"

#include <algorithm>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

namespace meshhier::storage {
namespace {

constexpr const char* gltf_name(AttributeKind kind) {
  return meshhier::row_of(kind).gltf.data();
}

/// The facts on a part that are the same in all tiles.
struct PartRow {
  TilePart part;
  const char* key;
  ViewMode mode;
  unsigned target = 0;  ///< the buffer view's; 0: none
};
constexpr std::array<PartRow, kPartCount> kParts{{
    {TilePart::position, "POSITION", ViewMode::attributes, kVertexTarget},
    {TilePart::normal, gltf_name(AttributeKind::normals), ViewMode::attributes, kVertexTarget},
    {TilePart::tangent, "TANGENT", ViewMode::attributes, kVertexTarget},
    {TilePart::colour, gltf_name(AttributeKind::colours), ViewMode::attributes, kVertexTarget},
    {TilePart::texcoord, gltf_name(AttributeKind::texcoords), ViewMode::attributes, kVertexTarget},
    {TilePart::map_texcoord, gltf_name(AttributeKind::texcoords), ViewMode::attributes,
     kVertexTarget},
    {TilePart::feature, kFeatureAttribute, ViewMode::attributes, kVertexTarget},
    {TilePart::interior, "interior", ViewMode::triangles, kIndexTarget},
    {TilePart::border, "border", ViewMode::triangles, kIndexTarget},
    {TilePart::values, "values", ViewMode::attributes, kVertexTarget},
    {TilePart::parent_map, "parentMap", ViewMode::indices},
    {TilePart::neighbours, "neighbours", ViewMode::raw},
    {TilePart::ghost_starts, "ghostStarts", ViewMode::raw},
    {TilePart::ghost_chains, "ghostChains", ViewMode::indices},
    {TilePart::copy_of, "copyOf", ViewMode::indices},
    {TilePart::split_of, "splitOf", ViewMode::indices},
    {TilePart::raw_normals, "rawNormals", ViewMode::attributes},
    {TilePart::raw_colours, "rawColours", ViewMode::attributes},
    {TilePart::raw_texcoords, "rawTexcoords", ViewMode::attributes},
    {TilePart::raw_values, "rawValues", ViewMode::attributes},
    {TilePart::objects, "objectTable", ViewMode::raw},
    {TilePart::image, "image", ViewMode::raw},
    {TilePart::normal_map, "normalMap", ViewMode::raw},
}};
static_assert(are_in_order(kParts, &PartRow::part));

constexpr const PartRow& row_of(TilePart part) {
  return kParts[static_cast<std::size_t>(part)];
}

/// All that vertices show beside their positions.
constexpr std::span<const PartRow> shown_attributes() {
  constexpr auto kFirst = static_cast<std::size_t>(TilePart::normal);
  constexpr auto kEnd = static_cast<std::size_t>(TilePart::interior);
  return std::span(kParts).subspan(kFirst, kEnd - kFirst);
}

/// The component type and the components of what the build computed; 0 of what the tile lacks.
std::pair<unsigned, std::size_t> computed_elements(TilePart part, const TileShape& shape) {
  if (part == TilePart::normal && shape.computed_normals)
    return {kI8, 3};
  if (part == TilePart::tangent && shape.has_normal_map())
    return {kI8, 4};
  if (part == TilePart::texcoord && shape.has_image())
    return {kF32, 2};
  if (part == TilePart::map_texcoord && shape.has_map_texcoords())
    return {kU16, 2};
  if (part == TilePart::feature && shape.objects)
    return {shape.objects->rows <= UINT16_MAX ? kU16 : kF32, 1};
  return {};
}

}  // namespace

ViewMode mode_of(TilePart part) {
  return row_of(part).mode;
}

unsigned target_of(TilePart part) {
  return row_of(part).target;
}

std::uint64_t begin_of(TilePart part, std::uint64_t end) {
  return part == TilePart::objects ? (end + 7) / 8 * 8 : aligned4(end);
}

std::uint64_t Packing::offset(TilePart part) const {
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(part); ++i)
    offset = bytes[i] > 0 ? begin_of(static_cast<TilePart>(i), offset) + bytes[i] : offset;
  return begin_of(part, offset);
}

std::uint64_t Packing::total() const {
  return offset(static_cast<TilePart>(kPartCount));
}

const char* key_of(TilePart part) {
  return row_of(part).key;
}

unsigned component_of(AttributeKind kind, const TileColours& colours) {
  return kind == AttributeKind::colours ? colours.component() : kF32;
}

ChannelGroups groups_of(const AttributeLayout& layout) {
  const AttributeParts parts = layout.parts();
  ChannelGroups groups;
  std::ranges::transform(kAttributeSections, groups.begin(), [&](const AttributeSection& section) {
    const AttributePart& part = parts[static_cast<std::size_t>(section.kind)];
    return ChannelGroup{section.kind, section.part, section.raw, part.first, part.count};
  });
  return groups;
}

TilePlan::TilePlan(const TileShape& shape, const AttributeLayout& layout,
                   const std::optional<Lattice>& lattice)
    : shape_(shape), layout_(layout), lattice_(lattice) {
  const auto groups = groups_of(layout);
  const auto index_below = [](std::uint64_t count) {
    return count <= kMaxShortVertices ? kU16 : kU32;
  };
  const unsigned index = index_below(shape.with_splits());
  add(TilePart::position, has_short_positions() ? kU16 : kF32, 3, shape.with_splits());
  for (const PartRow& row : shown_attributes()) {
    const auto [component, components] = computed_elements(row.part, shape);
    add(row.part, component, components, shape.with_splits());
    const auto given = std::ranges::find(groups, row.part, &ChannelGroup::part);
    if (given != groups.end())
      add(row.part, component_of(given->kind, colours()), given->channels, shape.with_splits());
  }
  add(TilePart::interior, index, 1, 3 * shape.interior);
  add(TilePart::border, index, 1, 3 * shape.border);
  add(TilePart::values, kF32, layout.values.size(), shape.with_splits());
  add(TilePart::parent_map, kU16, 1, shape.node == NodeId{} ? 0 : shape.own);
  add(TilePart::neighbours, kU32, 1, shape.neighbours);
  add(TilePart::ghost_starts, kU32, 1, shape.neighbours > 0 ? shape.neighbours + 1 : 0);
  add(TilePart::ghost_chains, kU16, 1, shape.chain_entries);
  add(TilePart::copy_of, index_below(shape.places()), 1, shape.copies);
  add(TilePart::split_of, index_below(shape.vertices()), 1, shape.splits);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    add(groups[i].raw, kF32, groups[i].channels, shape.raw[i] ? shape.vertices() : 0);
  }
  add(TilePart::raw_values, kF32, layout.part(AttributeKind::values).count,
      shape.raw_values ? shape.vertices() : 0);
  add(TilePart::objects, kU8, 1, shape.objects ? ObjectColumns(*shape.objects).bytes : 0);
  add(TilePart::image, kU8, 1, shape.image.bytes);
  add(TilePart::normal_map, kU8, 1, shape.normal_map.bytes);
}

void TilePlan::add(TilePart part, unsigned component, std::size_t components, std::uint64_t count) {
  if (components == 0 || count == 0)
    return;
  bytes_ = begin_of(part, bytes_);
  const std::uint64_t size = component_bytes(component) * components;
  const bool is_padded = components > 1 || part == TilePart::feature;
  sections_[static_cast<std::size_t>(part)] = {.component = component,
                                               .components = static_cast<unsigned>(components),
                                               .count = count,
                                               .stride = is_padded ? aligned4(size) : size,
                                               .offset = bytes_,
                                               .view = views_++};
  bytes_ = aligned4(bytes_ + count * sections_[static_cast<std::size_t>(part)].stride);
}

std::uint64_t published_attribute_bytes(const AttributeLayout& layout) {
  const TileColours colours(layout, false);
  std::uint64_t bytes = 0;
  for (const ChannelGroup& group : groups_of(layout))
    bytes += aligned4(group.channels * component_bytes(component_of(group.kind, colours)));
  // Wide types are stored twice: as viewers see them, and as they are.
  for (const ScalarAttribute& value : layout.values)
    bytes += takes_two_channels(value.type) && !is_integer(value.type) ? 12 : kValueStride;
  return bytes;
}

double expected_tile_bytes(const TileSums& tiles, std::uint64_t attribute_bytes) {
  // JSON and headers.
  const double overhead = attribute_bytes > 0 ? 1850 : 1600;
  constexpr double kChain = 6;  // two or three indices of 16 bits on average
  constexpr double kParent = sizeof(std::uint16_t);
  constexpr double kTriangle = 3 * sizeof(std::uint16_t);
  constexpr double kCopyOf = sizeof(std::uint16_t);
  const double vertex = 12 + static_cast<double>(attribute_bytes);
  const double ghosts = tiles.boundary * tiles.ghosts_per_boundary;
  const double copies = tiles.copies + ghosts * tiles.copies_per_vertex();
  return tiles.vertices * (vertex + kParent) + ghosts * (vertex + kChain) +
         copies * (vertex + kCopyOf) + (tiles.triangles + tiles.wide_triangles) * kTriangle +
         tiles.count * overhead;
}

double expected_split_bytes(std::uint64_t attribute_bytes) {
  return 12 + static_cast<double>(attribute_bytes) + sizeof(std::uint16_t);
}

}  // namespace meshhier::storage

#include "mesh_io/tileset_document.h"

#include "base/error.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_stream.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {
namespace {

/// A tile takes two levels of JSON below its parent.
constexpr int kDeepestTilesetJson = 512;
/// Numbers of cells are exact in doubles.
constexpr std::uint64_t kMostImplicitLevels = 52;

nlohmann::json parsed_content(const storage::File& file, std::uint64_t most_bytes) {
  const auto stream = open_stream({file, file.size()}, {});
  std::string text;
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  for (std::size_t got = kBlock; got == kBlock && text.size() <= most_bytes;) {
    const std::size_t size = text.size();
    text.resize(size + kBlock);
    got = stream->read(std::as_writable_bytes(std::span(text)).subspan(size));
    text.resize(size + got);
  }
  return parse_gltf_json(std::move(text), file.path(), most_bytes, kDeepestTilesetJson);
}

GltfTransform transform_of(const GltfObject& tile) {
  const auto numbers = tile.numbers("transform", 16);
  if (!numbers)
    return {};
  std::array<double, 16> columns{};
  std::ranges::copy(*numbers, columns.begin());
  if (!std::ranges::all_of(columns, [](double x) { return std::isfinite(x); }))
    tile.fail("has a transform that is not finite");
  return gltf_matrix(columns);
}

/// Returns a tile's volume. Only the root's is refused: volumes of other tiles only serve to place
/// a tileset of the whole globe.
std::optional<VolumeNumbers> volume_of(const GltfObject& tile, bool is_root) {
  try {
    return VolumeNumbers::of(tile);
  } catch (const Error&) {
    if (is_root)
      throw;
    return std::nullopt;
  }
}

GltfTransform axes_of(const GltfObject& asset) {
  const std::string up = asset.text("gltfUpAxis").value_or("Y");
  if (up == "Z" || up == "z")
    return {};
  if (up == "X" || up == "x")
    return {{Vec3d{0, 0, -1}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}}, {}};
  return {{Vec3d{1, 0, 0}, Vec3d{0, 0, -1}, Vec3d{0, 1, 0}}, {}};
}

Refine refine_of(const GltfObject& tile) {
  std::string refine = tile.text("refine").value_or("");
  std::ranges::transform(refine, refine.begin(), [](unsigned char c) { return std::toupper(c); });
  return refine.empty() ? Refine::inherited : refine == "ADD" ? Refine::add : Refine::replace;
}

template <class Visit>
void for_each_content(const GltfObject& tile, const Visit& visit) {
  if (const auto content = tile.object("content"))
    visit(*content);
  tile.for_each("contents", visit);
  if (const auto several = tile.extension("3DTILES_multiple_contents")) {
    several->for_each("contents", visit);
    several->for_each("content", visit);
  }
}

TileContentName name_of_content(const GltfObject& content, const GltfObject& tile,
                                std::uint32_t number) {
  auto uri = content.text("uri");
  if (!uri)
    uri = content.text("url");  // before 1.0
  return {std::move(uri), number, content.place().substr(tile.place().size())};
}

std::optional<GltfObject> implicit_of(const GltfObject& tile) {
  auto implicit = tile.object("implicitTiling");
  return implicit ? implicit : tile.extension("3DTILES_implicit_tiling");
}

SubtreeShape shape_of(const GltfObject& implicit) {
  const std::string scheme = implicit.text("subdivisionScheme").value_or("");
  if (scheme != "QUADTREE" && scheme != "OCTREE")
    implicit.fail("has no subdivisionScheme \"QUADTREE\" or \"OCTREE\"");
  SubtreeShape shape{.is_octree = scheme == "OCTREE"};
  std::uint32_t most = 1;
  while (shape.tiles_of(most + 1) <= kMostAvailabilityBits)
    ++most;
  shape.levels = static_cast<std::uint32_t>(implicit.require_count("subtreeLevels", most));
  if (shape.levels == 0)
    implicit.fail("has subtrees of no levels");
  return shape;
}

/// Returns the count of levels, which the draft before 1.0 says as the number of the last one.
std::uint32_t levels_of(const GltfObject& implicit) {
  const auto last = implicit.count("maximumLevel", kMostImplicitLevels - 1);
  const std::uint64_t levels = last && !implicit.has("availableLevels")
                                   ? *last + 1
                                   : implicit.require_count("availableLevels", kMostImplicitLevels);
  if (levels == 0)
    implicit.fail("has tiles on no level");
  return static_cast<std::uint32_t>(levels);
}

/// `number`: of the tile.
ImplicitTiling read_implicit(const GltfObject& implicit, std::uint32_t number,
                             const std::optional<VolumeNumbers>& volume) {
  const auto subtrees = implicit.require_object("subtrees").text("uri");
  if (!subtrees)
    implicit.fail("has no subtrees.uri");
  return {number, shape_of(implicit), levels_of(implicit), *subtrees, volume};
}

void add_tile(const GltfObject& tile, std::optional<std::uint32_t> parent, std::uint32_t child,
              TilesetDocument& to) {
  const auto number = static_cast<std::uint32_t>(to.tiles.size());
  const auto first = static_cast<std::uint32_t>(to.contents.size());
  const std::optional<VolumeNumbers> volume = volume_of(tile, !parent);
  if (const auto implicit = implicit_of(tile)) {
    if (tile.item_count("children") > 0)
      tile.fail("has implicit tiles beside \"children\"");
    to.implicit.push_back(read_implicit(*implicit, number, volume));
  }
  for_each_content(tile, [&](const GltfObject& content) {
    to.contents.push_back(name_of_content(content, tile, number));
  });
  to.tiles.push_back({.parent = parent,
                      .number = child,
                      .refine = refine_of(tile),
                      .is_leaf = tile.item_count("children") == 0,
                      .transform = transform_of(tile),
                      .volume = volume ? volume->ball() : std::nullopt,
                      .first_content = first,
                      .end_content = static_cast<std::uint32_t>(to.contents.size())});
  std::uint32_t next = 0;
  tile.for_each("children",
                [&](const GltfObject& within) { add_tile(within, number, next++, to); });
}

/// Returns the origin's move of a hierarchy, which its root has.
GltfTransform origin_of(const GltfObject& root) {
  GltfTransform move;
  const auto extras = root.object("extras");
  if (const auto origin = extras ? extras->numbers("origin", 3) : std::nullopt)
    move.offset = {(*origin)[0], (*origin)[1], (*origin)[2]};
  return move;
}

}  // namespace

GltfTransform from_input(const TilesetDocument& document) {
  GltfTransform back;
  back.offset = document.origin.offset * -1.0;
  return document.origin == GltfTransform{} ? document.tiles[0].transform
                                            : document.tiles[0].transform * back;
}

std::string place_of(const TilesetDocument& document, const TileContentName& content) {
  std::string place = content.place;
  const TilesetTile* tile = &document.tiles[content.tile];
  for (; tile->parent; tile = &document.tiles[*tile->parent])
    place.insert(0, fmt::format(".children[{}]", tile->number));
  return "root" + place;
}

TilesetDocument read_tileset_document(const storage::File& file, std::uint64_t most_bytes) {
  const nlohmann::json json = parsed_content(file, most_bytes);
  const GltfObject tileset(json, file.path());
  const GltfObject root = tileset.require_object("root");
  const GltfObject asset = tileset.require_object("asset");
  TilesetDocument document{.path = file.path(), .axes = axes_of(asset)};
  document.is_hierarchy = asset.has_object("extras") &&
                          asset.require_object("extras").has_text("generator", "meshhier");
  if (document.is_hierarchy)
    document.origin = origin_of(root);
  add_tile(root, std::nullopt, 0, document);
  return document;
}

}  // namespace meshhier::mesh_io

#include "mesh_io/tileset_document.h"

#include "base/angle.h"
#include "base/error.h"
#include "base/wgs84.h"
#include "mesh_io/gltf_json.h"
#include "mesh_io/input_stream.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meshhier::mesh_io {
namespace {

/// A tile takes two levels of JSON below its parent.
constexpr int kDeepestTilesetJson = 512;

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

/// Returns the radius of the longest parallel between two latitudes.
double longest_parallel(double south, double north) {
  if (south * north <= 0)
    return wgs84::kEquator;
  return wgs84::kEquator * std::max(turn_by(south).cosine, turn_by(north).cosine);
}

/// Returns the volume of west, south, east, north in radians, least and largest height; nothing if
/// there is no such region.
std::optional<TileVolume> volume_of_region(const std::vector<double>& region) {
  constexpr double kTurn = 2 * std::numbers::pi;
  if (!std::ranges::all_of(std::span(region).first(4),
                           [](double angle) { return std::abs(angle) <= std::numbers::pi; }))
    return std::nullopt;
  const double east = region[2] + (region[2] < region[0] ? kTurn : 0);
  const double width = (east - region[0]) * longest_parallel(region[1], region[3]);
  const double height = std::abs(region[3] - region[1]) * wgs84::kEquator;
  const UnitTurn longitude = turn_by((region[0] + east) / 2);
  const UnitTurn latitude = turn_by((region[1] + region[3]) / 2);
  return TileVolume{.middle = wgs84::geocentric(longitude, latitude, (region[4] + region[5]) / 2),
                    .radius = (width + height + std::abs(region[5] - region[4])) / 2,
                    .is_geocentric = true};
}

TileVolume volume_of_box(const std::vector<double>& box) {
  double square = 0;
  for (std::size_t i = 3; i < box.size(); ++i)
    square += box[i] * box[i];
  return {.middle = {box[0], box[1], box[2]}, .radius = std::sqrt(square)};
}

/// Returns the root's volume; refuses one whose numbers are no volume.
std::optional<TileVolume> volume_of_root(const GltfObject& root) {
  const auto volume = root.object("boundingVolume");
  if (!volume)
    return std::nullopt;
  if (const auto region = volume->numbers("region", 6)) {
    const auto found = volume_of_region(*region);
    if (!found)
      volume->fail("has a region beyond half a turn");
    return found;
  }
  if (const auto box = volume->numbers("box", 12))
    return volume_of_box(*box);
  if (const auto ball = volume->numbers("sphere", 4))
    return TileVolume{.middle = {(*ball)[0], (*ball)[1], (*ball)[2]},
                      .radius = std::abs((*ball)[3])};
  return std::nullopt;
}

/// Returns a tile's volume. Only the root's is refused: volumes of other tiles only serve to place
/// a tileset of the whole globe.
std::optional<TileVolume> volume_of(const GltfObject& tile, bool is_root) {
  try {
    return volume_of_root(tile);
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

void add_tile(const GltfObject& tile, std::optional<std::uint32_t> parent, std::uint32_t child,
              TilesetDocument& to) {
  if (tile.has("implicitTiling") || tile.extension("3DTILES_implicit_tiling"))
    tile.fail(
        "has implicit tiles, which are not read; write the tileset with explicit ones, or give "
        "the mesh that it was made of");
  const auto number = static_cast<std::uint32_t>(to.tiles.size());
  const auto first = static_cast<std::uint32_t>(to.contents.size());
  for_each_content(tile, [&](const GltfObject& content) {
    to.contents.push_back(name_of_content(content, tile, number));
  });
  to.tiles.push_back({.parent = parent,
                      .number = child,
                      .refine = refine_of(tile),
                      .is_leaf = tile.item_count("children") == 0,
                      .transform = transform_of(tile),
                      .volume = volume_of(tile, !parent),
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

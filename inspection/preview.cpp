#include "inspection/preview.h"

#include "base/bounds.h"
#include "base/error.h"
#include "base/plain_text.h"
#include "execution/size_text.h"
#include "export/cut_file.h"
#include "export/piece.h"
#include "export/region.h"
#include "export/triangle_clipper.h"
#include "hierarchy/cut.h"
#include "images/image_codec.h"
#include "inspection/drawn_view.h"
#include "inspection/shown_tiles.h"
#include "inspection/tile_drawing.h"
#include "render/painting.h"
#include "render/points.h"
#include "render/scene.h"
#include "render/tile_facets.h"
#include "storage/format/archive_files.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/work_directory.h"
#include "storage/io/output_file.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::inspection {
namespace {

/// Colours, which are light already, and tangents.
constexpr std::size_t kMixedChannels = 6;

exporting::ClippedCorner corner_of(const render::FacetCorner& from, Vec2f texcoord,
                                   const Vec3f& tangent) {
  exporting::ClippedCorner corner;
  corner.position = from.position;
  corner.normal = from.normal;
  corner.attributes = {from.colour.x, from.colour.y, from.colour.z,
                       tangent.x,     tangent.y,     tangent.z};
  corner.texcoord = texcoord;
  return corner;
}

render::FacetCorner facet_corner(const exporting::ClippedCorner& from) {
  return {from.position, from.normal, {from.attributes[0], from.attributes[1], from.attributes[2]}};
}

Vec3f tangent_of(const exporting::ClippedCorner& from) {
  return {from.attributes[3], from.attributes[4], from.attributes[5]};
}

/// Cuts facets where the region ends, with their skins; those without area, which stand for points,
/// stay if they lie in it. O(t).
render::SceneTile clip_scene(render::SceneTile tile, const exporting::Region& region) {
  const exporting::CornerMixer mixer({}, kMixedChannels);
  const exporting::TriangleClipper clipper(region, mixer);
  std::vector<render::Facet> facets;
  std::vector<render::Skin> skins;
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    const render::Facet& facet = tile.facets[i];
    const render::Skin skin = tile.skins.empty() ? render::Skin{} : tile.skins[i];
    exporting::ClippedPolygon triangle;
    for (std::size_t k = 0; k < 3; ++k)
      triangle.push_back(corner_of(facet[k], skin.texcoords[k], skin.tangents[k]));
    for (const exporting::ClippedPolygon& piece : clipper.pieces(std::move(triangle))) {
      for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
        facets.push_back(
            {facet_corner(piece[0]), facet_corner(piece[k]), facet_corner(piece[k + 1])});
        if (tile.skins.empty())
          continue;
        render::Skin& made = skins.emplace_back(skin);
        made.texcoords = {piece[0].texcoord, piece[k].texcoord, piece[k + 1].texcoord};
        made.tangents = {tangent_of(piece[0]), tangent_of(piece[k]), tangent_of(piece[k + 1])};
      }
    }
  }
  tile.facets = std::move(facets);
  tile.skins = std::move(skins);
  return tile;
}

using storage::HierarchyReader;

constexpr int kQuality = 90;

/// Loads a tile, of objects that are asked for their triangles.
ShownTile load_in(const std::optional<exporting::Region>& region, ShownTiles& tiles,
                  std::size_t position) {
  ShownTile shown = tiles.load(position);
  if (region && region->objects)
    keep_objects(*region->objects, shown.tile, shown.border);
  return shown;
}

/// Adds the facets of a tile that lie in the piece, without pictures.
void add_piece(ShownTile shown, const AttributeLayout& layout, const exporting::Region& region,
               std::vector<render::Facet>& facets) {
  drop_pictures(shown.tile);
  const bool is_points =
      !region.objects && shown.tile.mesh.interior.empty() && shown.border.empty();
  const render::SceneTile piece =
      clip_scene(is_points ? render::SceneTile{render::points_of(shown.tile, layout), {}, {}}
                           : render::scene_tile(shown.tile, layout, shown.border),
                 region);
  facets.insert(facets.end(), piece.facets.begin(), piece.facets.end());
}

/// Returns facets of the piece, from the coarsest level that shows its form: one with some tiles
/// and facets in it.
std::vector<render::Facet> piece_facets(const HierarchyReader& reader,
                                        const exporting::Region& region, std::uint64_t cache_bytes,
                                        const execution::CancelToken& cancel) {
  constexpr std::size_t kSomeTiles = 4, kSomeFacets = 100;
  const Tree& tree = reader.tree();
  std::vector<render::Facet> facets;
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    Cut cut = Cut::of_level(tree, static_cast<Level>(level));
    const std::vector<std::size_t> positions = exporting::tiles_in(reader, cut, region);
    const bool is_finest = level == raw(tree.depth());
    if (positions.size() < kSomeTiles && !is_finest)
      continue;
    ShownTiles tiles(reader, std::move(cut), cache_bytes);
    tiles.will_load(positions);
    facets.clear();
    for (const std::size_t position : positions) {
      cancel.check();
      add_piece(load_in(region, tiles, position), reader.tile_format().attributes, region, facets);
    }
    if (facets.size() >= kSomeFacets)
      break;
  }
  return facets;
}

Cut cut_for(storage::FileSystem& files, const HierarchyReader& reader,
            const PreviewOptions& options, const TileDrawing& drawing) {
  if (!options.selection)
    return exporting::coarsest_cut(
        reader, [&](const TileRecord& record) { return drawing.is_fine(record); });
  if (const auto* level = std::get_if<Level>(&*options.selection)) {
    require_level(reader.tree(), *level);
    return Cut::of_level(reader.tree(), *level);
  }
  if (const auto* path = std::get_if<std::filesystem::path>(&*options.selection))
    return exporting::read_cut(files, reader.tree(), *path);
  return cut_by_error(reader, std::get<exporting::LargestError>(*options.selection));
}

/// The tiles that a picture is of.
struct Pictured {
  ShownTiles tiles;
  std::vector<std::size_t> positions;  ///< positions of the tiles in their cut

  NodeId node(std::size_t i) const { return tiles.cut()[positions[i]]; }
};

Pictured pictured(const HierarchyReader& reader, Cut cut,
                  const std::optional<exporting::Region>& region, std::uint64_t cache_bytes) {
  std::vector<std::size_t> positions(cut.size());
  std::iota(positions.begin(), positions.end(), std::size_t{0});
  if (region)
    positions = exporting::tiles_in(reader, cut, *region);
  Pictured shown{ShownTiles(reader, std::move(cut), cache_bytes), std::move(positions)};
  shown.tiles.will_load(shown.positions);
  return shown;
}

/// Returns the boxes in which tiles draw. Where levels meet, a tile reaches to the vertices of its
/// coarser neighbour, and may draw anywhere.
std::vector<Bounds> boxes_of(const HierarchyReader& reader, const Pictured& shown,
                             const TileDrawing& drawing, double point_side) {
  bool is_even = true;
  std::vector<Bounds> boxes;
  Bounds all;
  for (std::size_t i = 0; i < shown.positions.size(); ++i) {
    const TileRecord& record = reader.record(shown.node(i));
    is_even = is_even && record.node.level == reader.record(shown.node(0)).node.level;
    boxes.push_back(render::box_of_squares(drawing.box_of(record.bounds), point_side));
    all.add(boxes.back());
  }
  if (!is_even)
    std::ranges::fill(boxes, all);
  return boxes;
}

/// Returns 0 if triangles are drawn.
double point_side_of(const HierarchyReader& reader, const Pictured& shown,
                     const render::Camera& camera) {
  if (reader.record(NodeId{}).interior_count > 0)
    return 0;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < shown.positions.size(); ++i)
    points += reader.record(shown.node(i)).own_count;
  return render::point_side(camera, points);
}

/// Returns the memory of a picture, its file and its encoder.
std::uint64_t picture_bytes(const PreviewOptions& options) {
  constexpr std::uint64_t kPixelBytes = 16;
  return kPixelBytes * options.width * options.height;
}

void require_room(const PreviewOptions& options) {
  constexpr std::uint64_t kOther = std::uint64_t{64} << 20;  // tiles, and samples for some rows
  const std::uint64_t needed = picture_bytes(options) + kOther;
  if (options.memory_budget < needed) {
    throw Error(ErrorCode::budget,
                fmt::format("a picture of {} x {} pixels needs --memory-budget {} or more",
                            options.width, options.height, execution::exact_size_text(needed)));
  }
}

void lay_on(const std::array<std::uint8_t, 3>& ground, images::Image& picture) {
  for (std::size_t i = 0; i < picture.texels.size(); i += 4) {
    const std::uint32_t alpha = picture.texels[i + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      picture.texels[i + c] = static_cast<std::uint8_t>(
          (alpha * picture.texels[i + c] + (255 - alpha) * ground[c] + 127) / 255);
    }
    picture.texels[i + 3] = 255;
  }
}

/// Returns for people what the picture shows.
std::string text_of(const HierarchyReader& reader, const Pictured& shown, bool is_part) {
  if (is_part || shown.positions.size() < shown.tiles.size())
    return fmt::format("{} of {}", shown.positions.size(), counted(shown.tiles.size(), "tiles"));
  std::uint64_t triangles = 0;
  for (const NodeId node : shown.tiles.cut().nodes()) {
    const TileRecord& record = reader.record(node);
    triangles += std::uint64_t{record.interior_count} + record.drawn_border_count;
  }
  return fmt::format("{}, {}", counted(shown.tiles.size(), "tiles"),
                     counted(triangles, "triangles"));
}

storage::OutputRequest request_of(const PreviewOptions& options,
                                  const std::filesystem::path& hierarchy) {
  storage::OutputRequest request{options.output, options.replace, {hierarchy}};
  if (options.selection) {
    if (const auto* cut = std::get_if<std::filesystem::path>(&*options.selection))
      request.inputs.push_back(*cut);
  }
  request.inputs.push_back(options.region.polygon);
  return request;
}

/// Returns what is shown of the model: what the options say, else the objects that the view shows;
/// nothing if it is all.
std::optional<exporting::Region> region_shown(storage::FileSystem& files,
                                              const HierarchyReader& reader,
                                              const PreviewOptions& options, const ModelView& view,
                                              const execution::CancelToken& cancel) {
  exporting::RegionRequest request = options.region;
  if (auto shown = shown_objects(reader, view, cancel); shown && !options.region.is_any())
    request.objects.numbers = std::move(shown);
  if (!request.is_any())
    return std::nullopt;
  return region_of(files, reader, request, cancel);
}

}  // namespace

std::string make_picture(storage::FileSystem& files, const std::filesystem::path& hierarchy,
                         const PreviewOptions& options, execution::Progress& progress,
                         const execution::CancelToken& cancel) {
  require_room(options);
  const storage::HierarchyFiles place(files, hierarchy);
  const HierarchyReader reader(place.files(), hierarchy);
  if (!storage::is_standard_output(files, options.output))
    storage::require_outside(files, options.output);
  storage::OutputFile output(files, request_of(options, hierarchy), [&] { cancel.check(); });

  const DrawnView drawn = drawn_view(reader, options, progress);
  const std::optional<exporting::Region> region =
      region_shown(files, reader, options, drawn.view, cancel);
  const std::uint64_t cache_bytes = options.memory_budget / 8;
  TileDrawing drawing(reader, options, drawn, cancel);
  if (options.region.is_any()) {
    const auto piece = piece_facets(reader, *region, cache_bytes, cancel);
    if (piece.empty())
      fail_empty(reader, options.region);
    drawing.aim(piece);
  } else {
    drawing.aim(drawing.root());
  }
  Pictured shown = pictured(reader, cut_for(files, reader, options, drawing), region, cache_bytes);
  const double point_side = point_side_of(reader, shown, drawing.camera());
  std::atomic<bool> is_any = false;
  const auto load = [&](std::size_t i) {
    render::SceneTile tile =
        drawing.facets_of(load_in(region, shown.tiles, shown.positions[i]), point_side > 0);
    if (region)
      tile = clip_scene(std::move(tile), *region);
    drawing.place(tile);
    if (point_side > 0)
      tile.facets = render::squares_of(tile.facets, drawing.axes(), point_side);
    if (!tile.facets.empty())
      is_any = true;
    return tile;
  };
  const render::Camera& camera = drawing.camera();
  const render::Scene scene{boxes_of(reader, shown, drawing, point_side), load, drawing.look()};
  const render::PaintingOptions painting{
      .band_bytes = (options.memory_budget - picture_bytes(options)) / 2, .step = [&] {
        cancel.check();
        progress.advance(1);
      }};
  progress.stage("preview", render::painting_steps(scene, camera, painting), "tiles");
  images::Image picture = render::paint(scene, camera, painting);
  if (options.region.is_any() && region->objects && !is_any)
    fail_empty(reader, options.region);
  if (options.background)
    lay_on(*options.background, picture);
  output.publish(images::encode_image(picture, options.format, kQuality));
  const std::string& legend = drawing.legend();
  return fmt::format("{}: {} x {} pixels, {}{}{}", options.output.string(), options.width,
                     options.height, text_of(reader, shown, region && region->objects),
                     legend.empty() ? "" : "\n", legend);
}

}  // namespace meshhier::inspection

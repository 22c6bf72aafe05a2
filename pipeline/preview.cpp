#include "pipeline/preview.h"

#include "hierarchy/cut.h"
#include "images/fitted.h"
#include "render/drawing_cost.h"
#include "render/painting.h"
#include "render/points.h"
#include "render/portrait.h"
#include "render/shown_view.h"
#include "render/terrain.h"
#include "render/tile_facets.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/io/hash.h"
#include "storage/io/sealed_file.h"

#include <optional>
#include <utility>

namespace meshhier::pipeline {
namespace {

/// The most triangles of the level that is drawn: more show nothing in so few pixels, and take
/// longer.
constexpr std::uint64_t kMostTriangles = 60'000;

/// The most texels of its pictures, which are decoded a few times.
constexpr std::uint64_t kMostTexels = 2048 * 2048;

/// The most samples to look at, which takes seconds: large triangles may lie on each other in any
/// number. With more the picture is smaller.
constexpr std::uint64_t kMostSamples = std::uint64_t{1} << 28;
constexpr std::uint32_t kLeastSide = 16;

/// Memory of the samples that are held at a time: as many as one for each pixel.
constexpr std::uint64_t kBandBytes =
    sizeof(render::Sample) * storage::kMostPreviewSide * storage::kMostPreviewSide;
/// Memory beside a tile: samples and the picture, then the encoder; and facets.
constexpr std::uint64_t kPaintingBytes =
    kBandBytes + (3 << 20) + kMostTriangles * sizeof(render::Facet);

/// Whether there is nothing but vertices to draw.
bool is_of_points(std::span<const TileRecord> records) {
  return storage::record_of(records, NodeId{}).interior_count == 0;
}

/// Whether a cut is quick to draw. Tiles draw all of their border, also triangles that they leave
/// to each other; a point is two triangles.
bool is_quick(const Cut& cut, std::span<const TileRecord> records) {
  std::uint64_t triangles = 0, texels = 0;
  for (const NodeId node : cut.nodes()) {
    const TileRecord& record = storage::record_of(records, node);
    triangles += is_of_points(records) ? 2 * std::uint64_t{record.own_count}
                                       : std::uint64_t{record.interior_count} + record.border_count;
    texels += std::uint64_t{record.image_width} * record.image_height;
  }
  return triangles <= kMostTriangles && texels <= kMostTexels;
}

/// Returns the finest level of those that are quick to draw, or the root.
Cut shown_cut(const Tree& tree, std::span<const TileRecord> records) {
  Cut shown = Cut::of_level(tree, Level{0});
  for (Level level{0}; level < tree.depth();) {
    level = finer(level);
    Cut next = Cut::of_level(tree, level);
    if (!is_quick(next, records))
      break;
    shown = std::move(next);
  }
  return shown;
}

PublishedTile tile_of(const PreviewInput& input, NodeId node, const StageContext& context) {
  const TileRecord& record = storage::record_of(input.records, node);
  const auto path = storage::tile_path(input.directory, record.node);
  const auto bytes = storage::read_sealed(context.files, path, {record.file_bytes, record.checksum},
                                          record.file_bytes);
  return storage::decode_tile(bytes, record.node, context.tree(), input.format, path.string());
}

/// Returns the facets of a tile without its pictures, which need not be decoded to see where they
/// lie.
std::vector<render::Facet> facets_of(PublishedTile tile, const AttributeLayout& layout) {
  tile.image = tile.normal_map = {};
  return render::scene_tile(tile, layout).facets;
}

std::uint64_t vertices_of(const Cut& cut, std::span<const TileRecord> records) {
  std::uint64_t sum = 0;
  for (const NodeId node : cut.nodes())
    sum += storage::record_of(records, node).own_count;
  return sum;
}

/// Returns the facets of the root: its points if there is nothing else.
std::vector<render::Facet> root_facets(const PublishedTile& root, const AttributeLayout& layout) {
  return root.mesh.interior.empty() ? render::points_of(root, layout) : facets_of(root, layout);
}

/// The view of a model.
struct Portrait {
  render::Sight sight;
  AttributeLayout layout;  ///< as it is drawn
  double point_side = 0;   ///< 0: triangles are drawn
  render::Look look{};
  ModelView view{};                                   ///< the config's
  std::optional<render::AttributePainter> painter{};  ///< as the view has it
  std::optional<render::Placement> placement{};       ///< none: nobody said it
};

render::Look look_of(const PublishedTile& root, const storage::TileFormat& format) {
  const bool is_unlit = format.textures && format.textures->unlit;
  return {is_unlit ? render::Light::none : render::Light::lamps, format.textures.has_value(),
          format.frame.up, render::terrain_of(root, format.frame.up)};
}

constexpr render::Framing kFraming{
    .width = storage::kMostPreviewSide, .height = storage::kMostPreviewSide, .samples = 2};

/// Returns the portrait of a model that nobody said anything of.
Portrait plain_portrait(const PublishedTile& root, const PreviewInput& input) {
  const std::vector<render::Facet> whole = root_facets(root, input.format.attributes);
  const render::View view =
      render::view_from(*root.first_view, direction_of(input.format.frame.up));
  return {.sight = {render::portrait_camera(whole, view, kFraming), render::axes_of(view)},
          .layout = render::drawn_layout(whole, input.format.attributes),
          .look = look_of(root, input.format)};
}

/// Returns the portrait that a view wants.
Portrait viewed_portrait(PublishedTile root, const PreviewInput& input, const ModelView& asked) {
  const ModelView view = render::known_view(asked, input.source);
  const UpAxis up = input.format.frame.up;
  render::Placement placement(view, up, input.origin);
  render::Look look = look_of(root, input.format);
  render::add_to_look(view, root, placement.standing(), look);
  const bool looks_in = render::looks_in(view, root.mesh, placement.standing().upwards());
  std::optional<render::AttributePainter> painter;
  if (const auto attribute = render::attribute_of(view, input.source))
    painter.emplace(input.source, *attribute);
  AttributeLayout layout = render::painted_layout(view, painter, input.format.attributes);
  render::paint(view, painter, root);
  const std::vector<render::Facet> whole = placement.upright(root_facets(root, layout));
  if (!painter)
    layout = render::drawn_layout(whole, layout);
  constexpr Vec3d kUp{0, 1, 0};
  const bool is_as_built = placement.standing().upwards() == direction_of(up);
  const render::View from =
      render::view_from(is_as_built ? *root.first_view : render::portrait_from(whole, kUp), kUp);
  render::Sight sight{render::portrait_camera(whole, from, kFraming), render::axes_of(from)};
  if (const auto pose = render::pose_of(view))
    sight = placement.look_from(*pose, render::rays_of(view), kFraming);
  if (looks_in)
    placement.hide_backs(sight);
  return {.sight = sight,
          .layout = layout,
          .look = look,
          .view = view,
          .painter = std::move(painter),
          .placement = std::move(placement)};
}

Portrait portrait_of(const PublishedTile& root, const PreviewInput& input, const Cut& cut,
                     const ModelView& view) {
  Portrait portrait =
      view.empty() ? plain_portrait(root, input) : viewed_portrait(root, input, view);
  if (is_of_points(input.records))
    portrait.point_side =
        render::point_side(portrait.sight.camera, vertices_of(cut, input.records));
  return portrait;
}

render::SceneTile drawn_tile(PublishedTile tile, const Portrait& portrait) {
  const bool is_viewed = portrait.placement.has_value();
  if (is_viewed)
    render::paint(portrait.view, portrait.painter, tile);
  render::SceneTile drawn;
  if (portrait.point_side == 0) {
    drawn = render::scene_tile(tile, portrait.layout);
    if (is_viewed)
      render::paint(portrait.view, portrait.painter, tile.node, drawn);
    render::apply_look(portrait.look, portrait.layout, drawn);
  } else {
    drawn.facets = render::points_of(tile, portrait.layout);
  }
  if (is_viewed)
    portrait.placement->place(drawn);
  if (portrait.point_side > 0)
    drawn.facets = render::squares_of(drawn.facets, portrait.sight.axes, portrait.point_side);
  return drawn;
}

/// Gives tiles to be drawn, several times each. Without pictures it holds all of them, which have
/// at most kMostTriangles.
class DrawnTiles {
 public:
  DrawnTiles(const PreviewInput& input, const Cut& cut, const PublishedTile& root,
             const Portrait& portrait, const StageContext& context)
      : input_(input),
        nodes_(cut.nodes().begin(), cut.nodes().end()),
        portrait_(portrait),
        context_(context) {
    if (input.format.textures || portrait.point_side > 0)
      return;
    if (nodes_.size() == 1 && root.mesh.interior.size() + root.mesh.border.size() > kMostTriangles)
      return;
    for (const NodeId node : nodes_) {
      context.cancel.check();
      held_.push_back(
          drawn_tile(node == root.node ? root : tile_of(input, node, context), portrait));
    }
  }

  std::size_t count() const { return nodes_.size(); }
  std::span<const render::SceneTile> held() const { return held_; }
  render::SceneTile load(std::size_t tile) const {
    return drawn_tile(tile_of(input_, nodes_[tile], context_), portrait_);
  }
  /// Counts the samples of a tile's triangles, also where points are drawn.
  std::uint64_t samples(std::size_t tile) const {
    const auto count = [&](std::span<const render::Facet> facets) {
      return render::samples_to_draw(facets, portrait_.sight.camera);
    };
    return held_.empty()
               ? count(facets_of(tile_of(input_, nodes_[tile], context_), portrait_.layout))
               : count(held_[tile].facets);
  }

 private:
  const PreviewInput& input_;
  std::vector<NodeId> nodes_;
  const Portrait& portrait_;
  const StageContext& context_;
  std::vector<render::SceneTile> held_;  ///< all tiles, or none
};

/// Returns the scene of a cut. Tiles draw all of their border: triangles between two of them are
/// drawn twice, and nothing is missing.
render::Scene scene_of(const PreviewInput& input, const Cut& cut, const Portrait& portrait,
                       const DrawnTiles& tiles) {
  render::Scene scene;
  scene.look = portrait.look;
  for (const NodeId node : cut.nodes()) {
    const Bounds& box = storage::record_of(input.records, node).bounds;
    scene.boxes.push_back(render::box_of_squares(
        portrait.placement ? portrait.placement->box_of(box) : box, portrait.point_side));
  }
  scene.load = [&tiles](std::size_t i) { return tiles.load(i); };
  scene.held = tiles.held();
  return scene;
}

std::uint64_t samples_of(const DrawnTiles& tiles, const StageContext& context) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < tiles.count(); ++i) {
    context.cancel.check();
    sum += tiles.samples(i);
  }
  return sum;
}

/// Returns the same view, with fewer pixels if that is too much to draw.
render::Camera affordable(const render::Camera& camera, std::uint64_t samples) {
  render::Framing framing = camera.framing();
  for (; samples > kMostSamples && framing.width > kLeastSide && framing.height > kLeastSide;
       samples /= 4) {
    framing.width /= 2;
    framing.height /= 2;
  }
  return camera.with(framing);
}

}  // namespace

Standpoint choose_first_view(const PublishedTile& root, const storage::TileFormat& format) {
  return render::portrait_from(root_facets(root, format.attributes), direction_of(format.frame.up));
}

PublishedTile read_root(const PreviewInput& input, const StageContext& context) {
  return tile_of(input, context.tree().root(), context);
}

MadePreview make_preview(const PreviewInput& input, PublishedTile root,
                         const StageContext& context) {
  const Cut cut = shown_cut(context.tree(), input.records);
  const Portrait portrait = portrait_of(root, input, cut, context.config.view);
  images::Image painted = [&] {
    const DrawnTiles tiles(input, cut, root, portrait, context);
    root = {};
    const std::uint64_t samples = samples_of(tiles, context);
    return render::paint(scene_of(input, cut, portrait, tiles),
                         affordable(portrait.sight.camera, samples),
                         {.band_bytes = kBandBytes, .step = [&] { context.cancel.check(); }});
  }();
  images::FittedImage picture =
      images::encode_to_fit(std::move(painted), storage::kMostPreviewBytes);
  const storage::Preview facts{picture.width, picture.height, picture.file.size(),
                               storage::checksum(picture.file)};
  return {facts, std::move(picture.file)};
}

std::uint64_t first_view_memory(const JobSize& job) {
  // A tile is held as it is published and decoded, and as it is drawn.
  constexpr std::uint64_t kTriangleBytes = sizeof(render::Facet) + sizeof(render::Skin) + 40;
  return job.part_triangles(job.largest_tile) * kTriangleBytes;
}

std::uint64_t preview_memory(const JobSize& job) {
  return kPaintingBytes + first_view_memory(job);
}

}  // namespace meshhier::pipeline

#include "inspection/tile_drawing.h"

#include "inspection/object_colours.h"
#include "render/points.h"
#include "render/portrait.h"
#include "render/terrain.h"
#include "render/tile_facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace meshhier::inspection {
namespace {

/// Errors are a quarter of a pixel at most.
constexpr double kPixelPart = 0.25;

/// The part of a sphere that first views keep away from: straight from above nobody knows what is
/// up.
constexpr double kSteepest = 89.5;

/// Returns the places of a tile's own triangles, or of its vertices if it has none.
std::vector<Vec3d> points_of(const TileMesh& mesh, const render::Standing& standing) {
  std::vector<bool> is_used(mesh.own_count, mesh.interior.empty());
  for (const TileTriangle& triangle : mesh.interior) {
    for (const TileVertex vertex : triangle) {
      if (raw(vertex) < mesh.own_count)
        is_used[raw(vertex)] = true;
    }
  }
  std::vector<Vec3d> points;
  for (std::size_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v])
      points.push_back(to_double(mesh.vertices.positions[v]));
  }
  points = render::silhouette_of(points);
  for (Vec3d& point : points)
    point = standing.upright(point);
  return points;
}

/// Returns a look as far as the manifest tells it, not the root tile.
render::Look look_of(const storage::HierarchyReader& reader, const PreviewOptions& options,
                     bool is_painted) {
  const auto& textures = reader.manifest().textures;
  const bool is_shown = textures && !is_painted;
  return {is_shown && textures->unlit ? render::Light::none : render::Light::lamps, is_shown,
          options.up.value_or(reader.manifest().up)};
}

}  // namespace

TileDrawing::TileDrawing(const storage::HierarchyReader& reader, const PreviewOptions& options,
                         const DrawnView& drawn, const execution::CancelToken& cancel)
    : reader_(reader), options_(options), drawn_(drawn), layout_(reader.tile_format().attributes) {
  choose_painter(cancel);
  look_ = look_of(reader, options, painter_.has_value());
  take_root(reader.read_tile({}));
}

void TileDrawing::choose_painter(const execution::CancelToken& cancel) {
  const ModelView& view = drawn_.view;
  const SourceSummary& source = reader_.manifest().source;
  std::optional<ObjectColouring> objects = options_.objects;
  if (!objects && !view.by.empty()) {
    objects = {view.by};
    if (view.between.size() == 2)
      objects->range = std::array{view.between[0], view.between[1]};
  }
  if (objects) {
    const auto table = reader_.open_objects();
    const auto colours = std::make_shared<const ObjectColours>(*table, *objects, cancel);
    legend_ = colours->legend();
    painter_.emplace(layout_, [colours](double object) { return colours->colour(object); });
  } else if (options_.attribute) {
    painter_.emplace(source, *options_.attribute);
  } else if (const auto attribute = render::attribute_of(view, source)) {
    painter_.emplace(source, *attribute);
  }
}

void TileDrawing::take_root(PublishedTile root) {
  const ModelView& view = drawn_.view;
  if (drawn_.is_plain) {
    look_.terrain = render::terrain_of(root, look_.up);
  } else {
    placement_.emplace(view, reader_.manifest().up, reader_.manifest().origin);
    render::add_to_look(view, root, placement_->standing(), look_);
    looks_in_ = render::looks_in(view, root.mesh, placement_->standing().upwards());
    if (drawn_.has_pose)
      root_points_ = points_of(root.mesh, placement_->standing());
  }
  layout_ = render::painted_layout(view, painter_, layout_);
  render::paint(view, painter_, root);
  if (root.mesh.interior.empty()) {
    root_ = render::points_of(root, layout_);
  } else {
    drop_pictures(root);
    root_ = render::scene_tile(root, layout_).facets;
  }
  if (!painter_)
    layout_ = render::drawn_layout(root_, layout_);
}

/// Which way is up in the picture's world.
Vec3d TileDrawing::up() const {
  return placement_ ? Vec3d{0, 1, 0} : direction_of(options_.up.value_or(reader_.manifest().up));
}

/// An older hierarchy has none, and one that is stood on another axis may show another side.
Standpoint TileDrawing::standpoint() const {
  if (options_.view)
    return *options_.view;
  const storage::Manifest& manifest = reader_.manifest();
  const bool is_as_built = placement_
                               ? placement_->standing().upwards() == direction_of(manifest.up)
                               : options_.up.value_or(manifest.up) == manifest.up;
  if (manifest.first_view && is_as_built)
    return *manifest.first_view;
  return render::portrait_from(placement_ ? placement_->upright(root_) : root_, up());
}

render::Pose TileDrawing::pose() const {
  if (const auto pose = render::pose_of(drawn_.view))
    return *pose;
  const storage::Manifest& manifest = reader_.manifest();
  std::optional<Vec3d> direction;
  if (manifest.first_view && placement_->standing().upwards() == direction_of(manifest.up)) {
    Standpoint from = *manifest.first_view;
    from.elevation = std::clamp(from.elevation, -kSteepest, kSteepest);
    direction = render::view_from(from, up()).direction * -1;
  }
  const BoundsD& box = manifest.source.bounds;
  return render::frame_whole(
      root_points_,
      placement_->standing().upright(BoundsD{box.min - manifest.origin, box.max - manifest.origin}),
      direction, double{1} * options_.width / options_.height, render::rays_of(drawn_.view));
}

render::Sight TileDrawing::sight(std::span<const render::Facet> framed) {
  const render::Framing framing{.width = options_.width, .height = options_.height, .samples = 2};
  if (drawn_.has_pose)
    return placement_->look_from(pose(), render::rays_of(drawn_.view), framing);
  const render::View view = render::view_from(standpoint(), up());
  return {placement_ ? render::portrait_camera(placement_->upright(framed), view, framing)
                     : render::portrait_camera(framed, view, framing),
          render::axes_of(view)};
}

void TileDrawing::aim(std::span<const render::Facet> framed) {
  sight_ = sight(framed);
  if (looks_in_)
    placement_->hide_backs(*sight_);
}

bool TileDrawing::is_fine(const TileRecord& record) const {
  if (drawn_.view.level && raw(record.node.level) >= *drawn_.view.level)
    return true;
  if (!placement_)
    return record.error <= camera().pixel() * kPixelPart;
  const double error = record.error * placement_->standing().stretch();
  const auto& perspective = placement_->perspective();
  if (!perspective)
    return error <= camera().pixel() * kPixelPart;
  const BoundsD box = placement_->standing().upright(
      BoundsD{to_double(record.bounds.min), to_double(record.bounds.max)});
  return record.bounds.empty() || !perspective->sees(box) ||
         error <= perspective->pixel_in(box) * kPixelPart;
}

Bounds TileDrawing::box_of(const Bounds& box) const {
  return placement_ ? placement_->box_of(box) : box;
}

render::SceneTile TileDrawing::facets_of(ShownTile shown, bool as_points) const {
  const NodeId node = shown.tile.node;
  render::paint(drawn_.view, painter_, shown.tile);
  render::SceneTile drawn = as_points
                                ? render::SceneTile{render::points_of(shown.tile, layout_), {}, {}}
                                : render::scene_tile(shown.tile, layout_, shown.border);
  render::paint(drawn_.view, painter_, node, drawn);
  render::apply_look(look_, layout_, drawn);
  return drawn;
}

void TileDrawing::place(render::SceneTile& tile) const {
  if (placement_)
    placement_->place(tile);
}

}  // namespace meshhier::inspection

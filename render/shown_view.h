// What a kept view (hierarchy/model_view.h) means for a picture.
#pragma once

#include "base/half_space.h"
#include "base/vec.h"
#include "hierarchy/model_view.h"
#include "hierarchy/published.h"
#include "render/attribute_painter.h"
#include "render/camera.h"
#include "render/cut_facets.h"
#include "render/perspective.h"
#include "render/scene.h"
#include "render/standing.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::render {

Standing standing_of(const ModelView& view, UpAxis of_file);

/// The pose of a view's camera; none if it has none.
std::optional<Pose> pose_of(const ModelView& view);

/// The half-spaces that its cut or box, and its storey, keep, relative to the origin. `upwards`: of
/// its standing.
std::vector<HalfSpace> kept_of(const ModelView& view, Vec3d upwards, Vec3d origin);

/// How a picture is seen.
struct Sight {
  Camera camera;
  ViewAxes axes;
};

/// Where a view has the facets of tiles: cut, stood upright, and perhaps in perspective.
class Placement {
 public:
  Placement(const ModelView& view, UpAxis of_file, Vec3d origin)
      : standing_(standing_of(view, of_file)), kept_(kept_of(view, standing_.upwards(), origin)) {}

  const Standing& standing() const { return standing_; }
  const std::optional<Perspective>& perspective() const { return perspective_; }
  /// Returns how it is seen from a pose. From now on things are placed in its perspective, unless
  /// rays are parallel.
  Sight look_from(const Pose& pose, Rays rays, const Framing& framing);
  /// From now on facets go that turn their backs to who sees it so.
  void hide_backs(const Sight& sight);

  /// Stands facets upright: all of them, without perspective.
  std::vector<Facet> upright(std::span<const Facet> facets) const;
  void place(SceneTile& tile) const;
  /// Holds what place() makes of what lies in a box; empty: nothing of it can be seen.
  Bounds box_of(const Bounds& box) const;

 private:
  Standing standing_;
  std::vector<HalfSpace> kept_;
  std::optional<Perspective> perspective_;
  std::optional<Viewer> viewer_;
};

/// The attribute that colours show; none if they show something else, or there is no attribute. One
/// that the source does not have is its first one, as the page has it.
std::optional<AttributeColours> attribute_of(const ModelView& view, const SourceSummary& source);

/// The view as the source has it: without attributes its own colours are shown instead.
ModelView known_view(ModelView view, const SourceSummary& source);

Rays rays_of(const ModelView& view);
/// Whether a view looks into rooms from outside: facets that look away are not drawn. `root`: the
/// root's mesh, which tells where the view does not.
bool looks_in(const ModelView& view, const TileMesh& root, Vec3d upwards);

/// Whether the input's own colours and pictures are shown.
bool shows_own(const ModelView& view);

/// Adds to a look what a view says. `root`: the root's tile; `standing`: of the view.
void add_to_look(const ModelView& view, const PublishedTile& root, const Standing& standing,
                 Look& look);

/// Paints a tile as a view has it, before it becomes facets.
void paint(const ModelView& view, const std::optional<AttributePainter>& painter,
           PublishedTile& tile);
/// Paints facets of a tile: a colour for each tile, and hidden labels go.
void paint(const ModelView& view, const std::optional<AttributePainter>& painter, NodeId node,
           SceneTile& tile);
/// The layout of tiles that are painted so.
AttributeLayout painted_layout(const ModelView& view,
                               const std::optional<AttributePainter>& painter,
                               AttributeLayout layout);

/// For people: what a picture does not show of a view, "wires, occlusion"; empty: nothing.
std::string not_drawn(const ModelView& view);

}  // namespace meshhier::render

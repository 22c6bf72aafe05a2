// How the tiles of a hierarchy become facets of a picture: painted, cut, stood upright, projected.
#pragma once

#include "base/vec.h"
#include "execution/cancel.h"
#include "execution/progress.h"
#include "hierarchy/cut.h"
#include "inspection/drawn_view.h"
#include "inspection/preview.h"
#include "inspection/shown_tiles.h"
#include "render/attribute_painter.h"
#include "render/camera.h"
#include "render/scene.h"
#include "render/shown_view.h"
#include "storage/format/hierarchy_reader.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meshhier::inspection {

class TileDrawing {
 public:
  /// Reads the root tile. `reader` and `options` must outlive it. Throws Error(usage | io |
  /// corrupt).
  TileDrawing(const storage::HierarchyReader& reader, const PreviewOptions& options,
              const DrawnView& drawn, const execution::CancelToken& cancel);

  /// Stands where the picture shows these facets, in the tiles' coordinates; or where the view
  /// says.
  void aim(std::span<const render::Facet> framed);
  /// The facets of the root, which has the extent of the whole.
  std::span<const render::Facet> root() const { return root_; }

  const render::Camera& camera() const { return sight_->camera; }
  const render::ViewAxes& axes() const { return sight_->axes; }
  const render::Look& look() const { return look_; }
  /// Returns for people what the colours of objects mean, or nothing.
  const std::string& legend() const { return legend_; }

  /// Whether a tile is as fine as the picture shows it, or as the view has it. After aim().
  bool is_fine(const TileRecord& record) const;
  /// Holds what draw() makes of what lies in a box. After aim().
  Bounds box_of(const Bounds& box) const;

  /// Returns the facets of a tile in the tiles' coordinates: triangles, or points as facets without
  /// area.
  render::SceneTile facets_of(ShownTile shown, bool as_points) const;
  /// Cuts them as the view says, and brings them to where the camera sees them.
  void place(render::SceneTile& tile) const;

 private:
  void choose_painter(const execution::CancelToken& cancel);
  void take_root(PublishedTile root);
  render::Sight sight(std::span<const render::Facet> framed);
  Standpoint standpoint() const;
  Vec3d up() const;
  render::Pose pose() const;

  const storage::HierarchyReader& reader_;
  const PreviewOptions& options_;
  DrawnView drawn_;
  std::optional<render::AttributePainter> painter_;
  std::string legend_;
  AttributeLayout layout_;
  render::Look look_;
  std::vector<render::Facet> root_;
  std::vector<Vec3d> root_points_;              ///< of its triangles; only with a pose
  std::optional<render::Placement> placement_;  ///< none: as the file stands
  std::optional<render::Sight> sight_;
  bool looks_in_ = false;  ///< facets that look away are not drawn
};

}  // namespace meshhier::inspection

// A tile's triangles over the pixels of a raster.
#pragma once

#include "export/cut_part.h"
#include "export/map_frame.h"
#include "export/pixel_grid.h"
#include "hierarchy/attributes.h"
#include "render/plan_raster.h"

#include <string>

namespace meshhier::exporting {

/// What all tiles of a raster have in common.
struct PlanView {
  MapFrame frame;
  PixelGrid grid;
  AttributeLayout layout;
  bool has_colours = false;  ///< else heights alone are drawn
  /// A relief has light from all around, too: upright sides and hollows of things are not dark.
  bool is_soft = false;
};

/// Returns the part over the pixels: its picture, else its colours, else, of a surface without
/// both, its relief in grey: light from the north-west, as maps have it, 45 degrees high. The
/// picture is decoded if it is shown, or if surfaces have holes by it. Throws Error(input) that
/// starts with `picture`, its name, if that is broken. Linear. Thread-safe.
render::PlanMesh plan_mesh(const PlanView& view, CutPart part, const std::string& picture);

}  // namespace meshhier::exporting

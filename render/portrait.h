// From where a model is recognised, if nobody says it.
#pragma once

#include "hierarchy/standpoint.h"
#include "render/camera.h"
#include "render/facet.h"

#include <span>

namespace meshhier::render {

/// An open surface, as terrain or the scan of a front, is looked at from the side that it faces;
/// any other model from above its equator by a little, from where most of its form shows: where
/// its surface turns, and where one part stands before another (after Vazquez et al., Viewpoint
/// selection using viewpoint entropy, 2001). `up`: of the model, not 0. A pure function, linear in
/// the facets, which may be a coarse version of the model. Points (facets without area) are looked
/// at as a map if they lie flat, else from their front, a little aside and above.
Standpoint portrait_from(std::span<const Facet> facets, Vec3d up);

/// The view from there, if it is sound.
View view_from(const Standpoint& from, Vec3d up);

/// Shows all of the facets, as large as the frame takes them.
Camera portrait_camera(std::span<const Facet> facets, const View& view, const Framing& framing);

}  // namespace meshhier::render

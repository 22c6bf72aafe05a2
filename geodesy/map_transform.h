// The one affine map that stands for a projection where a model lies.
#pragma once

#include "base/bounds.h"
#include "geodesy/map_projection.h"
#include "hierarchy/frame.h"

namespace meshhier::geodesy {

/// A model that stands on a map; all of its own coordinates are z-up.
struct MappedModel {
  Vec3d offset;      ///< added to the model's coordinates it makes those of the map
  Vec3d anchor;      ///< the place of the model where the transform is exact
  double scale = 1;  ///< units of the map that a unit of the model is, before the offset

  Vec3d to_map(Vec3d p) const { return p * scale + offset; }
  Vec3d from_map(Vec3d p) const { return (p - offset) * (1 / scale); }
};

/// Returns the map from the model's coordinates to geocentric ones: right at the anchor, with the
/// derivatives that the projection has there, so that its convergence and its scale are right, too.
/// Places far from the anchor are off by the curvature of the earth: d^2 / 12,700 km at the
/// distance d, 8 cm at 1 km.
///
/// Rounded, so that two processors, whose sines differ in the last bit, agree: the anchor's place
/// to 2^-13 m (0.1 mm), the derivatives to 2^-27 (4 micrometres in a kilometre at most). Throws
/// Error(usage) if the projection knows no place a kilometre from the anchor.
Transform map_transform(const MapProjection& projection, const MappedModel& model);

/// Returns how far the transform is off at the worst corner of the box, in metres. Throws as
/// to_geocentric().
double largest_error(const MapProjection& projection, const MappedModel& model,
                     const Transform& transform, const BoundsD& box);

}  // namespace meshhier::geodesy

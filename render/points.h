// Points, as they are drawn where a model has no triangles.
#pragma once

#include "base/bounds.h"
#include "render/camera.h"
#include "render/facet.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::render {

/// The side of squares of which so many show a surface, and still each other's gaps; in units of
/// space.
double point_side(const Camera& camera, std::uint64_t count);

/// Each point (a facet without area) as a square of that side that faces the viewer. Two facets a
/// point. Linear.
std::vector<Facet> squares_of(std::span<const Facet> points, const ViewAxes& axes, double side);

/// Holds the squares of all points in the box.
Bounds box_of_squares(const Bounds& points, double side);

}  // namespace meshhier::render

// Texture coordinates of a contracted tile: continuous inside of charts, never blended across
// seams.
//
// Cf. Hoppe, New Quadric Metric for Simplifying Meshes with Appearance Attributes, 1999: wedges
// that the ends of a collapsed edge have in one triangle become one.
#pragma once

#include "base/vec.h"
#include "cluster_simplify/tile_wedges.h"
#include "cluster_simplify/wedge_clusters.h"
#include "hierarchy/attributes.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::cluster_simplify {

/// Returns, for each wedge, the first one of its place that has the same texture coordinates, but
/// for the sign of a zero: on one side of a seam they are equal. O(n log n).
std::vector<std::uint32_t> texture_classes(const TileWedges& wedges,
                                           const AttributePart& texcoords);

/// Returns, for each wedge, its chart in its cluster: a set of wedges, named by one of them. Wedges
/// of one texture class, and wedges at the ends of an edge of a triangle, are in one chart.
/// Without texture coordinates charts are the pieces of surface that come together. O(n log n).
std::vector<std::uint32_t> texture_charts(const TileWedges& wedges, const WedgeClusters& clusters,
                                          const AttributePart& texcoords);

using TextureCoordinates = std::array<float, 2>;

/// Returns, for each chart (by the wedge that names it), the texture coordinates of the point
/// nearest to where its cluster comes to lie, `positions`, among all triangles with a corner in the
/// chart: those of a wedge of the chart exactly if it lies there, and always within those of some
/// triangle.
/// `wanted`: the clusters whose charts are asked for, one entry each. O(t): each triangle is asked
/// once for a chart, so none needs to be left out where very many meet.
std::vector<TextureCoordinates> chart_coordinates(
    const TileWedges& wedges, const WedgeClusters& clusters, std::span<const std::uint32_t> charts,
    std::span<const Vec3f> positions, std::span<const char> wanted, const AttributePart& texcoords);

}  // namespace meshhier::cluster_simplify

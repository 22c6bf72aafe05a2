#include "render/terrain.h"

#include "render/colour_ramp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshhier::render {
namespace {

/// Part of the surface that may look down: holes that were closed, a skirt.
constexpr double kMostDown = 0.03;
/// The largest height of a terrain, as a part of its extent across.
constexpr double kMostHeight = 0.35;
/// The same of a sheet on its side: a thicker one is a relief, and light shows its form.
constexpr double kMostThickness = 0.03;
/// Vertices on each side that do not count: outliers would take all colours.
constexpr double kOutliers = 0.01;
/// Slopes that show well: those of hills are shaded so steep.
constexpr double kShownSlope = 0.5, kMostRelief = 1000;

double extent_across(const TileMesh& mesh, Vec3d along) {
  Bounds box;
  for (const Vec3f position : mesh.vertices.positions)
    box.add(position);
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0)
      extent = std::max(extent, double{box.max[axis]} - box.min[axis]);
  }
  return extent;
}

/// Twice the areas of triangles that look up, and down, and of their shadows on the ground.
struct Areas {
  double above = 0, below = 0, ground = 0;
};

Areas areas_of(const TileMesh& mesh, Vec3d along) {
  Areas areas;
  const auto place = [&](TileVertex vertex) {
    return to_double(mesh.vertices.positions[raw(vertex)]);
  };
  for (const TileTriangle& t : mesh.interior) {
    const Vec3d a = place(t[0]), normal = cross(place(t[1]) - a, place(t[2]) - a);
    const double shadow = dot(normal, along);
    (shadow > 0 ? areas.above : areas.below) += length(normal);
    areas.ground += std::abs(shadow);
  }
  return areas;
}

std::optional<Terrain> terrain_along(const TileMesh& mesh, Vec3d along, double most,
                                     bool is_upright) {
  const auto [axis, low, high] = heights_of(mesh, along);
  if (!(high > low && high - low < most * extent_across(mesh, along)))
    return std::nullopt;
  const auto [above, below, ground] = areas_of(mesh, along);
  if (std::min(above, below) > kMostDown * (above + below) || ground == 0)
    return std::nullopt;
  const double steepness = (above + below) / ground;
  return Terrain{along, is_upright, low, high, std::sqrt(std::max(0.0, steepness * steepness - 1))};
}

/// As light, at `part` of the way, 0 to 1.
Vec3f height_colour(double part) {
  constexpr std::array<std::uint32_t, 5> kColours{0x4f8a63, 0xb9c28a, 0xd8b878, 0x9c7b62, 0xf4f2ee};
  const double at = std::clamp(part, 0.0, 1.0) * (kColours.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kColours.size() - 2);
  const Vec3d from = screen_light(kColours[below]), to = screen_light(kColours[below + 1]);
  return to_float(from + (to - from) * (at - static_cast<double>(below)));
}

}  // namespace

HeightRange heights_of(const TileMesh& mesh, Vec3d along) {
  std::vector<double> heights;
  for (std::uint32_t v = 0; v < mesh.own_count; ++v)
    heights.push_back(dot(to_double(mesh.vertices.positions[v]), along));
  if (heights.empty())
    return {along};
  std::ranges::sort(heights);
  const auto outside = static_cast<std::size_t>(kOutliers * static_cast<double>(heights.size()));
  return {along, heights[outside], heights[heights.size() - 1 - outside]};
}

double Terrain::relief(double stretch) const {
  return std::clamp(kShownSlope / std::max(slope * stretch, 1e-9), 1.0, kMostRelief);
}

std::optional<Terrain> terrain_of(const PublishedTile& root, UpAxis up) {
  return terrain_of(root, direction_of(up));
}

std::optional<Terrain> terrain_of(const PublishedTile& root, Vec3d up) {
  auto upright = terrain_along(root.mesh, up, kMostHeight, true);
  if (upright || up.z != 0)
    return upright;
  return terrain_along(root.mesh, {0, 0, 1}, kMostThickness, false);
}

void shade_steeper(const Terrain& terrain, double relief, std::span<Facet> facets) {
  for (Facet& facet : facets) {
    for (FacetCorner& corner : facet) {
      const Vec3d normal = to_double(unit_or_zero(corner.normal));
      const Vec3d along = terrain.along * dot(normal, terrain.along);
      corner.normal = unit_or_zero(to_float((normal - along) * relief + along));
    }
  }
}

void colour_by_height(const HeightRange& heights, std::span<Facet> facets) {
  const double range = std::max(heights.high - heights.low, 1e-30);
  for (Facet& facet : facets) {
    for (FacetCorner& corner : facet)
      corner.colour =
          height_colour((dot(to_double(corner.position), heights.along) - heights.low) / range);
  }
}

}  // namespace meshhier::render

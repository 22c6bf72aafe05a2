// Facets and cameras that tests of drawing share.
#pragma once

#include "render/raster.h"
#include "tests/support/meshes.h"

#include <cstdint>
#include <vector>

namespace meshhier::render {

/// Looks down z at [0, size] x [0, size]: sample (x, y) is at (x + 0.5, size - y - 0.5).
inline Camera square_camera(std::uint32_t size, std::uint32_t samples = 1) {
  const double side = size;
  return {View{}, BoundsD{{0, 0, -side}, {side, side, side}},
          Framing{.width = size, .height = size, .samples = samples, .margin = 0}};
}

/// With the facet's own normal, and the plain colour.
inline Facet flat_facet(Vec3f a, Vec3f b, Vec3f c) {
  return {FacetCorner{a, {}}, FacetCorner{b, {}}, FacetCorner{c, {}}};
}

inline Facet mirrored(const Facet& facet) {
  return {facet[0], facet[2], facet[1]};
}

/// Returns the facets of a mesh around the origin: its normals lead away from there.
inline std::vector<Facet> facets_around_origin(const tests::TestMesh& mesh) {
  std::vector<Facet> facets;
  for (const tests::MeshTriangle& t : mesh.triangles) {
    Facet facet;
    for (std::size_t i = 0; i < 3; ++i)
      facet[i] = {mesh.positions[t[i]], mesh.positions[t[i]]};
    facets.push_back(facet);
  }
  return facets;
}

inline Raster drawn(const Camera& camera, const std::vector<Facet>& facets) {
  Raster raster(camera);
  raster.draw(facets);
  return raster;
}

}  // namespace meshhier::render

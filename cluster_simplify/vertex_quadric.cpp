#include "cluster_simplify/vertex_quadric.h"

namespace meshhier::cluster_simplify {
namespace {

// Weight of the upright planes on open borders, in parts of the squared length of the border's
// edge. With 1 the borders of range scans shrink away, with 3 the dragon's largest distance
// doubles; with 100 they take the vertices that the surface needs (bunny_range's root: mean
// distance back 3.7e-4 of the diagonal with 10, 8.4e-4 with 100).
constexpr float kBorderWeight = 10;

// Where a sheet folds back on itself its planes leave the fold free to slide along them: flat
// pockets and fins would wear away. Below this cosine a fold is held like a border, but less firmly
// (with 100 the head's mean distance grows by a tenth).
constexpr float kFoldCosine = -0.9F;
constexpr float kFoldWeight = 3;

void add_upright(VertexQuadric& q, Vec3f along, Vec3f normal, float weight) {
  const Vec3f upright = cross(along, normal);
  const float size = length(upright);
  if (size > 0)
    q.add_plane(upright * (1 / size), weight * dot(along, along));
}

}  // namespace

float total_area(std::span<const VertexQuadric> quadrics) {
  double sum = 0;
  for (const VertexQuadric& q : quadrics)
    sum += double{q.area};
  return static_cast<float>(sum);
}

std::vector<VertexQuadric> vertex_quadrics(const CollapseMesh& mesh,
                                           std::span<const Vec3f> positions) {
  std::vector<VertexQuadric> quadrics(mesh.vertex_count());
  std::vector<Vec3f> normals(mesh.edges().size());  // of the triangle last met at an edge
  for (const CollapseMesh::Face& face : mesh.faces()) {
    const auto& corners = face.corners;
    const Vec3f p = positions[corners[0]];
    const Vec3f doubled = cross(positions[corners[1]] - p, positions[corners[2]] - p);
    const float doubled_area = length(doubled);
    if (!(doubled_area > 0))
      continue;
    const Vec3f normal = doubled * (1 / doubled_area);
    VertexQuadric plane;
    plane.add_plane(normal, doubled_area);
    for (const std::uint32_t v : corners)
      quadrics[v].add_plane_of(plane, doubled_area);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t e = face.edges[k];
      const std::uint32_t count = mesh.edge(e).triangle_count;
      const bool is_border = count == 1;
      // At the first triangle there is no normal yet. Where more than two meet nothing can slide.
      const bool is_fold = count == 2 && dot(normals[e], normal) < kFoldCosine;
      normals[e] = normal;
      if (!is_border && !is_fold)
        continue;
      const float weight = is_border ? kBorderWeight : kFoldWeight;
      const std::uint32_t a = corners[k];
      const std::uint32_t b = corners[k == 2 ? 0 : k + 1];
      const Vec3f along = positions[b] - positions[a];
      add_upright(quadrics[a], along, normal, weight);
      add_upright(quadrics[b], along, normal, weight);
    }
  }
  return quadrics;
}

}  // namespace meshhier::cluster_simplify

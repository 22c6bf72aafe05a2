#include "cluster_simplify/vertex_quadric.h"

#include "base/four_floats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

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

// Seams of attributes are held like borders, but less firmly: nothing shrinks away at them. At a
// tenth of a wavy sheet's vertices a seam goes off its line by 0.1 edges on average with 0.1, by
// 0.02 with 1, by 0.95 with 0. Seams of projected charts are jagged: holding them takes triangles
// from the shape (decision 025).
constexpr float kSeamWeight = 0.1F;

void add_upright(VertexQuadric& q, Vec3f along, Vec3f normal, float weight) {
  const Vec3f upright = cross(along, normal);
  const float size = length(upright);
  if (size > 0)
    q.add_plane(upright * (1 / size), weight * dot(along, along));
}

FourFloats padded(Vec3f v) {
  return FourFloats{v.x, v.y, v.z, 0};
}

float dot(FourFloats a, FourFloats b) {
  const FourFloats products = a * b;
  return products[0] + products[1] + products[2];
}

static_assert(sizeof(VertexQuadric) == 3 * sizeof(FourFloats));

/// The quadric of a triangle's plane about one of its corners, its values as VertexQuadric has
/// them.
struct TrianglePlane {
  FourFloats xx_xy_xz_yy, yz_zz, area;

  TrianglePlane(FourFloats unit_normal, float doubled_area) {
    const FourFloats u = unit_normal;
    const FourFloats n = unit_normal * doubled_area;
    xx_xy_xz_yy =
        __builtin_shufflevector(n, n, 0, 0, 0, 1) * __builtin_shufflevector(u, u, 0, 1, 2, 1);
    yz_zz = __builtin_shufflevector(n, n, 1, 2, 3, 3) * __builtin_shufflevector(u, u, 2, 2, 3, 3);
    area = FourFloats{0, 0, doubled_area, 0};
  }

  void add_to(VertexQuadric& q) const {
    auto* const values = reinterpret_cast<std::byte*>(&q);
    add(xx_xy_xz_yy, values);
    add(yz_zz, values + sizeof(FourFloats));
    add(area, values + 2 * sizeof(FourFloats));
  }

 private:
  static void add(FourFloats values, std::byte* to) { store_four(to, load_four(to) + values); }
};

/// Planes upright on a triangle of that normal, through an edge of it, about both ends.
void hold_edge(std::array<std::uint32_t, 2> ends, std::span<const Vec3f> positions, Vec3f normal,
               float weight, std::span<VertexQuadric> quadrics) {
  const Vec3f along = positions[ends[1]] - positions[ends[0]];
  for (const std::uint32_t v : ends)
    add_upright(quadrics[v], along, normal, weight);
}

/// The weight of the upright planes at an edge of so many triangles; 0 if it needs none. Where more
/// than two meet nothing can slide.
float upright_weight(std::uint32_t triangle_count, bool folds_back) {
  if (triangle_count == 1)
    return kBorderWeight;
  return folds_back && triangle_count == 2 ? kFoldWeight : 0;
}

/// Marks the edges that are seams.
std::vector<char> seam_marks(const CollapseMesh& mesh, std::span<const PlaceEdge> seams) {
  std::vector<char> marks;
  marks.reserve(mesh.edges().size());
  for (const CollapseMesh::Edge& edge : mesh.edges())
    marks.push_back(std::ranges::binary_search(seams, PlaceEdge{edge.a, edge.b}) ? 1 : 0);
  return marks;
}

/// Marks the vertices where seams are lines: no more than half of the edges.
std::vector<char> line_marks(const CollapseMesh& mesh, std::span<const char> is_seam) {
  std::vector<std::int64_t> others(mesh.vertex_count());  // edges, less twice the seams
  for (std::size_t e = 0; e < is_seam.size(); ++e) {
    for (const std::uint32_t v :
         {mesh.edge(static_cast<std::uint32_t>(e)).a, mesh.edge(static_cast<std::uint32_t>(e)).b})
      others[v] += is_seam[e] != 0 ? -1 : 1;
  }
  std::vector<char> marks;
  marks.reserve(others.size());
  for (const std::int64_t more : others)
    marks.push_back(more >= 0 ? 1 : 0);
  return marks;
}

void hold_seams(const CollapseMesh& mesh, std::span<const Vec3f> positions,
                std::span<const PlaceEdge> seams, std::span<VertexQuadric> quadrics) {
  const std::vector<char> is_seam = seam_marks(mesh, seams);
  const std::vector<char> is_line = line_marks(mesh, is_seam);
  for (const CollapseMesh::Face& face : mesh.faces()) {
    const auto& [a, b, c] = face.corners;
    const Vec3f doubled = cross(positions[b] - positions[a], positions[c] - positions[a]);
    const float doubled_area = length(doubled);
    if (!(doubled_area > 0))
      continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (is_seam[face.edges[k]] == 0)
        continue;
      const std::array ends{face.corners[k], face.corners[CollapseMesh::after(k)]};
      const Vec3f along = positions[ends[1]] - positions[ends[0]];
      for (const std::uint32_t v : ends) {
        if (is_line[v] != 0)
          add_upright(quadrics[v], along, doubled * (1 / doubled_area), kSeamWeight);
      }
    }
  }
}

}  // namespace

float total_area(std::span<const VertexQuadric> quadrics) {
  double sum = 0;
  for (const VertexQuadric& q : quadrics)
    sum += double{q.area};
  return static_cast<float>(sum);
}

std::vector<VertexQuadric> vertex_quadrics(const CollapseMesh& mesh,
                                           std::span<const Vec3f> positions,
                                           std::span<const PlaceEdge> seams) {
  std::vector<VertexQuadric> quadrics(mesh.vertex_count());
  const auto faces = mesh.faces();
  const auto normals = std::make_unique_for_overwrite<FourFloats[]>(faces.size() + 1);
  normals[faces.size()] = FourFloats{};  // where no triangle was met yet
  std::vector<std::uint32_t> last_met(mesh.edges().size(),
                                      static_cast<std::uint32_t>(faces.size()));  // at each edge
  for (std::uint32_t t = 0; t < faces.size(); ++t) {
    const CollapseMesh::Face& face = faces[t];
    const auto& corners = face.corners;
    const Vec3f& p = positions[corners[0]];
    const Vec3f doubled = cross(positions[corners[1]] - p, positions[corners[2]] - p);
    const float doubled_area = length(doubled);
    if (!(doubled_area > 0))
      continue;
    const Vec3f normal = doubled * (1 / doubled_area);
    const FourFloats padded_normal = padded(normal);
    const TrianglePlane plane(padded_normal, doubled_area);
    for (const std::uint32_t v : corners)
      plane.add_to(quadrics[v]);
    normals[t] = padded_normal;
    const auto meet = [&](std::uint32_t e, std::uint32_t a, std::uint32_t b) {
      const bool folds_back = dot(normals[last_met[e]], padded_normal) < kFoldCosine;
      last_met[e] = t;
      const float weight = upright_weight(mesh.edge(e).triangle_count, folds_back);
      if (weight > 0)
        hold_edge({a, b}, positions, normal, weight, quadrics);
    };
    meet(face.edges[0], corners[0], corners[1]);
    meet(face.edges[1], corners[1], corners[2]);
    meet(face.edges[2], corners[2], corners[0]);
  }
  if (!seams.empty())
    hold_seams(mesh, positions, seams, quadrics);
  return quadrics;
}

}  // namespace meshhier::cluster_simplify

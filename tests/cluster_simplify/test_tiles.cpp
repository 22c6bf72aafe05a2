#include "tests/cluster_simplify/test_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace meshhier::tests {
namespace {

TileTriangle tile_triangle(const MeshTriangle& t) {
  return {TileVertex{t[0]}, TileVertex{t[1]}, TileVertex{t[2]}};
}

/// Puts the vertices with x <= limit first; returns how many they are.
std::uint32_t split_at(TestMesh& mesh, float limit) {
  std::vector<std::uint32_t> place(mesh.positions.size());
  std::vector<Vec3f> positions;
  std::uint32_t first_count = 0;
  for (const bool second : {false, true}) {
    for (std::uint32_t v = 0; v < place.size(); ++v) {
      if ((mesh.positions[v].x > limit) != second)
        continue;
      place[v] = count_of(positions);
      positions.push_back(mesh.positions[v]);
    }
    first_count = second ? first_count : count_of(positions);
  }
  mesh.positions = std::move(positions);
  for (MeshTriangle& t : mesh.triangles)
    t = {place[t[0]], place[t[1]], place[t[2]]};
  return first_count;
}

}  // namespace

Vec3f vec3f(double x, double y, double z) {
  return to_float(Vec3d{x, y, z});
}

BuildTile tile_of(const TestMesh& mesh, std::uint32_t own_count) {
  BuildTile tile;
  tile.mesh.vertices.positions = mesh.positions;
  tile.mesh.own_count = own_count;
  tile.mesh.boundary_count = own_count;
  for (std::uint32_t i = own_count; i < mesh.positions.size(); ++i)
    tile.mesh.ghosts.push_back({1, i - own_count});
  tile.history.weights.assign(own_count, 1);
  for (const MeshTriangle& t : mesh.triangles) {
    const auto own = std::count_if(t.begin(), t.end(), [&](auto v) { return v < own_count; });
    if (own > 0)
      (own == 3 ? tile.mesh.interior : tile.mesh.border).push_back(tile_triangle(t));
  }
  return tile;
}

BuildTile tile_of(const TestMesh& mesh) {
  return tile_of(mesh, count_of(mesh.positions));
}

BuildTile part_of(TestMesh mesh, float limit) {
  const std::uint32_t own_count = split_at(mesh, limit);
  return tile_of(mesh, own_count);
}

TestMesh cube(std::uint32_t n) {
  TestMesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<std::uint32_t, 3> place) {
    const auto [found, added] = known.try_emplace(place, count_of(mesh.positions));
    const auto at = [&](int axis) { return 2.0 * place[axis] / n - 1; };
    if (added)
      mesh.positions.push_back(vec3f(at(0), at(1), at(2)));
    return found->second;
  };
  for (std::uint32_t face = 0; face < 6; ++face) {
    const std::uint32_t axis = face / 2;
    const auto corner = [&](std::uint32_t u, std::uint32_t v) {
      std::array<std::uint32_t, 3> place{};
      place[axis] = face % 2 == 0 ? 0 : n;
      place[(axis + 1) % 3] = face % 2 == 0 ? v : u;
      place[(axis + 2) % 3] = face % 2 == 0 ? u : v;
      return vertex(place);
    };
    for (std::uint32_t u = 0; u < n; ++u) {
      for (std::uint32_t v = 0; v < n; ++v) {
        mesh.triangles.push_back({corner(u, v), corner(u + 1, v), corner(u + 1, v + 1)});
        mesh.triangles.push_back({corner(u, v), corner(u + 1, v + 1), corner(u, v + 1)});
      }
    }
  }
  return mesh;
}

TestMesh wheel(std::uint32_t count, float height) {
  TestMesh mesh{{{0, 0, height}}, {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    mesh.positions.push_back(vec3f(std::cos(angle), std::sin(angle), 0));
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  return mesh;
}

TestMesh z_ring() {
  return {{{0, 0, 0},
           {1, 0, 0},
           {0.5F, 0.1F, 0},
           {2, 1.6F, 0},
           {0, 3, 0},
           {-1, -1.5F, 0},
           {0.5F, -0.1F, 0},
           {-1, -1.6F, 0},
           {1, -3, 0},
           {2, 1.5F, 0}},
          {{0, 1, 2},
           {0, 6, 1},
           {0, 2, 3},
           {0, 3, 4},
           {0, 4, 5},
           {0, 5, 6},
           {1, 6, 7},
           {1, 7, 8},
           {1, 8, 9},
           {1, 9, 2}}};
}

TestMesh tangle(std::uint32_t vertices, std::uint32_t triangles, std::uint64_t seed) {
  TestMesh mesh = points(vertices);
  const auto pick = [&](std::uint32_t i, std::uint32_t k) {
    return std::min(vertices - 1, static_cast<std::uint32_t>((hash_noise(i, seed * 8 + k) + 1) / 2 *
                                                             static_cast<float>(vertices)));
  };
  for (std::uint32_t i = 0; mesh.triangles.size() < triangles; ++i) {
    const MeshTriangle t{pick(i, 0), pick(i, 1), pick(i, 2)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
      mesh.triangles.push_back(t);
  }
  return mesh;
}

TestMesh mirrored(TestMesh mesh) {
  const std::vector<MeshTriangle> front = mesh.triangles;
  for (const MeshTriangle& t : front)
    mesh.triangles.push_back({t[0], t[2], t[1]});
  return mesh;
}

std::vector<NamedMesh> small_meshes() {
  TestMesh specks = open_grid(6, 5);
  append(specks, soup(12));
  append(specks, points(5));
  return {{"closed", sphere(200)},
          {"torus", torus(150)},
          {"open", open_grid(9, 7)},
          {"moebius", moebius(100)},
          {"non-manifold", non_manifold(100)},
          {"duplicates", duplicates(200)},
          {"mirrored", mirrored(open_grid(5, 5))},
          {"tangle", tangle(40, 160, 3)},
          {"dense tangle", tangle(12, 200, 4)},
          {"hub", wheel(60, 0)},
          {"specks", specks}};
}

TestMesh image_of(const BuildTile& tile, const cluster_simplify::Contraction& contraction) {
  const TileMesh& mesh = tile.mesh;
  TestMesh image{contraction.representatives.positions, {}};
  const std::uint32_t shift = count_of(image.positions) - mesh.own_count;
  image.positions.insert(image.positions.end(), mesh.vertices.positions.begin() + mesh.own_count,
                         mesh.vertices.positions.end());
  std::set<MeshTriangle> triangles;
  for (const auto* list : {&mesh.interior, &mesh.border}) {
    for (const TileTriangle& t : *list) {
      TileTriangle mapped = t;
      for (TileVertex& v : mapped)
        v = TileVertex{mesh.is_own(v) ? contraction.parent_of[raw(v)] : raw(v) + shift};
      mapped = canonical(mapped);
      if (!is_degenerate(mapped))
        triangles.insert({raw(mapped[0]), raw(mapped[1]), raw(mapped[2])});
    }
  }
  image.triangles.assign(triangles.begin(), triangles.end());
  return image;
}

double distance(Vec3f a, Vec3f b) {
  return length(to_double(a) - to_double(b));
}

double distance_to_nearest(Vec3f p, const std::vector<Vec3f>& points) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3f q : points)
    least = std::min(least, distance(p, q));
  return least;
}

Vec3d doubled_normal(const TestMesh& mesh, const MeshTriangle& t) {
  const Vec3d p = to_double(mesh.positions[t[0]]);
  return cross(to_double(mesh.positions[t[1]]) - p, to_double(mesh.positions[t[2]]) - p);
}

std::vector<NamedMesh> nasty_meshes() {
  TestMesh specks = sphere(700, 0.02F);
  append(specks, soup(30), {0.2F, 0, 0}, 1.5F);
  TestMesh half_isolated = torus(400, 0.02F);
  append(half_isolated, points(150));
  TestMesh equal{std::vector<Vec3f>(50, Vec3f{3, 4, 5}), {{0, 1, 2}, {2, 1, 3}, {7, 8, 9}}};
  TestMesh line = open_grid(12, 3);
  for (Vec3f& p : line.positions)
    p.y = p.z = 0;
  return {{"sphere", sphere(700, 0.03F)},
          {"torus", torus(600, 0.02F)},
          {"genus", genus_n(2, 600)},
          {"shells", nested_shells(600)},
          {"grid", open_grid(14, 12, 0.2F)},
          {"flat grid", open_grid(14, 12)},
          {"strip", open_grid(60, 1)},
          {"moebius", moebius(300)},
          {"non-manifold", non_manifold(400, 0.01F)},
          {"soup", soup(80)},
          {"points", points(200)},
          {"duplicates", duplicates(600, 0.02F)},
          {"mirrored", mirrored(sphere(300))},
          {"tangle", tangle(60, 400, 1)},
          {"specks", specks},
          {"half isolated", half_isolated},
          {"all equal", equal},
          {"without area", line},
          {"hub", wheel(200, 0.3F)},
          {"one triangle", soup(1)},
          {"one vertex", points(1)}};
}

void add_attributes(BuildTile& tile) {
  VertexArray& vertices = tile.mesh.vertices;
  vertices.channels = kAllAttributes.channels();
  vertices.attributes.clear();
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    const Vec3f p = vertices.positions[v];
    Vec3d normal = to_double(p) + Vec3d{0.1, 0.2 * hash_noise(v, 31), 0.3};
    normal = normal * (1 / length(normal));
    for (int axis = 0; axis < 3; ++axis)
      vertices.attributes.push_back(static_cast<float>(normal[axis]));
    for (std::uint64_t k = 0; k < 4; ++k)
      vertices.attributes.push_back(std::round(127.5F * (hash_noise(v, 32 + k) + 1)));
    vertices.attributes.push_back(p.x);
    vertices.attributes.push_back(hash_noise(v, 40));
  }
}

std::vector<Vec3f> cube_corners() {
  std::vector<Vec3f> corners;
  for (const float x : {-1.0F, 1.0F}) {
    for (const float y : {-1.0F, 1.0F}) {
      for (const float z : {-1.0F, 1.0F})
        corners.push_back({x, y, z});
    }
  }
  return corners;
}

std::size_t border_line_count(const std::vector<MeshTriangle>& triangles) {
  TestMesh
      lines;  // component_count() of the border's edges, each as a triangle with a corner twice
  for (const Edge& e : boundary_edges(triangles)) {
    lines.triangles.push_back({e[0], e[1], e[1]});
    lines.positions.resize(std::max<std::size_t>(lines.positions.size(), e[1] + 1));
  }
  return component_count(lines);
}

}  // namespace meshhier::tests

#include "cluster_simplify/link_condition.h"

#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using Fan = CollapseMesh::Fan;
using tests::MeshTriangle;

constexpr std::uint32_t kNone = CollapseMesh::kNone;

/// A mesh under the link condition, with what a test does to it.
class Surface {
 public:
  explicit Surface(const tests::TestMesh& mesh)
      : mesh_(tests::tile_of(mesh).mesh), link_(mesh_.vertex_count()) {}

  CollapseMesh& mesh() { return mesh_; }

  TopologyChange change(std::uint32_t a, std::uint32_t b) {
    mesh_.gather(a, around_a_);
    mesh_.gather(b, around_b_);
    return link_.change(mesh_, a, b, around_a_, around_b_);
  }

  void collapse(std::uint32_t from, std::uint32_t to) {
    mesh_.gather(from, around_a_);
    mesh_.gather(to, around_b_);
    mesh_.collapse(from, to, around_a_, around_b_, [](std::uint32_t) {});
  }

  std::vector<MeshTriangle> triangles() const {
    std::vector<MeshTriangle> live;
    for (const CollapseMesh::Face& face : mesh_.faces()) {
      if (face.is_alive())
        live.push_back(face.corners);
    }
    return live;
  }

  /// Collapses random edges that do no harm, until all do; returns how many it were.
  std::size_t collapse_harmless(std::uint64_t seed) {
    std::size_t count = 0;
    for (bool found = true; found;) {
      found = false;
      const auto edge_count = static_cast<std::uint32_t>(mesh_.edges().size());
      const auto start = static_cast<std::uint32_t>((tests::hash_noise(count, seed) + 1) / 2 *
                                                    static_cast<float>(edge_count));
      for (std::uint32_t i = 0; i < edge_count && !found; ++i) {
        const auto [a, b, triangle_count] = mesh_.edge((start + i) % edge_count);
        found = triangle_count > 0 && change(a, b) == TopologyChange::none;
        if (found)
          collapse(a, b);
      }
      count += found ? 1 : 0;
    }
    return count;
  }

 private:
  CollapseMesh mesh_;
  LinkCondition link_;
  std::vector<Fan> around_a_, around_b_;
};

TopologyChange change_of(const tests::TestMesh& mesh, std::uint32_t a, std::uint32_t b) {
  Surface surface(mesh);
  const TopologyChange there = surface.change(a, b);
  EXPECT_EQ(there, surface.change(b, a)) << "the other way round";
  return there;
}

tests::TestMesh mesh_of(std::uint32_t vertices, std::vector<MeshTriangle> triangles) {
  return {std::vector<Vec3f>(vertices), std::move(triangles)};
}

/// The simplices that are in the links of both vertices.
template <class Links>
auto common(const Links& links, std::uint32_t a, std::uint32_t b) {
  auto result = links.at(a);
  std::erase_if(result, [&](const auto& simplex) { return !links.at(b).contains(simplex); });
  return result;
}

/// The definition itself: what the links of a and b have in common is the link of the edge, where
/// every border edge may be joined to one more vertex, the apex.
class Definition {
 public:
  explicit Definition(const std::vector<MeshTriangle>& triangles) {
    for (const MeshTriangle& t : triangles)
      add(t);
  }

  void close_borders(const std::vector<MeshTriangle>& triangles) {
    for (const tests::Edge& e : tests::boundary_edges(triangles))
      add({e[0], e[1], kApex});
  }

  bool holds(std::uint32_t a, std::uint32_t b) const {
    return common(vertices_, a, b) == opposite(a, b) && common(edges_, a, b).empty();
  }

 private:
  static constexpr std::uint32_t kApex = 1'000'000'000;
  using VertexLinks = std::map<std::uint32_t, std::set<std::uint32_t>>;
  using EdgeLinks = std::map<std::uint32_t, std::set<std::array<std::uint32_t, 2>>>;

  void add(const MeshTriangle& t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t next = t[(k + 1) % 3];
      const std::uint32_t previous = t[(k + 2) % 3];
      vertices_[t[k]].insert({next, previous});
      edges_[t[k]].insert({std::min(next, previous), std::max(next, previous)});
    }
  }

  std::set<std::uint32_t> opposite(std::uint32_t a, std::uint32_t b) const {
    std::set<std::uint32_t> result;
    for (const auto& [x, y] : edges_.at(a)) {
      if (x == b || y == b)
        result.insert(x == b ? y : x);
    }
    return result;
  }

  VertexLinks vertices_;
  EdgeLinks edges_;
};

/// V - E + F of the surface with repeated and mirrored triangles counted once.
std::int64_t euler_of_sets(std::vector<MeshTriangle> triangles) {
  for (MeshTriangle& t : triangles)
    std::ranges::sort(t);
  std::ranges::sort(triangles);
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return tests::euler_characteristic(triangles);
}

/// The triangles around each vertex make one ring, or one open fan.
bool is_manifold(const std::vector<MeshTriangle>& triangles) {
  std::map<std::uint32_t, tests::TestMesh> links;
  std::map<tests::Edge, int> counts;
  for (const tests::Edge& e : tests::undirected_edges(triangles))
    ++counts[e];
  for (const MeshTriangle& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      auto& link = links[t[k]];
      link.triangles.push_back({t[(k + 1) % 3], t[(k + 2) % 3], t[(k + 2) % 3]});
      for (const std::uint32_t v : t)
        link.positions.resize(std::max<std::size_t>(link.positions.size(), v + 1));
    }
  }
  return std::ranges::all_of(counts, [](const auto& entry) { return entry.second <= 2; }) &&
         std::ranges::all_of(
             links, [](const auto& entry) { return tests::component_count(entry.second) == 1; });
}

// ---- named cases ---------------------------------------------------------------------------

// Vertices of open_grid(4, 4): 5 y + x.

TEST(LinkConditionTest, AnEdgeInsideAGridIsHarmless) {
  const tests::TestMesh grid = tests::open_grid(5, 5);
  EXPECT_EQ(change_of(grid, 14, 15), TopologyChange::none);
  EXPECT_EQ(change_of(grid, 14, 21), TopologyChange::none);  // a diagonal
}

TEST(LinkConditionTest, ABorderEdgeIsHarmless) {
  EXPECT_EQ(change_of(tests::open_grid(4, 4), 1, 2), TopologyChange::none);
  EXPECT_EQ(change_of(tests::open_grid(4, 4), 0, 1), TopologyChange::none);  // at a corner
}

TEST(LinkConditionTest, AnEdgeFromTheBorderInwardsIsHarmless) {
  EXPECT_EQ(change_of(tests::open_grid(4, 4), 2, 7), TopologyChange::none);
}

TEST(LinkConditionTest, AnEdgeBetweenTwoBordersPinches) {
  EXPECT_EQ(change_of(tests::open_grid(4, 1), 2, 7), TopologyChange::pinches);
  EXPECT_EQ(change_of(tests::open_grid(4, 4), 3, 9), TopologyChange::pinches);  // across a corner
}

TEST(LinkConditionTest, ATetrahedronCannotLoseAVertex) {
  const tests::TestMesh tetrahedron = mesh_of(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  for (std::uint32_t a = 0; a < 4; ++a) {
    for (std::uint32_t b = 0; b < a; ++b)
      EXPECT_EQ(change_of(tetrahedron, a, b), TopologyChange::tears);
  }
}

TEST(LinkConditionTest, AnOpenTetrahedronMayLoseItsTip) {
  const tests::TestMesh cap = mesh_of(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}});
  EXPECT_EQ(change_of(cap, 0, 1), TopologyChange::none);
  EXPECT_EQ(change_of(cap, 1, 2), TopologyChange::tears);  // the hole under it would close
}

TEST(LinkConditionTest, TwoTrianglesBackToBackVanish) {
  EXPECT_EQ(change_of(mesh_of(3, {{0, 1, 2}, {0, 2, 1}}), 0, 1), TopologyChange::vanishes);
}

TEST(LinkConditionTest, ASingleTriangleVanishes) {
  EXPECT_EQ(change_of(mesh_of(3, {{0, 1, 2}}), 1, 2), TopologyChange::vanishes);
  EXPECT_EQ(change_of(mesh_of(3, {{0, 1, 2}, {0, 1, 2}, {0, 1, 2}}), 1, 2),
            TopologyChange::vanishes);
}

TEST(LinkConditionTest, AFanOfThreeTrianglesGoesFromItsEnds) {
  const tests::TestMesh fan = mesh_of(5, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
  EXPECT_EQ(change_of(fan, 0, 1), TopologyChange::none);
  EXPECT_EQ(change_of(fan, 1, 2), TopologyChange::none);
  EXPECT_EQ(change_of(fan, 2, 3), TopologyChange::none);
  EXPECT_EQ(change_of(fan, 0, 2), TopologyChange::pinches);
  EXPECT_EQ(change_of(fan, 0, 3), TopologyChange::pinches);
}

TEST(LinkConditionTest, AHoleOfThreeEdgesWouldClose) {
  tests::TestMesh grid = tests::open_grid(5, 5);
  const auto hole = std::ranges::find(grid.triangles, MeshTriangle{14, 15, 21});
  ASSERT_NE(hole, grid.triangles.end());
  grid.triangles.erase(hole);
  EXPECT_EQ(change_of(grid, 14, 15), TopologyChange::tears);
  EXPECT_EQ(change_of(grid, 15, 21), TopologyChange::tears);
  EXPECT_EQ(change_of(grid, 21, 14), TopologyChange::tears);
  EXPECT_EQ(change_of(grid, 14, 13), TopologyChange::none);  // from the hole outwards
}

TEST(LinkConditionTest, AHoleOfFourEdgesMayShrinkAlongItsBorder) {
  tests::TestMesh grid = tests::open_grid(5, 5);
  std::erase(grid.triangles, MeshTriangle{14, 15, 21});
  std::erase(grid.triangles, MeshTriangle{14, 21, 20});
  ASSERT_EQ(grid.triangles.size(), 48U);
  EXPECT_EQ(change_of(grid, 14, 15), TopologyChange::none);
  EXPECT_EQ(change_of(grid, 20, 14), TopologyChange::none);
}

TEST(LinkConditionTest, AHandleOfThreeEdgesWouldClose) {
  // A tube of four rings of three: 3 ring + place.
  tests::TestMesh tube = mesh_of(12, {});
  for (std::uint32_t ring = 0; ring < 3; ++ring) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t a = 3 * ring + i;
      const std::uint32_t b = 3 * ring + (i + 1) % 3;
      tube.triangles.insert(tube.triangles.end(), {{a, b, b + 3}, {a, b + 3, a + 3}});
    }
  }
  EXPECT_EQ(change_of(tube, 3, 4), TopologyChange::tears);  // around
  EXPECT_EQ(change_of(tube, 3, 6), TopologyChange::none);   // along
}

TEST(LinkConditionTest, AnEdgeOfThreeTrianglesIsHarmless) {
  // Three sheets at the edge 0-1, each two triangles deep.
  const tests::TestMesh book = mesh_of(8, {{0, 1, 2},
                                           {0, 1, 3},
                                           {0, 1, 4},
                                           {1, 5, 2},
                                           {1, 5, 3},
                                           {1, 5, 4},
                                           {0, 2, 6},
                                           {0, 3, 6},
                                           {0, 4, 6}});
  EXPECT_EQ(change_of(book, 0, 1), TopologyChange::none);
}

TEST(LinkConditionTest, AnEdgeIntoAnEdgeOfThreeTrianglesIsHarmless) {
  const tests::TestMesh sheets = tests::non_manifold(100);  // 0 .. n: the line they share
  Surface surface(sheets);
  const auto edges = surface.mesh().edges();
  const auto shared = std::ranges::find(edges, 3U, &CollapseMesh::Edge::triangle_count);
  ASSERT_NE(shared, edges.end());
  EXPECT_EQ(surface.change(shared->a, shared->b), TopologyChange::none);
}

TEST(LinkConditionTest, TwoTrianglesVanishWithTheEdgeBetweenThem) {
  EXPECT_EQ(change_of(tests::open_grid(1, 1), 0, 3), TopologyChange::vanishes);
  EXPECT_EQ(change_of(tests::mirrored(tests::open_grid(1, 1)), 0, 3), TopologyChange::vanishes);
}

TEST(LinkConditionTest, ASheetWithABackShrinksFromItsEnds) {
  const tests::TestMesh sheet = tests::mirrored(tests::open_grid(1, 1));
  EXPECT_EQ(change_of(sheet, 0, 1), TopologyChange::none);
  EXPECT_EQ(change_of(sheet, 2, 3), TopologyChange::none);
}

TEST(LinkConditionTest, ABowTieVanishesNotWithOneOfItsWings) {
  // Two triangles that share the vertex 0.
  const tests::TestMesh bow_tie = mesh_of(5, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_NE(change_of(bow_tie, 0, 1), TopologyChange::vanishes);
  EXPECT_EQ(change_of(bow_tie, 1, 2), TopologyChange::vanishes);  // the other wing stays
}

TEST(LinkConditionTest, RemembersNothingFromOneCallToTheNext) {
  Surface surface(tests::open_grid(5, 5));
  for (int round = 0; round < 3; ++round) {
    for (const CollapseMesh::Edge& e : surface.mesh().edges()) {
      const TopologyChange change = surface.change(e.a, e.b);
      Surface fresh(tests::open_grid(5, 5));
      ASSERT_EQ(change, fresh.change(e.a, e.b));
    }
  }
}

// ---- properties ----------------------------------------------------------------------------

TEST(LinkConditionTest, IsTheDefinitionOnManifolds) {
  const std::vector<tests::TestMesh> meshes = {
      tests::sphere(60),      tests::torus(60),   tests::genus_n(2, 1), tests::nested_shells(64),
      tests::open_grid(5, 4), tests::moebius(60), tests::wheel(6, 0),   tests::open_grid(12, 1)};
  std::array<std::size_t, 2> met{};
  for (const tests::TestMesh& mesh : meshes) {
    Surface surface(mesh);
    for (std::uint64_t step = 0; step < 40; ++step) {
      const std::vector<MeshTriangle> triangles = surface.triangles();
      Definition definition(triangles);
      definition.close_borders(triangles);
      std::vector<CollapseMesh::Edge> harmless;
      for (const CollapseMesh::Edge& e : surface.mesh().edges()) {
        if (e.triangle_count == 0)
          continue;
        const bool found = surface.change(e.a, e.b) == TopologyChange::none;
        ASSERT_EQ(found, definition.holds(e.a, e.b)) << "edge " << e.a << "-" << e.b;
        ++met[found ? 1 : 0];
        if (found)
          harmless.push_back(e);
      }
      if (harmless.empty())
        break;
      const CollapseMesh::Edge next = harmless[step * 7919 % harmless.size()];
      surface.collapse(next.a, next.b);
    }
  }
  EXPECT_GT(met[0], 1000U);
  EXPECT_GT(met[1], 1000U);
}

TEST(LinkConditionTest, HarmlessCollapsesKeepAClosedManifold) {
  const std::vector<tests::NamedMesh> meshes = {{"sphere", tests::sphere(400)},
                                                {"torus", tests::torus(400)},
                                                {"genus 2", tests::genus_n(2, 400)},
                                                {"genus 4", tests::genus_n(4, 400)},
                                                {"shells", tests::nested_shells(400)}};
  for (const auto& [name, mesh] : meshes) {
    const std::int64_t euler = tests::euler_characteristic(mesh.triangles);
    for (std::uint64_t seed = 50; seed < 55; ++seed) {
      SCOPED_TRACE(name);
      Surface surface(mesh);
      EXPECT_GT(surface.collapse_harmless(seed), mesh.positions.size() / 2);
      const std::vector<MeshTriangle> triangles = surface.triangles();
      EXPECT_TRUE(tests::is_closed(triangles));
      EXPECT_TRUE(is_manifold(triangles));
      EXPECT_EQ(tests::euler_characteristic(triangles), euler);
      EXPECT_EQ(tests::component_count({mesh.positions, triangles}), tests::component_count(mesh));
    }
  }
}

TEST(LinkConditionTest, ASphereEndsAsATetrahedron) {
  Surface surface(tests::sphere(400));
  surface.collapse_harmless(7);
  EXPECT_EQ(surface.triangles().size(), 4U);
}

TEST(LinkConditionTest, HarmlessCollapsesKeepBorders) {
  tests::TestMesh holes = tests::open_grid(12, 12);
  std::erase_if(holes.triangles, [](const MeshTriangle& t) { return t[0] == 45 || t[0] == 97; });
  const std::vector<tests::NamedMesh> meshes = {
      {"grid", tests::open_grid(9, 9)}, {"moebius", tests::moebius(300)}, {"holes", holes}};
  for (const auto& [name, mesh] : meshes) {
    for (std::uint64_t seed = 60; seed < 65; ++seed) {
      SCOPED_TRACE(name);
      Surface surface(mesh);
      EXPECT_GT(surface.collapse_harmless(seed), mesh.positions.size() / 2);
      const std::vector<MeshTriangle> triangles = surface.triangles();
      EXPECT_TRUE(is_manifold(triangles));
      EXPECT_EQ(tests::euler_characteristic(triangles),
                tests::euler_characteristic(mesh.triangles));
      EXPECT_EQ(tests::border_line_count(triangles), tests::border_line_count(mesh.triangles));
    }
  }
}

TEST(LinkConditionTest, HarmlessCollapsesKeepTheEulerCharacteristicOfNonManifolds) {
  const std::vector<tests::NamedMesh> meshes = {
      {"non-manifold", tests::non_manifold(300)},
      {"mirrored", tests::mirrored(tests::sphere(200))},
      {"back to back", tests::mirrored(tests::open_grid(9, 9))},
      {"soup", tests::soup(30)}};
  for (const auto& [name, mesh] : meshes) {
    for (std::uint64_t seed = 70; seed < 75; ++seed) {
      SCOPED_TRACE(name);
      Surface surface(mesh);
      surface.collapse_harmless(seed);
      EXPECT_EQ(euler_of_sets(surface.triangles()), euler_of_sets(mesh.triangles));
    }
  }
}

TEST(LinkConditionTest, WhatIsCalledHarmlessMeetsTheDefinitionOnAnything) {
  const std::vector<tests::TestMesh> meshes = {tests::non_manifold(60), tests::duplicates(100),
                                               tests::mirrored(tests::sphere(60)),
                                               tests::tangle(30, 60, 9), tests::tangle(12, 60, 10)};
  std::size_t met = 0;
  for (const tests::TestMesh& mesh : meshes) {
    Surface surface(mesh);
    for (std::uint64_t step = 0; step < 40; ++step) {
      const Definition definition(surface.triangles());
      std::vector<CollapseMesh::Edge> harmless;
      for (const CollapseMesh::Edge& e : surface.mesh().edges()) {
        if (e.triangle_count == 0 || surface.change(e.a, e.b) != TopologyChange::none)
          continue;
        ASSERT_TRUE(definition.holds(e.a, e.b)) << "edge " << e.a << "-" << e.b;
        harmless.push_back(e);
      }
      if (harmless.empty())
        break;
      met += harmless.size();
      const CollapseMesh::Edge next = harmless[step * 7919 % harmless.size()];
      surface.collapse(next.a, next.b);
    }
  }
  EXPECT_GT(met, 1000U);
}

}  // namespace
}  // namespace meshhier::cluster_simplify

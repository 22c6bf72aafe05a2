#include "cluster_simplify/collapse_mesh.h"

#include "cluster_simplify/edge_star.h"
#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"
#include "tests/support/share.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;
using Fan = CollapseMesh::Fan;
using Corners = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  ///< triangle and others
using Ends = std::pair<std::uint32_t, std::uint32_t>;

Ends ends_of(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The same collapses done the slow way, on nothing but triangles.
class Reference {
 public:
  explicit Reference(const TileMesh& mesh) : roots_(mesh.vertices.size()) {
    for (const auto* list : {&mesh.interior, &mesh.border}) {
      for (const TileTriangle& t : *list)
        triangles_.push_back({raw(t[0]), raw(t[1]), raw(t[2])});
    }
    alive_.assign(triangles_.size(), true);
    std::iota(roots_.begin(), roots_.end(), 0U);
  }

  void collapse(std::uint32_t from, std::uint32_t to) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      auto& t = triangles_[i];
      std::ranges::replace(t, from, to);
      alive_[i] = alive_[i] && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    }
    std::ranges::replace(roots_, from, to);
  }

  std::uint32_t root(std::uint32_t vertex) const { return roots_[vertex]; }

  std::map<Ends, std::uint32_t> edges() const {
    std::map<Ends, std::uint32_t> counts;
    for_each([&](std::uint32_t, const tests::MeshTriangle& t) {
      for (int k = 0; k < 3; ++k)
        ++counts[ends_of(t[k], t[(k + 1) % 3])];
    });
    return counts;
  }

  std::vector<Corners> around(std::uint32_t vertex) const {
    std::vector<Corners> result;
    for_each([&](std::uint32_t i, const tests::MeshTriangle& t) {
      for (int k = 0; k < 3; ++k) {
        if (t[k] == vertex)
          result.emplace_back(i, t[(k + 1) % 3], t[(k + 2) % 3]);
      }
    });
    return result;
  }

 private:
  void for_each(const auto& visit) const {
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      if (alive_[i])
        visit(i, triangles_[i]);
    }
  }

  std::vector<tests::MeshTriangle> triangles_;
  std::vector<bool> alive_;
  std::vector<std::uint32_t> roots_;
};

std::vector<std::uint32_t> counts_of(const CollapseMesh& mesh) {
  std::vector<std::uint32_t> counts;
  for (const CollapseMesh::Edge& e : mesh.edges())
    counts.push_back(e.triangle_count);
  return counts;
}

/// The ways in which stars may collapse.
enum class Way { disc, anything };

/// Collapses one edge; returns which were reported gone, in the order of the reports.
std::vector<std::uint32_t> collapse(CollapseMesh& mesh, std::uint32_t from, std::uint32_t to,
                                    Way way = Way::disc) {
  EdgeStar star;
  star.gather(mesh, from, to);
  if (star.is_disc() && way == Way::disc) {
    const auto gone = mesh.collapse_disc(star);
    return {gone.begin(), gone.end()};
  }
  std::vector<std::uint32_t> gone;
  mesh.collapse(from, to, star.around_from(), star.around_to(),
                [&](std::uint32_t e) { gone.push_back(e); });
  return gone;
}

void expect_edges_recounted(const CollapseMesh& mesh, const Reference& reference) {
  std::map<Ends, std::uint32_t> found;
  for (const CollapseMesh::Edge& e : mesh.edges()) {
    if (e.triangle_count > 0) {
      EXPECT_TRUE(found.emplace(ends_of(e.a, e.b), e.triangle_count).second) << "met twice";
    }
  }
  EXPECT_EQ(found, reference.edges());
}

void expect_fans_gathered(CollapseMesh& mesh, const Reference& reference) {
  std::vector<Fan> fans;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    ASSERT_EQ(mesh.representative(v), reference.root(v));
    if (reference.root(v) != v)
      continue;
    ASSERT_EQ(mesh.is_isolated(v), reference.around(v).empty()) << "vertex " << v;
    mesh.gather(v, fans);
    std::vector<Corners> found;
    for (const Fan& fan : fans) {
      found.emplace_back(fan.triangle, fan.next, fan.previous);
      const auto& next = mesh.edge(fan.next_edge);
      const auto& previous = mesh.edge(fan.previous_edge);
      ASSERT_EQ(ends_of(next.a, next.b), ends_of(v, fan.next));
      ASSERT_EQ(ends_of(previous.a, previous.b), ends_of(v, fan.previous));
    }
    std::ranges::sort(found);
    ASSERT_EQ(found, reference.around(v)) << "vertex " << v;
  }
}

/// Expects of each triangle that is left that its face names the edge from corner k to the next
/// one.
void expect_sides_named(const CollapseMesh& mesh) {
  for (std::uint32_t t = 0; t < mesh.faces().size(); ++t) {
    const auto& [corners, edges] = mesh.faces()[t];
    for (std::size_t k = 0; k < 3 && mesh.faces()[t].is_alive(); ++k) {
      const auto& e = mesh.edge(edges[k]);
      ASSERT_EQ(ends_of(e.a, e.b), ends_of(corners[k], corners[(k + 1) % 3])) << "triangle " << t;
    }
  }
}

/// Edges with triangles before and none now.
std::vector<std::uint32_t> vanished(const std::vector<std::uint32_t>& before,
                                    const std::vector<std::uint32_t>& after) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t e = 0; e < before.size(); ++e) {
    if (before[e] > 0 && after[e] == 0)
      result.push_back(e);
  }
  return result;
}

/// Collapses random own edges until none is left, discs either way, and compares with the reference
/// after each.
std::size_t collapse_all(const TileMesh& tile, std::uint64_t seed) {
  CollapseMesh mesh(tile);
  Reference reference(tile);
  expect_edges_recounted(mesh, reference);
  expect_fans_gathered(mesh, reference);
  std::size_t count = 0;
  for (auto live = tests::live_edges(mesh); !live.empty(); live = tests::live_edges(mesh)) {
    const float pick = (tests::hash_noise(count, seed) + 1) / 2;
    auto [from, to, triangles] =
        mesh.edge(live[static_cast<std::size_t>(pick * static_cast<float>(live.size()))]);
    if (tests::hash_noise(count, seed + 1000) < 0)
      std::swap(from, to);
    const std::vector<std::uint32_t> before = counts_of(mesh);
    const Way way = tests::hash_noise(count, seed + 2000) < 0 ? Way::disc : Way::anything;
    std::vector<std::uint32_t> gone = collapse(mesh, from, to, way);
    reference.collapse(from, to);
    ++count;
    std::ranges::sort(gone);
    EXPECT_EQ(gone, vanished(before, counts_of(mesh))) << "collapse " << count;
    expect_edges_recounted(mesh, reference);
    expect_fans_gathered(mesh, reference);
    expect_sides_named(mesh);
    if (testing::Test::HasFailure())
      return count;
  }
  return count;
}

TEST(CollapseMeshTest, KnowsTheEdgesAndFansOfTwoTriangles) {
  //  3---2
  //  | / |
  //  0---1
  CollapseMesh mesh(tests::tile_of({std::vector<Vec3f>(4), {{0, 1, 2}, {0, 2, 3}}}).mesh);
  EXPECT_EQ(mesh.vertex_count(), 4U);
  EXPECT_EQ(mesh.own_count(), 4U);
  ASSERT_EQ(mesh.edges().size(), 5U);
  EXPECT_THAT(counts_of(mesh), UnorderedElementsAre(1U, 1U, 1U, 1U, 2U));
  std::vector<Fan> fans;
  mesh.gather(2, fans);
  ASSERT_EQ(fans.size(), 2U);
  EXPECT_EQ(fans[0].triangle, 0U);
  EXPECT_EQ(fans[0].next, 0U);
  EXPECT_EQ(fans[0].previous, 1U);
  EXPECT_EQ(fans[1].triangle, 1U);
  EXPECT_EQ(fans[1].next, 3U);
  EXPECT_EQ(fans[1].previous, 0U);
  EXPECT_EQ(fans[0].next_edge, fans[1].previous_edge);
  EXPECT_EQ(mesh.edge(fans[0].next_edge).triangle_count, 2U);
}

TEST(CollapseMeshTest, AMeshWithoutTrianglesHasOnlyIsolatedVertices) {
  CollapseMesh mesh(tests::tile_of(tests::points(3)).mesh);
  EXPECT_THAT(mesh.edges(), IsEmpty());
  std::vector<Fan> fans(1);
  for (std::uint32_t v = 0; v < 3; ++v) {
    EXPECT_TRUE(mesh.is_isolated(v));
    EXPECT_EQ(mesh.representative(v), v);
    mesh.gather(v, fans);
    EXPECT_THAT(fans, IsEmpty());
  }
}

TEST(CollapseMeshTest, OnlyEdgesBetweenOwnVerticesAreOwn) {
  const CollapseMesh mesh(
      tests::tile_of({std::vector<Vec3f>(5), {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}}, 3).mesh);
  EXPECT_EQ(mesh.own_count(), 3U);
  EXPECT_EQ(mesh.vertex_count(), 5U);
  std::vector<Ends> own;
  for (std::uint32_t e = 0; e < mesh.edges().size(); ++e) {
    if (mesh.is_own_edge(e))
      own.push_back(ends_of(mesh.edge(e).a, mesh.edge(e).b));
  }
  EXPECT_THAT(own, UnorderedElementsAre(Ends{0, 1}, Ends{0, 2}, Ends{1, 2}));
}

TEST(CollapseMeshTest, TrianglesAtTheEdgeDieAndOthersFollow) {
  CollapseMesh mesh(tests::tile_of({std::vector<Vec3f>(4), {{0, 1, 2}, {0, 2, 3}}}).mesh);
  const std::vector<std::uint32_t> gone = collapse(mesh, 1, 2);
  EXPECT_FALSE(mesh.faces()[0].is_alive());
  EXPECT_TRUE(mesh.faces()[1].is_alive());
  EXPECT_THAT(mesh.faces()[1].corners, ElementsAre(0U, 2U, 3U));
  EXPECT_EQ(mesh.representative(1), 2U);
  EXPECT_TRUE(mesh.is_isolated(1));
  EXPECT_THAT(gone, testing::SizeIs(2));
}

TEST(CollapseMeshTest, AnEdgeThatLosesItsOnlyTriangleButTakesOverAnotherIsNotGone) {
  // The edge 0-2 has one triangle, which dies with the edge 0-1; that of the edge 1-2 follows.
  for (const bool dying_first : {true, false}) {
    tests::TestMesh pair{std::vector<Vec3f>(4), {{0, 1, 2}, {1, 3, 2}}};
    if (!dying_first)
      std::swap(pair.triangles[0], pair.triangles[1]);
    CollapseMesh mesh(tests::tile_of(pair).mesh);
    for (const std::uint32_t e : collapse(mesh, 1, 0)) {
      EXPECT_EQ(mesh.edge(e).triangle_count, 0U)
          << "edge " << mesh.edge(e).a << "-" << mesh.edge(e).b << " is in use";
    }
    EXPECT_EQ(std::ranges::count(counts_of(mesh), 1U), 3);
  }
}

TEST(CollapseMeshTest, APieceThatLosesItsLastEdgeIsGone) {
  CollapseMesh mesh(tests::tile_of({std::vector<Vec3f>(3), {{0, 1, 2}, {0, 2, 1}}}).mesh);
  EXPECT_THAT(collapse(mesh, 0, 1), UnorderedElementsAre(0U, 1U, 2U));
  for (std::uint32_t v = 0; v < 3; ++v)
    EXPECT_TRUE(mesh.is_isolated(v));
}

TEST(CollapseMeshTest, RepresentativesFollowChainsOfCollapses) {
  CollapseMesh mesh(tests::tile_of(tests::open_grid(8, 1)).mesh);
  for (std::uint32_t v = 0; v < 8; ++v)
    collapse(mesh, v, v + 1);
  for (std::uint32_t v = 0; v < 9; ++v)
    EXPECT_EQ(mesh.representative(v), 8U);
  EXPECT_EQ(mesh.representative(9), 9U);
}

TEST(CollapseMeshTest, StaysConsistentThroughThousandsOfCollapses) {
  constexpr std::size_t kSeeds = 6;
  const tests::Share share = tests::share().of(kSeeds);
  std::size_t count = 0;
  for (const auto& [name, mesh] : tests::small_meshes()) {
    SCOPED_TRACE(name);
    const BuildTile tile = tests::tile_of(mesh);
    for (std::size_t seed = share.index; seed < kSeeds && !HasFailure(); seed += share.count)
      count += collapse_all(tile.mesh, 10 * seed);
  }
  EXPECT_GT(count, 500U * share.part_of(kSeeds));
}

TEST(CollapseMeshTest, StaysConsistentNextToGhosts) {
  for (const auto& [name, mesh] : tests::small_meshes()) {
    SCOPED_TRACE(name);
    const BuildTile tile = tests::part_of(mesh, 0.2F);
    ASSERT_LT(tile.mesh.own_count, tile.mesh.vertices.size());
    const tests::Share share = tests::share().of(3);
    for (std::size_t seed = share.index; seed < 3 && !HasFailure(); seed += share.count)
      collapse_all(tile.mesh, 10 * seed + 5);
  }
}

TEST(CollapseMeshTest, AHubsEdgesAreFoundWithoutComparingAllPairs) {
  constexpr std::uint32_t kSpokes = 50'000;
  CollapseMesh mesh(tests::tile_of(tests::wheel(kSpokes, 0)).mesh);
  EXPECT_EQ(mesh.edges().size(), 2 * kSpokes);
  EXPECT_TRUE(std::ranges::all_of(counts_of(mesh), [](auto n) { return n == 1 || n == 2; }));
  EXPECT_EQ(std::ranges::count(counts_of(mesh), 2U), kSpokes);
}

}  // namespace
}  // namespace meshhier::cluster_simplify

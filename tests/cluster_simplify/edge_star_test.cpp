#include "cluster_simplify/edge_star.h"

#include "cluster_simplify/link_condition.h"
#include "tests/cluster_simplify/collapsing.h"
#include "tests/cluster_simplify/stars.h"
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using Fan = CollapseMesh::Fan;
using tests::live_edges;
using tests::TestMesh;

/// An edge to collapse, as told by noise.
std::array<std::uint32_t, 2> pick_edge(const CollapseMesh& mesh,
                                       const std::vector<std::uint32_t>& edges, std::uint64_t index,
                                       std::uint64_t seed) {
  const float part = (tests::hash_noise(index, seed) + 1) / 2;
  const auto place = static_cast<std::size_t>(part * static_cast<float>(edges.size()));
  const auto [a, b, count] = mesh.edge(edges[std::min(place, edges.size() - 1)]);
  if (tests::hash_noise(index, seed + 1000) < 0)
    return {b, a};
  return {a, b};
}

/// Collapses the edge like any other; returns which edges were reported gone.
std::set<std::uint32_t> collapse(CollapseMesh& mesh, const EdgeStar& star) {
  std::set<std::uint32_t> gone;
  mesh.collapse(star.from(), star.to(), star.around_from(), star.around_to(),
                [&](std::uint32_t e) { EXPECT_TRUE(gone.insert(e).second) << "twice"; });
  return gone;
}

/// The vertices around one, from `start` on; none unless its triangles make just one ring that goes
/// through `start`.
std::vector<std::uint32_t> ring_around(Fans fans, std::uint32_t start) {
  std::map<std::uint32_t, std::uint32_t> after;
  for (const Fan& fan : fans)
    after.emplace(fan.next, fan.previous);
  std::vector<std::uint32_t> ring;
  for (std::uint32_t v = start; after.contains(v);) {
    ring.push_back(v);
    v = after.at(v);
    after.erase(ring.back());
    if (v == start)
      return ring.size() == fans.size() ? ring : std::vector<std::uint32_t>();
  }
  return {};
}

/// The ring of a disc told the slow way, in order; none if there is no disc.
std::vector<std::uint32_t> ring_of(const EdgeStar& star) {
  std::vector<std::uint32_t> ring = ring_around(star.around_from(), star.to());
  const std::vector<std::uint32_t> rest = ring_around(star.around_to(), star.from());
  if (ring.size() < 3 || rest.size() < 3 || ring.back() != rest[1] || rest.back() != ring[1] ||
      star.around_from().size() + star.around_to().size() > EdgeStar::kMostLinks)
    return {};
  ring.erase(ring.begin());
  ring.insert(ring.end(), rest.begin() + 2, rest.end() - 1);
  const std::set<std::uint32_t> vertices(ring.begin(), ring.end());
  return vertices.size() == ring.size() && ring.size() > 2 ? ring : std::vector<std::uint32_t>();
}

/// All but the triangles at the edge, those of `from` first, each opposite its link.
void expect_links_in_order(const EdgeStar& star) {
  std::multiset<std::uint32_t> of_from, of_to;
  for (std::uint32_t i = 0; i < star.size(); ++i) {
    const Fan& fan = *star.links()[i];
    ASSERT_EQ(fan.next, star.vertex(i));
    ASSERT_EQ(fan.previous, star.vertex((i + 1) % star.size()));
    (i < star.to_begin() ? of_from : of_to).insert(fan.corner());
  }
  const auto staying = [](Fans fans, std::uint32_t other) {
    std::multiset<std::uint32_t> corners;
    for (const Fan& fan : fans) {
      if (!fan.is_at(other))
        corners.insert(fan.corner());
    }
    return corners;
  };
  ASSERT_EQ(of_from, staying(star.around_from(), star.to()));
  ASSERT_EQ(of_to, staying(star.around_to(), star.from()));
}

void expect_at_edge(const EdgeStar& star) {
  const auto [first, last] = star.at_edge();
  ASSERT_EQ(first->next, star.to());
  ASSERT_EQ(first->previous, star.vertex(0));
  ASSERT_EQ(last->previous, star.to());
  ASSERT_EQ(last->next, star.vertex(star.to_begin()));
  for (const Fan* fan : star.at_edge()) {
    ASSERT_TRUE(
        std::ranges::any_of(star.around_from(), [&](const Fan& other) { return &other == fan; }));
  }
}

/// Checks the promises of a disc.
void expect_disc(const CollapseMesh& mesh, const EdgeStar& star, LinkCondition& link) {
  ASSERT_EQ(link.change(mesh, star.from(), star.to(), star.around_from(), star.around_to()),
            TopologyChange::none);
  for (const Fans fans : {star.around_from(), star.around_to()}) {
    for (const Fan& fan : fans) {
      ASSERT_EQ(mesh.edge(fan.next_edge).triangle_count, 2U);
      ASSERT_EQ(mesh.edge(fan.previous_edge).triangle_count, 2U);
    }
  }
  ASSERT_GE(star.size(), 3U);
  ASSERT_GE(star.to_begin(), 1U);
  ASSERT_LT(star.to_begin(), star.size());
  std::set<std::uint32_t> vertices = {star.from(), star.to()};
  for (std::uint32_t i = 0; i < star.size(); ++i)
    ASSERT_TRUE(vertices.insert(star.vertex(i)).second) << "met twice";
  expect_links_in_order(star);
  expect_at_edge(star);
}

/// Looks at all own edges from both ends; returns how many ways there was a disc.
std::size_t expect_discs_told(CollapseMesh& mesh, EdgeStar& star, LinkCondition& link) {
  std::size_t discs = 0;
  for (const std::uint32_t e : live_edges(mesh)) {
    const auto [a, b, count] = mesh.edge(e);
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      star.gather(mesh, from, to);
      const std::vector<std::uint32_t> ring = ring_of(star);
      EXPECT_EQ(star.is_disc(), !ring.empty()) << "edge " << from << "-" << to;
      if (testing::Test::HasFailure() || !star.is_disc())
        continue;
      expect_disc(mesh, star, link);
      for (std::uint32_t i = 0; i < star.size(); ++i)
        EXPECT_EQ(star.vertex(i), ring[i]);
      ++discs;
    }
  }
  return discs;
}

TEST(EdgeStarTest, DiscsKeepTheirPromisesWhileAnyEdgesCollapse) {
  std::map<std::string, std::size_t> discs;
  EdgeStar star;
  for (const auto& [name, mesh] : tests::small_meshes()) {
    SCOPED_TRACE(name);
    CollapseMesh collapsing(tests::tile_of(mesh).mesh);
    LinkCondition link(collapsing.vertex_count());
    std::uint64_t count = 0;
    for (auto live = live_edges(collapsing); !live.empty(); live = live_edges(collapsing)) {
      discs[name] += expect_discs_told(collapsing, star, link);
      ASSERT_FALSE(HasFailure()) << "after collapse " << count;
      const auto [from, to] = pick_edge(collapsing, live, count++, 11);
      star.gather(collapsing, from, to);
      collapse(collapsing, star);
    }
  }
  for (const char* name : {"closed", "torus", "open", "non-manifold"})
    EXPECT_GT(discs[name], 100U) << name;
}

/// A wheel from both sides.
TestMesh bipyramid(std::uint32_t spokes) {
  TestMesh mesh = tests::wheel(spokes, 1);
  const TestMesh upper = mesh;
  mesh.positions.push_back({0, 0, -1});
  for (const tests::MeshTriangle& t : upper.triangles)
    mesh.triangles.push_back({spokes + 1, t[2], t[1]});
  return mesh;
}

/// Looks at all edges; returns those that are harmless.
std::vector<std::uint32_t> expect_harmless_are_discs(CollapseMesh& mesh, EdgeStar& star,
                                                     LinkCondition& link) {
  std::vector<std::uint32_t> harmless;
  for (const std::uint32_t e : live_edges(mesh)) {
    const auto [a, b, count] = mesh.edge(e);
    star.gather(mesh, a, b);
    const bool is_small =
        star.around_from().size() + star.around_to().size() <= EdgeStar::kMostLinks;
    const TopologyChange change = link.change(mesh, a, b, star.around_from(), star.around_to());
    EXPECT_EQ(star.is_disc(), change == TopologyChange::none && is_small)
        << "edge " << a << "-" << b;
    if (change == TopologyChange::none)
      harmless.push_back(e);
  }
  return harmless;
}

TEST(EdgeStarTest, OnClosedManifoldsWhatIsHarmlessIsADisc) {
  EdgeStar star;
  for (const auto& [name, mesh] : {tests::NamedMesh{"sphere", tests::sphere(200)},
                                   {"torus", tests::torus(150)},
                                   {"genus 2", tests::genus_n(2, 200)},
                                   {"shells", tests::nested_shells(200)},
                                   {"bipyramid", bipyramid(40)}}) {
    SCOPED_TRACE(name);
    CollapseMesh collapsing(tests::tile_of(mesh).mesh);
    LinkCondition link(collapsing.vertex_count());
    std::uint64_t count = 0;
    for (;; ++count) {
      const auto harmless = expect_harmless_are_discs(collapsing, star, link);
      ASSERT_FALSE(HasFailure()) << "after collapse " << count;
      if (harmless.empty())
        break;
      const auto [from, to] = pick_edge(collapsing, harmless, count, 12);
      star.gather(collapsing, from, to);
      collapse(collapsing, star);
    }
    EXPECT_GT(count, 30U);
  }
}

bool is_disc(const TestMesh& mesh, std::uint32_t from, std::uint32_t to) {
  CollapseMesh collapsing(tests::tile_of(mesh).mesh);
  EdgeStar star;
  star.gather(collapsing, from, to);
  EXPECT_EQ(star.from(), from);
  EXPECT_EQ(star.to(), to);
  return star.is_disc();
}

TEST(EdgeStarTest, ADiscHasNoMoreTrianglesThanThereIsRoomFor) {
  const std::uint32_t most = EdgeStar::kMostLinks - 4;  // a boundary vertex has four
  for (const auto& [spokes, fits] : {std::pair(most, true), std::pair(most + 1, false)}) {
    EXPECT_EQ(is_disc(bipyramid(spokes), 0, 1), fits);
    EXPECT_EQ(is_disc(bipyramid(spokes), 1, 0), fits);
    EXPECT_TRUE(is_disc(bipyramid(spokes), 1, 2));
  }
}

TEST(EdgeStarTest, TwoRingsAtAnEndAreNoDisc) {
  // Both may have the same size, too: going around the one twice comes as far.
  for (const std::uint32_t spokes : {3U, 4U, 5U, 8U}) {
    TestMesh mesh = bipyramid(4);
    const auto base = tests::count_of(mesh.positions);
    ASSERT_TRUE(is_disc(mesh, 0, 1));
    tests::append(mesh, bipyramid(spokes));
    for (tests::MeshTriangle& t : mesh.triangles)
      std::ranges::replace(t, base, 0U);
    EXPECT_FALSE(is_disc(mesh, 0, 1)) << spokes;
    EXPECT_FALSE(is_disc(mesh, 1, 0)) << spokes;
    EXPECT_TRUE(is_disc(mesh, 1, 2)) << spokes;
  }
}

TEST(EdgeStarTest, ATetrahedronHasNoDisc) {
  EXPECT_FALSE(
      is_disc({std::vector<Vec3f>(4), {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}}, 0, 1));
}

TEST(EdgeStarTest, SheetsBackToBackAreNoDisc) {
  const TestMesh sphere = tests::sphere(50);
  const auto& t = sphere.triangles[0];
  EXPECT_TRUE(is_disc(sphere, t[0], t[1]));
  EXPECT_FALSE(is_disc(tests::mirrored(sphere), t[0], t[1]));
}

TEST(EdgeStarTest, IsSeenFromItsPlace) {
  EdgeStar star;  // remains of larger ones must not be seen
  for (std::uint32_t step = 0; step < 50; ++step) {
    const std::uint32_t size = 4 + step * 11 % 25;
    const tests::Star round =
        tests::round_star({size, 1 + step % (size - 1)}, {"bumpy", 0.5}, step);
    CollapseMesh mesh(tests::tile_of(round.mesh).mesh);
    star.gather(mesh, round.from, round.to);
    ASSERT_TRUE(star.is_disc());
    star.look_from(round.place, round.mesh.positions);
    ASSERT_EQ(star.size(), size);
    for (std::uint32_t i = 0; i < (size + 4) / 4 * 4; ++i) {
      const Vec3f expected =
          i <= size ? round.mesh.positions[star.vertex(i % size)] - round.place : Vec3f{};
      EXPECT_EQ(star.x()[i], expected.x);
      EXPECT_EQ(star.y()[i], expected.y);
      EXPECT_EQ(star.z()[i], expected.z);
    }
  }
}

// ---- collapses of discs ------------------------------------------------------------------------

void expect_same_edges(const CollapseMesh& mesh, const CollapseMesh& reference) {
  for (std::uint32_t e = 0; e < mesh.edges().size(); ++e) {
    const auto [a, b, count] = mesh.edge(e);
    const auto [c, d, reference_count] = reference.edge(e);
    ASSERT_EQ(count, reference_count) << "edge " << e;
    if (count > 0) {
      ASSERT_EQ(std::minmax(a, b), std::minmax(c, d)) << "edge " << e;
    }
  }
}

void expect_same_faces(const CollapseMesh& mesh, const CollapseMesh& reference) {
  for (std::uint32_t t = 0; t < mesh.faces().size(); ++t) {
    const CollapseMesh::Face& face = mesh.faces()[t];
    const CollapseMesh::Face& expected = reference.faces()[t];
    ASSERT_EQ(face.is_alive(), expected.is_alive()) << "triangle " << t;
    if (face.is_alive()) {
      ASSERT_EQ(face.corners, expected.corners) << "triangle " << t;
      ASSERT_EQ(face.edges, expected.edges) << "triangle " << t;
    }
  }
}

void expect_same_vertices(CollapseMesh& mesh, CollapseMesh& reference) {
  std::vector<Fan> fans;
  const auto corners_at = [&](CollapseMesh& one, std::uint32_t v) {
    one.gather(v, fans);
    std::multiset<std::uint32_t> corners;
    for (const Fan& fan : fans)
      corners.insert(fan.corner());
    return corners;
  };
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    ASSERT_EQ(mesh.representative(v), reference.representative(v));
    ASSERT_EQ(mesh.is_isolated(v), reference.is_isolated(v)) << "vertex " << v;
    ASSERT_EQ(corners_at(mesh, v), corners_at(reference, v)) << "vertex " << v;
  }
}

/// Collapses random own edges until none is left, in one mesh discs as such, in the other like all.
/// Returns how many discs were met.
std::size_t collapse_both_ways(const TileMesh& tile, std::uint64_t seed) {
  CollapseMesh mesh(tile);
  CollapseMesh reference(tile);
  EdgeStar star, reference_star;
  std::size_t discs = 0;
  std::uint64_t count = 0;
  for (auto live = live_edges(mesh); !live.empty(); live = live_edges(mesh)) {
    const auto [from, to] = pick_edge(mesh, live, count++, seed);
    star.gather(mesh, from, to);
    reference_star.gather(reference, from, to);
    EXPECT_EQ(star.is_disc(), reference_star.is_disc());
    std::set<std::uint32_t> gone;
    if (star.is_disc()) {
      const auto edges = mesh.collapse_disc(star);
      gone.insert(edges.begin(), edges.end());
      ++discs;
    } else {
      gone = collapse(mesh, star);
    }
    EXPECT_EQ(gone, collapse(reference, reference_star)) << "collapse " << count;
    expect_same_edges(mesh, reference);
    expect_same_faces(mesh, reference);
    expect_same_vertices(mesh, reference);
    if (testing::Test::HasFailure())
      return discs;
  }
  return discs;
}

TEST(EdgeStarTest, DiscsCollapseAsEverythingDoes) {
  std::size_t discs = 0;
  for (const auto& [name, mesh] : tests::small_meshes()) {
    SCOPED_TRACE(name);
    for (std::uint64_t seed = 20; seed < 24 && !HasFailure(); ++seed) {
      discs += collapse_both_ways(tests::tile_of(mesh).mesh, seed);
      discs += collapse_both_ways(tests::part_of(mesh, 0.2F).mesh, seed);
    }
  }
  EXPECT_GT(discs, 500U);
}

}  // namespace
}  // namespace meshhier::cluster_simplify

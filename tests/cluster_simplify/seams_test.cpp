#include "cluster_simplify/seams.h"

#include "base/error.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Triangles = std::vector<tests::MeshTriangle>;
using tests::tile_triangle;

/// Smallest corner first, sorted: equal for equal sets of triangles. `unique` drops repeats.
Triangles normalized(Triangles triangles, bool unique) {
  std::erase_if(triangles, [](const tests::MeshTriangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
  for (tests::MeshTriangle& t : triangles)
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  std::ranges::sort(triangles);
  if (unique)
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

/// A mesh whose vertices belong to tiles of one level: what the seam kernels must agree with,
/// kept as global numbers.
struct World {
  std::vector<Vec3f> positions;
  std::vector<float> weights;
  Triangles triangles;
  std::vector<std::uint32_t> tile_of;
  std::vector<std::uint32_t> local_of;          ///< set by number()
  std::vector<std::vector<std::uint32_t>> own;  ///< tile, local -> global
  std::vector<std::uint32_t> boundary_counts;

  /// Numbers each tile's vertices, the corners of border triangles first.
  void number(std::uint32_t tile_count) {
    std::vector<bool> on_boundary(positions.size());
    for (const tests::MeshTriangle& t : triangles) {
      if (!is_inside(t)) {
        for (const std::uint32_t v : t)
          on_boundary[v] = true;
      }
    }
    own.assign(tile_count, {});
    boundary_counts.assign(tile_count, 0);
    local_of.assign(positions.size(), 0);
    for (const bool boundary : {true, false}) {
      for (std::uint32_t v = 0; v < positions.size(); ++v) {
        if (on_boundary[v] != boundary)
          continue;
        std::vector<std::uint32_t>& tile = own[tile_of[v]];
        local_of[v] = static_cast<std::uint32_t>(tile.size());
        tile.push_back(v);
        boundary_counts[tile_of[v]] += boundary ? 1 : 0;
      }
    }
  }

  bool is_inside(const tests::MeshTriangle& t) const {
    return tile_of[t[0]] == tile_of[t[1]] && tile_of[t[1]] == tile_of[t[2]];
  }
  bool touches(const tests::MeshTriangle& t, std::uint32_t tile) const {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return tile_of[v] == tile; });
  }
  Triangles select(const std::function<bool(const tests::MeshTriangle&)>& wanted) const {
    Triangles selected;
    std::ranges::copy_if(triangles, std::back_inserter(selected), wanted);
    return normalized(std::move(selected), true);
  }
  Triangles interior(std::uint32_t tile) const {
    return select([&](const auto& t) { return is_inside(t) && touches(t, tile); });
  }
  Triangles border(std::uint32_t tile) const {
    return select([&](const auto& t) { return !is_inside(t) && touches(t, tile); });
  }

  std::uint32_t global(const TileMesh& mesh, std::uint32_t tile, TileVertex v) const {
    if (mesh.is_own(v))
      return own[tile].at(raw(v));
    return own[mesh.ghost(v).tile].at(mesh.ghost(v).index);
  }
  /// A tile's triangles in global numbers, as they are.
  Triangles global(const TileMesh& mesh, std::uint32_t tile,
                   std::span<const TileTriangle> local) const {
    Triangles result;
    for (const TileTriangle& t : local)
      result.push_back(
          {global(mesh, tile, t[0]), global(mesh, tile, t[1]), global(mesh, tile, t[2])});
    return normalized(std::move(result), false);
  }
};

World make_world(const tests::TestMesh& mesh, std::uint32_t tile_count, bool scattered) {
  World world;
  world.positions = mesh.positions;
  world.triangles = mesh.triangles;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const float where = scattered ? tests::hash_noise(v, 77) : mesh.positions[v].x / 1.5F;
    const float part = std::clamp((where + 1) / 2, 0.0F, 0.999F);
    world.tile_of.push_back(static_cast<std::uint32_t>(part * static_cast<float>(tile_count)));
    world.weights.push_back(std::floor(tests::hash_noise(v, 79) * 4) + 5);
  }
  world.number(tile_count);
  return world;
}

/// The same vertices of the same tiles, as if these were of one level with who names them.
std::vector<GhostRef> refs_of(const std::vector<FinerGhost>& foreign) {
  std::vector<GhostRef> refs;
  for (const FinerGhost& corner : foreign)
    refs.push_back(corner.ref);
  return refs;
}

/// The tile as its own stage would leave it: foreign corners named, not known.
SimplifiedTile work_tile(const World& world, std::uint32_t tile) {
  SimplifiedTile work;
  for (const std::uint32_t v : world.own[tile]) {
    work.vertices.positions.push_back(world.positions[v]);
    work.history.weights.push_back(world.weights[v]);
  }
  work.boundary_count = world.boundary_counts[tile];
  const auto own_count = static_cast<std::uint32_t>(work.vertices.size());
  std::set<GhostRef> refs;
  for (const tests::MeshTriangle& t : world.border(tile)) {
    for (const std::uint32_t v : t) {
      if (world.tile_of[v] != tile)
        refs.insert({world.tile_of[v], world.local_of[v]});
    }
  }
  for (const GhostRef& ref : refs)
    work.foreign.push_back({ref});
  const auto local = [&](std::uint32_t v) {
    if (world.tile_of[v] == tile)
      return world.local_of[v];
    const FinerGhost corner{{world.tile_of[v], world.local_of[v]}};
    return own_count + static_cast<std::uint32_t>(std::ranges::lower_bound(work.foreign, corner) -
                                                  work.foreign.begin());
  };
  for (const tests::MeshTriangle& t : world.interior(tile))
    work.interior.push_back(tile_triangle(local(t[0]), local(t[1]), local(t[2])));
  for (const tests::MeshTriangle& t : world.border(tile))
    work.border.push_back(tile_triangle(local(t[0]), local(t[1]), local(t[2])));
  normalize_triangles(work.interior, false);
  return work;
}

Boundary boundary_of(const World& world, std::uint32_t tile) {
  Boundary boundary;
  for (std::uint32_t i = 0; i < world.boundary_counts[tile]; ++i) {
    boundary.vertices.positions.push_back(world.positions[world.own[tile][i]]);
  }
  return boundary;
}

void fill_all(BuildTile& tile, const World& world) {
  std::set<std::uint32_t> neighbours;
  for (const GhostRef& ghost : tile.mesh.ghosts)
    neighbours.insert(ghost.tile);
  for (const std::uint32_t neighbour : neighbours)
    fill_ghosts(tile, neighbour, boundary_of(world, neighbour));
}

BuildTile build_tile(const World& world, std::uint32_t tile) {
  SimplifiedTile work = work_tile(world, tile);
  const std::vector<GhostRef> same = refs_of(work.foreign);
  BuildTile built = resolve(std::move(work), same, true, 0);
  fill_all(built, world);
  return built;
}

/// Every promise of TileMesh, and that the tile shows what the world has there.
void expect_tile(const World& world, std::uint32_t tile, const BuildTile& built) {
  const TileMesh& mesh = built.mesh;
  ASSERT_EQ(mesh.own_count, world.own[tile].size());
  EXPECT_EQ(mesh.boundary_count, world.boundary_counts[tile]);
  ASSERT_EQ(mesh.vertices.size(), mesh.own_count + mesh.ghosts.size());
  EXPECT_TRUE(std::ranges::is_sorted(mesh.ghosts));
  EXPECT_EQ(std::ranges::adjacent_find(mesh.ghosts), mesh.ghosts.end());
  EXPECT_TRUE(std::ranges::is_sorted(mesh.border));
  EXPECT_EQ(world.global(mesh, tile, mesh.interior), world.interior(tile));
  EXPECT_EQ(world.global(mesh, tile, mesh.border), world.border(tile));
  std::vector<bool> used(mesh.vertices.size());
  for (const TileTriangle& t : mesh.border) {
    EXPECT_EQ(t, canonical(t));
    for (const TileVertex v : t)
      used[raw(v)] = true;
  }
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::uint32_t v = world.global(mesh, tile, TileVertex{i});
    ASSERT_EQ(mesh.vertices.positions[i], world.positions[v]) << "vertex " << i;
    ASSERT_EQ(used[i], i < mesh.boundary_count || i >= mesh.own_count) << "vertex " << i;
  }
}

struct Case {
  const char* name;
  tests::TestMesh mesh;
  bool scattered;
};

std::vector<Case> cases() {
  return {{"sphere", tests::sphere(1200, 0.02F), false},
          {"sphere, scattered tiles", tests::sphere(600), true},
          {"torus", tests::torus(900), false},
          {"non-manifold", tests::non_manifold(600), false},
          {"moebius", tests::moebius(500), false},
          {"duplicates", tests::duplicates(500), true},
          {"soup", tests::soup(200), true},
          {"points", tests::points(100), false}};
}

// ---- resolve and fill_ghosts ---------------------------------------------------------------

TEST(SeamsTest, AResolvedTileShowsItsNeighboursVertices) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const World world = make_world(c.mesh, 4, c.scattered);
    for (std::uint32_t tile = 0; tile < 4; ++tile)
      expect_tile(world, tile, build_tile(world, tile));
  }
}

/// Two own vertices, four foreign corners.
SimplifiedTile small_tile() {
  SimplifiedTile tile;
  tile.vertices.positions = {{0, 0, 0}, {1, 0, 0}};
  tile.history = {{1, 1}};
  tile.boundary_count = 2;
  tile.foreign = {{{2, 0}}, {{2, 1}}, {{2, 2}}, {{5, 0}}};
  return tile;
}

TEST(ResolveTest, ForeignCornersThatBecameOneVertexBecomeOneGhost) {
  SimplifiedTile tile = small_tile();
  tile.border = {tile_triangle(0, 2, 4), tile_triangle(0, 3, 5)};
  const std::vector<GhostRef> mapped = {{1, 3}, {1, 3}, {1, 9}, {1, 3}};
  const BuildTile built = resolve(tile, mapped, true, 0);
  EXPECT_THAT(built.mesh.ghosts, ElementsAre(GhostRef{1, 3}, GhostRef{1, 9}));
  EXPECT_THAT(built.mesh.border, ElementsAre(tile_triangle(0, 2, 3)));  // the other lost its area
}

TEST(ResolveTest, AGhostThatNoTriangleUsesAnyMoreGoes) {
  SimplifiedTile tile = small_tile();
  tile.border = {tile_triangle(0, 2, 3), tile_triangle(0, 1, 5)};
  const std::vector<GhostRef> mapped = {{1, 4}, {1, 4}, {1, 0}, {3, 7}};
  const BuildTile built = resolve(tile, mapped, true, 0);
  EXPECT_THAT(built.mesh.ghosts, ElementsAre(GhostRef{3, 7}));
  EXPECT_THAT(built.mesh.border, ElementsAre(tile_triangle(0, 1, 2)));
}

TEST(ResolveTest, OnlyExactDuplicatesGoAndOnlyIfAskedTo) {
  SimplifiedTile tile = small_tile();
  // The same triangle, turned; and its mirror image, which must stay.
  tile.border = {tile_triangle(0, 1, 2), tile_triangle(3, 0, 1), tile_triangle(1, 0, 2)};
  const std::vector<GhostRef> mapped = {{1, 4}, {1, 4}, {1, 4}, {1, 4}};
  EXPECT_THAT(resolve(tile, mapped, true, 0).mesh.border,
              ElementsAre(tile_triangle(0, 1, 2), tile_triangle(0, 2, 1)));
  EXPECT_THAT(resolve(tile, mapped, false, 0).mesh.border,
              ElementsAre(tile_triangle(0, 1, 2), tile_triangle(0, 1, 2), tile_triangle(0, 2, 1)));
}

TEST(FillGhostsTest, AGhostOutsideTheBoundaryIsADefect) {
  SimplifiedTile work = small_tile();
  work.border = {tile_triangle(0, 1, 4)};
  const std::vector<GhostRef> mapped = refs_of(work.foreign);
  BuildTile tile = resolve(work, mapped, true, 0);
  Boundary boundary;
  boundary.vertices.positions = {{7, 7, 7}, {8, 8, 8}};  // the ghost is number 2
  try {
    fill_ghosts(tile, 2, boundary);
    FAIL() << "a ghost outside the boundary was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
  }
}

// ---- join ----------------------------------------------------------------------------------

/// The world one level up, where tiles 2i and 2i + 1 are tile i; vertices numbered as join() does.
World joined_world(const World& world) {
  World joined = world;
  for (std::uint32_t& tile : joined.tile_of)
    tile /= 2;
  joined.own.assign(world.own.size() / 2, {});
  for (std::uint32_t tile = 0; tile < world.own.size(); ++tile) {
    auto& own = joined.own[tile / 2];
    own.insert(own.end(), world.own[tile].begin(), world.own[tile].end());
  }
  return joined;
}

BuildTile join_pair(const World& world, std::uint32_t pair) {
  return join(build_tile(world, 2 * pair), 2 * pair, build_tile(world, 2 * pair + 1), 2 * pair + 1);
}

/// A joined tile's vertex in global numbers: its ghosts still count in unjoined tiles.
std::uint32_t global_of(const World& world, const World& joined, std::uint32_t pair,
                        const TileMesh& mesh, TileVertex v) {
  return mesh.is_own(v) ? joined.own[pair].at(raw(v))
                        : world.own[mesh.ghost(v).tile].at(mesh.ghost(v).index);
}

Triangles global_of(const World& world, const World& joined, std::uint32_t pair,
                    const TileMesh& mesh, std::span<const TileTriangle> local) {
  Triangles result;
  for (const TileTriangle& t : local) {
    tests::MeshTriangle global{};
    for (std::size_t k = 0; k < 3; ++k)
      global[k] = global_of(world, joined, pair, mesh, t[k]);
    result.push_back(global);
  }
  return normalized(std::move(result), false);
}

TEST(JoinTest, ShowsEveryTriangleOfBothTilesOnce) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const World world = make_world(c.mesh, 4, c.scattered);
    const World above = joined_world(world);
    for (std::uint32_t pair = 0; pair < 2; ++pair) {
      const BuildTile tile = join_pair(world, pair);
      const TileMesh& mesh = tile.mesh;
      EXPECT_EQ(global_of(world, above, pair, mesh, mesh.interior), above.interior(pair));
      EXPECT_EQ(global_of(world, above, pair, mesh, mesh.border), above.border(pair));
    }
  }
}

TEST(JoinTest, CarriesPositionsRadiiAndWeights) {
  const World world = make_world(tests::sphere(1200, 0.02F), 4, true);
  const World above = joined_world(world);
  const BuildTile tile = join_pair(world, 1);
  const TileMesh& mesh = tile.mesh;
  ASSERT_EQ(mesh.own_count, above.own[1].size());
  ASSERT_EQ(tile.history.weights.size(), mesh.own_count);
  ASSERT_EQ(mesh.vertices.size(), mesh.own_count + mesh.ghosts.size());
  EXPECT_TRUE(std::ranges::is_sorted(mesh.ghosts));
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::uint32_t v = global_of(world, above, 1, mesh, TileVertex{i});
    EXPECT_EQ(mesh.vertices.positions[i], world.positions[v]);
    if (i < mesh.own_count) {
      EXPECT_EQ(tile.history.weights[i], world.weights[v]);
    }
  }
}

TEST(JoinTest, TwoTilesThatAreAllOfAMeshHaveNoBorder) {
  const World world = make_world(tests::torus(600), 2, false);
  const BuildTile tile = join_pair(world, 0);
  EXPECT_THAT(tile.mesh.border, IsEmpty());
  EXPECT_THAT(tile.mesh.ghosts, IsEmpty());
  EXPECT_THAT(tile.mesh.interior, SizeIs(world.triangles.size()));
}

// ---- apply ---------------------------------------------------------------------------------

/// A contraction that no method would choose: any vertices merge, representatives lie anywhere.
Contraction wild_contraction(const BuildTile& joined, std::uint32_t target, std::uint64_t seed) {
  Contraction contraction;
  for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i) {
    const float chance = (tests::hash_noise(i, seed) + 1) / 2;
    const auto any = static_cast<std::uint32_t>(chance * static_cast<float>(target));
    contraction.parent_of.push_back(i < target ? i : std::min(any, target - 1));  // onto
  }
  for (std::uint32_t r = 0; r < target; ++r) {
    contraction.representatives.positions.push_back({tests::hash_noise(r, seed + 1),
                                                     tests::hash_noise(r, seed + 2),
                                                     tests::hash_noise(r, seed + 3)});
    contraction.deviation.around.push_back(tests::hash_noise(r, seed + 4) + 1);
  }
  return contraction;
}

/// Contracts both pairs of a world of four tiles; the world of two tiles that must come of it.
struct Contracted {
  std::array<ContractedTile, 2> tiles;
  std::vector<std::uint32_t> parent_of;  ///< global vertex -> global representative
  World world;
};

Contracted contract_pairs(const World& world, std::uint32_t target) {
  Contracted result;
  const World above = joined_world(world);
  result.parent_of.resize(world.positions.size());
  for (std::uint32_t pair = 0; pair < 2; ++pair) {
    const BuildTile joined = join_pair(world, pair);
    const std::uint32_t count = std::min(target, joined.mesh.own_count);
    ContractedTile& tile = result.tiles[pair];
    tile = apply(joined, wild_contraction(joined, count, 200 + pair));
    const auto first = static_cast<std::uint32_t>(result.world.positions.size());
    for (std::uint32_t r = 0; r < count; ++r) {
      result.world.positions.push_back(tile.tile.vertices.positions[r]);
      result.world.weights.push_back(tile.tile.history.weights[r]);
      result.world.tile_of.push_back(pair);
    }
    for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i)
      result.parent_of[above.own[pair][i]] = first + tile.parent_map.at(i);
  }
  for (const tests::MeshTriangle& t : world.triangles) {
    result.world.triangles.push_back(
        {result.parent_of[t[0]], result.parent_of[t[1]], result.parent_of[t[2]]});
  }
  result.world.triangles = normalized(std::move(result.world.triangles), true);
  return result;
}

TEST(ApplyTest, TheTilesOfALevelShowTheImageOfTheMeshUnderOneMap) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const World world = make_world(c.mesh, 4, c.scattered);
    for (const std::uint32_t target : {3U, 12U, 40U, 1000U}) {
      SCOPED_TRACE(target);
      Contracted contracted = contract_pairs(world, target);
      World& above = contracted.world;
      // Locals as the tiles have them; what a boundary is before its neighbours are known may
      // shrink.
      above.own.assign(2, {});
      above.boundary_counts.assign(2, 0);
      for (std::uint32_t v = 0; v < above.positions.size(); ++v)
        above.own[above.tile_of[v]].push_back(v);
      for (std::uint32_t pair = 0; pair < 2; ++pair)
        above.boundary_counts[pair] = contracted.tiles[pair].tile.boundary_count;

      for (std::uint32_t pair = 0; pair < 2; ++pair) {
        SimplifiedTile work = contracted.tiles[pair].tile;
        std::vector<GhostRef> mapped;
        for (const auto& [foreign] : work.foreign) {
          const std::uint32_t v = contracted.parent_of[world.own[foreign.tile].at(foreign.index)];
          const auto first = static_cast<std::uint32_t>(above.own[above.tile_of[v]].front());
          mapped.push_back({above.tile_of[v], v - first});
        }
        BuildTile tile = resolve(std::move(work), mapped, true, 0);
        fill_all(tile, above);  // throws if a ghost is not in its tile's boundary
        EXPECT_EQ(above.global(tile.mesh, pair, tile.mesh.interior), above.interior(pair));
        EXPECT_EQ(above.global(tile.mesh, pair, tile.mesh.border), above.border(pair));
        for (std::uint32_t i = tile.mesh.own_count; i < tile.mesh.vertices.size(); ++i) {
          const std::uint32_t v = above.global(tile.mesh, pair, TileVertex{i});
          EXPECT_EQ(tile.mesh.vertices.positions[i], above.positions[v]);
        }
      }
    }
  }
}

TEST(ApplyTest, PutsTheBoundaryFirst) {
  const World world = make_world(tests::sphere(1200), 4, false);
  const BuildTile joined = join_pair(world, 0);
  const ContractedTile result = apply(joined, wild_contraction(joined, 150, 9));
  std::vector<bool> on_border(150);
  for (const TileTriangle& t : result.tile.border) {
    for (const TileVertex v : t) {
      if (raw(v) < 150)
        on_border[raw(v)] = true;
    }
  }
  EXPECT_GT(result.tile.boundary_count, 0U);
  EXPECT_LT(result.tile.boundary_count, 150U);
  for (std::uint32_t i = 0; i < 150; ++i)
    EXPECT_EQ(on_border[i], i < result.tile.boundary_count) << i;
}

TEST(ApplyTest, WeightsAreThoseOfTheVerticesUnderIt) {
  const World world = make_world(tests::torus(900), 4, true);
  const BuildTile joined = join_pair(world, 0);
  const ContractedTile result = apply(joined, wild_contraction(joined, 30, 5));
  std::vector<float> weights(30);
  for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i) {
    const float weight = joined.history.weights[i];
    weights[result.parent_map[i]] += weight;
  }
  EXPECT_EQ(result.tile.history.weights, weights);
}

TEST(ApplyTest, RepeatsGoMirrorImagesStay) {
  BuildTile tile;
  tile.mesh.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0.1F}};
  tile.mesh.own_count = 4;
  tile.history = {{1, 1, 1, 1}};
  tile.mesh.interior = {tile_triangle(0, 1, 2), tile_triangle(0, 1, 3), tile_triangle(0, 3, 1),
                        tile_triangle(0, 2, 3)};
  Contraction contraction;
  contraction.parent_of = {0, 1, 2, 2};
  contraction.representatives.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  contraction.deviation.around = {0, 0, 0};
  EXPECT_THAT(apply(tile, contraction).tile.interior,
              ElementsAre(tile_triangle(0, 1, 2), tile_triangle(0, 2, 1)));
}

TEST(ApplyTest, DeviationsFollowTheirRepresentatives) {
  const World world = make_world(tests::sphere(1200), 4, false);
  const BuildTile joined = join_pair(world, 0);
  Contraction contraction = wild_contraction(joined, 80, 5);
  contraction.deviation.interior = 7;
  contraction.deviation.lost = 8;
  contraction.deviation.mean_square = 9;
  const ContractedTile result = apply(joined, contraction);
  ASSERT_THAT(result.deviation.around, SizeIs(80));
  for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i) {
    EXPECT_EQ(result.deviation.around[result.parent_map[i]],
              contraction.deviation.around[contraction.parent_of[i]]);
  }
  EXPECT_EQ(result.deviation.interior, 7);
  EXPECT_EQ(result.deviation.lost, 8);
  EXPECT_EQ(result.deviation.mean_square, 9);
}

TEST(ApplyTest, AttributesFollowTheirRepresentatives) {
  const World world = make_world(tests::sphere(1200), 4, false);
  const BuildTile joined = join_pair(world, 0);
  Contraction contraction = wild_contraction(joined, 80, 5);
  contraction.representatives.channels = 1;
  for (std::uint32_t r = 0; r < 80; ++r)
    contraction.representatives.attributes.push_back(static_cast<float>(r));
  const ContractedTile result = apply(joined, contraction);
  ASSERT_THAT(result.tile.vertices.attributes, SizeIs(80));
  for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i) {
    EXPECT_EQ(result.tile.vertices.attributes[result.parent_map[i]],
              static_cast<float>(contraction.parent_of[i]));
  }
}

// ---- keep ----------------------------------------------------------------------------------

TEST(KeepTest, ChangesNothing) {
  const World world = make_world(tests::sphere(1200, 0.02F), 4, false);
  const BuildTile tile = build_tile(world, 2);
  const ContractedTile kept = keep(tile);
  EXPECT_EQ(kept.tile.vertices.positions,
            std::vector<Vec3f>(tile.mesh.vertices.positions.begin(),
                               tile.mesh.vertices.positions.begin() + tile.mesh.own_count));
  EXPECT_EQ(kept.tile.interior, tile.mesh.interior);
  EXPECT_EQ(kept.tile.border, tile.mesh.border);
  EXPECT_EQ(refs_of(kept.tile.foreign), tile.mesh.ghosts);
  EXPECT_EQ(kept.tile.boundary_count, tile.mesh.boundary_count);
  EXPECT_EQ(kept.tile.history.weights, tile.history.weights);
  EXPECT_EQ(kept.deviation.around, std::vector<float>(tile.mesh.own_count));
  EXPECT_EQ(kept.deviation.interior, 0);
  for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i)
    ASSERT_EQ(kept.parent_map[i], i);
}

}  // namespace
}  // namespace meshhier::cluster_simplify

#include "cluster_simplify/seam_strip.h"

#include "cluster_simplify/contraction.h"
#include "cluster_simplify/motion.h"
#include "tests/cluster_simplify/sampling.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

using tests::Corners;
using tests::distance_to_surface;
using tests::farthest_sample;
using tests::samples_of;
using tests::surface_of;

constexpr int kSteps = 4;
constexpr double kSlack = 1e-5;  // rounding of single precision, as meshes are about 2 in size

using ContractTile = std::function<Contraction(const BuildTile&, std::uint32_t tile)>;

/// A mesh cut into tiles along x, each contracted on its own, and the level they make together.
class Level {
 public:
  Level(tests::TestMesh mesh, std::uint32_t tile_count, const ContractTile& contract_tile)
      : mesh_(std::move(mesh)), tile_of_(mesh_.positions.size()), index_(mesh_.positions.size()) {
    assign(tile_count);
    for (std::uint32_t t = 0; t < tile_count; ++t) {
      const BuildTile tile = joined(t, tile_count);
      ContractedTile contracted = apply(tile, contract_tile(tile, t));
      seam_strips_.push_back({t, make_seam_strip(tile, contracted)});
      contracted_.push_back(std::move(contracted));
    }
    for (std::uint32_t t = 0; t < tile_count; ++t)
      draw(t);
  }

  std::uint32_t tile_count() const { return static_cast<std::uint32_t>(seam_strips_.size()); }
  const TileMesh& drawn(std::uint32_t tile) const { return drawn_[tile]; }
  const SeamStrip& seam_strip(std::uint32_t tile) const { return seam_strips_[tile].seam_strip; }
  std::vector<Corners> before() const { return surface_of(mesh_); }
  std::vector<Corners> after() const {
    std::vector<Corners> all;
    for (const TileMesh& mesh : drawn_) {
      const std::vector<Corners> surface = surface_of(mesh);
      all.insert(all.end(), surface.begin(), surface.end());
    }
    return all;
  }

  double seam(std::uint32_t tile) const {
    const std::vector<GhostRef> foreign = mapped(seam_strip(tile).foreign);
    return seam_gap({drawn_[tile], seam_strips_[tile], foreign,
                     [&](std::uint32_t neighbour) { return seam_strip(neighbour); }});
  }

  /// As the stage simplify sums it up.
  double certain(std::uint32_t tile) const {
    const double gap = seam(tile);
    const double lost = seam_strip(tile).lost > 0 ? double{seam_strip(tile).lost} + gap : 0;
    return std::max({double{seam_strip(tile).interior_deviation}, gap, lost});
  }

 private:
  void assign(std::uint32_t tile_count) {
    std::vector<std::uint32_t> order(mesh_.positions.size());
    for (std::uint32_t v = 0; v < order.size(); ++v)
      order[v] = v;
    std::ranges::stable_sort(order, {}, [&](std::uint32_t v) { return mesh_.positions[v].x; });
    own_.resize(tile_count);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const auto tile = static_cast<std::uint32_t>(std::uint64_t{i} * tile_count / order.size());
      tile_of_[order[i]] = tile;
      own_[tile].push_back(order[i]);
    }
    for (std::vector<std::uint32_t>& own : own_) {
      std::ranges::sort(own);
      for (std::uint32_t i = 0; i < own.size(); ++i)
        index_[own[i]] = i;
    }
  }

  BuildTile joined(std::uint32_t t, std::uint32_t) const {
    std::vector<std::pair<GhostRef, std::uint32_t>> ghosts;
    const auto is_here = [&](const tests::MeshTriangle& triangle) {
      return std::ranges::any_of(triangle, [&](std::uint32_t v) { return tile_of_[v] == t; });
    };
    for (const tests::MeshTriangle& triangle : mesh_.triangles) {
      for (const std::uint32_t v : triangle) {
        if (is_here(triangle) && tile_of_[v] != t)
          ghosts.push_back({{tile_of_[v], index_[v]}, v});
      }
    }
    std::ranges::sort(ghosts);
    ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
    BuildTile tile;
    TileMesh& mesh = tile.mesh;
    std::vector<std::uint32_t> place(mesh_.positions.size());
    mesh.own_count = mesh.boundary_count = tests::count_of(own_[t]);
    tile.history.weights.assign(mesh.own_count, 1);
    for (const std::uint32_t v : own_[t]) {
      place[v] = index_[v];
      mesh.vertices.positions.push_back(mesh_.positions[v]);
    }
    for (const auto& [ref, v] : ghosts) {
      place[v] = tests::count_of(mesh.vertices.positions);
      mesh.vertices.positions.push_back(mesh_.positions[v]);
      mesh.ghosts.push_back(ref);
    }
    for (const tests::MeshTriangle& triangle : mesh_.triangles) {
      if (!is_here(triangle))
        continue;
      const bool inside =
          std::ranges::all_of(triangle, [&](std::uint32_t v) { return tile_of_[v] == t; });
      (inside ? mesh.interior : mesh.border)
          .push_back({TileVertex{place[triangle[0]]}, TileVertex{place[triangle[1]]},
                      TileVertex{place[triangle[2]]}});
    }
    normalize_triangles(mesh.interior, true);
    normalize_triangles(mesh.border, true);
    return tile;
  }

  std::vector<GhostRef> mapped(const std::vector<FinerGhost>& foreign) const {
    std::vector<GhostRef> result;
    for (const auto& [ref] : foreign)
      result.push_back({ref.tile, contracted_[ref.tile].parent_map[ref.index]});
    return result;
  }

  void draw(std::uint32_t t) {
    const SimplifiedTile& work = contracted_[t].tile;
    BuildTile tile = resolve(work, mapped(work.foreign), true, 0);
    for (std::uint32_t other = 0; other < contracted_.size(); ++other) {
      const SimplifiedTile& neighbour = contracted_[other].tile;
      Boundary boundary;
      boundary.vertices.positions.assign(
          neighbour.vertices.positions.begin(),
          neighbour.vertices.positions.begin() + neighbour.boundary_count);
      const bool is_named = std::ranges::any_of(
          tile.mesh.ghosts, [&](const GhostRef& ghost) { return ghost.tile == other; });
      if (is_named)
        fill_ghosts(tile, other, boundary);
    }
    drawn_.push_back(tile.mesh);
  }

  tests::TestMesh mesh_;
  std::vector<std::uint32_t> tile_of_, index_;
  std::vector<std::vector<std::uint32_t>> own_;
  std::vector<ContractedTile> contracted_;
  std::vector<SeamStripOf> seam_strips_;
  std::vector<TileMesh> drawn_;
};

ContractTile by(const ContractionOptions& options, double part) {
  return [=](const BuildTile& tile, std::uint32_t) {
    const auto target = static_cast<std::uint32_t>(part * static_cast<double>(tile.mesh.own_count));
    return contract(tile, std::max(1U, target), {}, options);
  };
}

Corners corners_of(const TileMesh& mesh, const TileTriangle& t) {
  const auto at = [&](TileVertex v) { return to_double(mesh.vertices.positions[raw(v)]); };
  return {at(t[0]), at(t[1]), at(t[2])};
}

/// Returns whether no tile before this one draws the border triangle.
bool is_lowest(const TileMesh& mesh, std::uint32_t tile, const TileTriangle& t) {
  return std::ranges::all_of(
      t, [&](TileVertex v) { return mesh.is_own(v) || mesh.ghost(v).tile > tile; });
}

/// Expects the drawn surface to be as near to the one before as its tile says, and that one to the
/// drawn one as all tiles say.
void expect_step_holds(const Level& level) {
  const std::vector<Corners> before = level.before();
  const std::vector<Corners> after = level.after();
  double largest = 0;
  for (std::uint32_t tile = 0; tile < level.tile_count(); ++tile) {
    const double certain = level.certain(tile);
    largest = std::max(largest, certain);
    const TileMesh& mesh = level.drawn(tile);
    for (const TileTriangle& t : mesh.interior) {
      for (const Vec3d p : samples_of(corners_of(mesh, t), kSteps))
        ASSERT_LE(distance_to_surface(p, before), certain + kSlack) << "tile " << tile;
    }
    for (const TileTriangle& t : mesh.border) {
      if (!is_lowest(mesh, tile, t))
        continue;
      for (const Vec3d p : samples_of(corners_of(mesh, t), kSteps))
        ASSERT_LE(distance_to_surface(p, before), certain + kSlack) << "seam of tile " << tile;
    }
  }
  for (const Corners& corners : before) {
    for (const Vec3d p : samples_of(corners, kSteps))
      ASSERT_LE(distance_to_surface(p, after), largest + kSlack);
  }
}

std::vector<tests::NamedMesh> meshes() {
  return {{"sphere", tests::sphere(250, 0.03F)},
          {"torus", tests::torus(250, 0.02F)},
          {"shells", tests::nested_shells(250)},
          {"grid", tests::open_grid(10, 10, 0.2F)},
          {"moebius", tests::moebius(200)},
          {"non-manifold", tests::non_manifold(200, 0.03F)},
          {"soup", tests::soup(60)},
          {"tangle", tests::tangle(40, 100, 2)},
          {"mirrored", tests::mirrored(tests::sphere(100, 0.02F))}};
}

TEST(SeamGapTest, SLOW_StepsOfNeighbouringTilesHoldBothWays) {
  for (const auto& [name, mesh] : meshes()) {
    for (const ContractionOptions& options :
         {ContractionOptions{Method::edge_collapse, {}, {}},
          ContractionOptions{Method::half_edge, {}, HalfEdgeCost::quadric},
          ContractionOptions{Method::cluster, Representative::mean, {}}}) {
      for (const std::uint32_t tiles : {2U, 3U, 5U}) {
        for (const double part : {0.5, 0.15}) {
          SCOPED_TRACE(name + ", method " + std::to_string(static_cast<int>(options.method)) +
                       ", " + std::to_string(tiles) + " tiles, " + std::to_string(part));
          expect_step_holds(Level(mesh, tiles, by(options, part)));
          if (HasFailure())
            return;
        }
      }
    }
  }
}

TEST(SeamGapTest, IsNotLooseOnASmoothSurface) {
  for (const auto& mesh : {tests::sphere(600), tests::torus(600)}) {
    const Level level(mesh, 3, by({}, 0.4));
    const double sampled = std::max(farthest_sample(level.before(), level.after(), kSteps),
                                    farthest_sample(level.after(), level.before(), kSteps));
    for (std::uint32_t tile = 0; tile < level.tile_count(); ++tile)
      EXPECT_LE(level.certain(tile), 8 * sampled);
  }
}

Contraction identity(const BuildTile& tile) {
  Contraction same;
  for (std::uint32_t v = 0; v < tile.mesh.own_count; ++v)
    same.parent_of.push_back(v);
  same.representatives.append(tile.mesh.vertices, 0, tile.mesh.own_count);
  same.deviation.around.resize(tile.mesh.own_count);
  return same;
}

TEST(SeamGapTest, WhereNothingMovedThereIsNone) {
  const Level level(tests::sphere(300), 3,
                    [](const BuildTile& tile, std::uint32_t) { return identity(tile); });
  for (std::uint32_t tile = 0; tile < 3; ++tile)
    EXPECT_EQ(level.seam(tile), 0);
}

TEST(SeamGapTest, ANeighbourThatWentUpTakesTheSeamWithIt) {
  // The second tile goes up one; the first, which says nothing moved, has the seam.
  const Level level(tests::open_grid(7, 4), 2, [](const BuildTile& tile, std::uint32_t index) {
    Contraction moved = identity(tile);
    for (Vec3f& p : moved.representatives.positions)
      p.z += index == 1 ? 1.0F : 0.0F;
    for (float& deviation : moved.deviation.around)
      deviation = index == 1 ? 1.0F : 0.0F;
    moved.deviation.interior = index == 1 ? 1.0F : 0.0F;
    return moved;
  });
  EXPECT_NEAR(level.seam(0), 1, 0.3);
  EXPECT_GE(level.seam(0), 1 / std::sqrt(2.0));
  expect_step_holds(level);
}

TEST(SeamGapTest, WithoutABorderThereIsNone) {
  tests::TestMesh mesh = tests::sphere(100);
  tests::append(mesh, tests::sphere(100), {10, 0, 0});
  const Level level(mesh, 2, by({}, 0.4));
  EXPECT_EQ(level.seam(0), 0);
  EXPECT_EQ(level.seam(1), 0);
  expect_step_holds(level);
}

/// All border triangles collapse: to what is left it is as far as their vertices went.
TEST(SeamGapTest, StrandedBorderTrianglesAreAsFarAsWhatIsLeft) {
  tests::TestMesh mesh{{{0, 0, 0},
                        {0, 1, 0},
                        {1, 0, 0},
                        {1, 1, 0},
                        {-5, 0, 0},
                        {-5, 1, 0},
                        {-6, 0, 0},
                        {2, 0, 0},
                        {2, 1, 0},
                        {2, 2, 0}},
                       {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}}};
  const auto join_all_near = [](const BuildTile& tile, std::uint32_t index) {
    Contraction joined = identity(tile);
    if (index == 0) {  // own vertices by number: 0, 1 at the seam, then 4, 5, 6
      joined.parent_of = {0, 0, 1, 2, 3};
      joined.representatives.positions.erase(joined.representatives.positions.begin() + 1);
    } else {
      joined.parent_of = {0, 0};
      joined.representatives.positions.pop_back();
    }
    const auto count = joined.representatives.size();
    joined.deviation.around.assign(count, 0);
    joined.deviation.around[0] = 1;
    return joined;
  };
  const Level level(mesh, 2, [&](const BuildTile& tile, std::uint32_t) {
    return join_all_near(tile, tile.mesh.own_count == 2 ? 1U : 0U);
  });
  ASSERT_TRUE(level.drawn(0).border.empty());
  ASSERT_EQ(level.drawn(0).interior.size(), 1U);
  EXPECT_GE(std::max(level.seam(0), level.seam(1)), 5);
}

/// With ten times as many vertices of no triangle, inside, last.
tests::TestMesh with_loose_vertices(tests::TestMesh mesh) {
  const auto count = mesh.positions.size();
  for (std::uint64_t i = 0; i < 10 * count; ++i) {
    mesh.positions.push_back({0.2F * tests::hash_noise(i, 1), 0.2F * tests::hash_noise(i, 2),
                              0.2F * tests::hash_noise(i, 3)});
  }
  return mesh;
}

double mean_square(const BuildTile& joined, const Contraction& contraction) {
  return make_seam_strip(joined, apply(joined, contraction)).mean_square;
}

TEST(SeamStripTest, LooseVerticesDoNotDiluteTheErrorOfCollapses) {
  const BuildTile plain = tests::tile_of(tests::sphere(600, 0.03F));
  const BuildTile loose = tests::tile_of(with_loose_vertices(tests::sphere(600, 0.03F)));
  for (const ContractionOptions& options :
       {ContractionOptions{Method::edge_collapse, {}, {}},
        ContractionOptions{Method::half_edge, {}, HalfEdgeCost::quadric},
        ContractionOptions{Method::half_edge, {}, HalfEdgeCost::melax}}) {
    const double expected = mean_square(plain, contract(plain, 150, {}, options));
    EXPECT_GT(expected, 0);
    EXPECT_EQ(mean_square(loose, contract(loose, 150, {}, options)), expected);
  }
}

TEST(SeamStripTest, LooseVerticesDoNotDiluteTheErrorOfClusters) {
  const BuildTile plain = tests::tile_of(tests::sphere(600, 0.03F));
  const BuildTile loose = tests::tile_of(with_loose_vertices(tests::sphere(600, 0.03F)));
  Contraction contraction = contract(plain, 150, {}, {Method::cluster, Representative::mean, {}});
  const double expected = mean_square(plain, contraction);
  EXPECT_GT(expected, 0);
  contraction.parent_of.resize(loose.mesh.own_count, 0);
  contraction.deviation = motion_of(loose, contraction);
  EXPECT_EQ(mean_square(loose, contraction), expected);
}

TEST(SeamStripTest, ShowsTheSeamAndWhatIsBesideIt) {
  const BuildTile joined = tests::part_of(tests::sphere(600), 0.1F);
  const Contraction contraction = contract(joined, 60, {}, {});
  const ContractedTile contracted = apply(joined, contraction);
  const SeamStrip seam_strip = make_seam_strip(joined, contracted);
  const SimplifiedTile& tile = contracted.tile;
  EXPECT_EQ(seam_strip.boundary_count, tile.boundary_count);
  EXPECT_EQ(seam_strip.foreign, tile.foreign);
  EXPECT_EQ(seam_strip.interior_deviation, contracted.deviation.interior);
  EXPECT_EQ(seam_strip.lost, contracted.deviation.lost);
  EXPECT_EQ(seam_strip.mean_square, contracted.deviation.mean_square);
  ASSERT_EQ(seam_strip.deviations.size(), seam_strip.own_count);
  ASSERT_EQ(seam_strip.positions.size(), seam_strip.own_count + seam_strip.foreign.size());
  for (std::uint32_t v = 0; v < seam_strip.boundary_count; ++v) {
    EXPECT_EQ(seam_strip.positions[v], tile.vertices.positions[v]);
    EXPECT_EQ(seam_strip.deviations[v], contracted.deviation.around[v]);
  }
  ASSERT_EQ(seam_strip.border.size(), tile.border.size());
  for (std::size_t i = 0; i < seam_strip.border.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = raw(tile.border[i][k]);
      const Vec3f there =
          v < tile.vertices.size()
              ? tile.vertices.positions[v]
              : joined.mesh.vertices.positions[joined.mesh.own_count +
                                               tile.foreign[v - tile.vertices.size()].ref.index];
      EXPECT_EQ(seam_strip.positions[raw(seam_strip.border[i][k])], there);
    }
  }
  const auto at_boundary = std::ranges::count_if(tile.interior, [&](const TileTriangle& t) {
    return std::ranges::any_of(t, [&](TileVertex v) { return raw(v) < tile.boundary_count; });
  });
  EXPECT_EQ(seam_strip.interior.size(), static_cast<std::size_t>(at_boundary));
  EXPECT_LT(seam_strip.interior.size(), tile.interior.size());
}

}  // namespace
}  // namespace meshhier::cluster_simplify

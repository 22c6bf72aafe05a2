// Wedges across seams: whatever a tile calls a vertex, it stays the same one.
#include "cluster_simplify/seam_wedges.h"

#include "base/error.h"
#include "cluster_simplify/seams.h"
#include "cluster_simplify/wedges.h"
#include "tests/cluster_simplify/wedge_tiles.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
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

/// A vertex by its place, and its wedge there.
struct Corner {
  std::uint32_t place = 0;
  std::uint32_t wedge = 0;
  friend auto operator<=>(const Corner&, const Corner&) = default;
};
using TriangleCorners = std::array<Corner, 3>;

constexpr std::uint32_t kTiles = 4;
constexpr std::uint32_t kMostWedges = 16;

/// No two vertices have the same.
float attribute_of(const Corner& vertex) {
  return static_cast<float>(vertex.place * kMostWedges + vertex.wedge);
}

TriangleCorners smallest_first(TriangleCorners t) {
  std::ranges::rotate(t, std::ranges::min_element(t));
  return t;
}

bool is_flat(const TriangleCorners& t) {
  return t[0].place == t[1].place || t[1].place == t[2].place || t[2].place == t[0].place;
}

/// A mesh whose every third place has one to three copies, cut into tiles of one level: what tiles
/// must agree with, as numbers of the whole mesh.
struct WedgeWorld {
  std::vector<Vec3f> positions;
  std::vector<TriangleCorners> triangles;
  std::vector<std::uint32_t> tile_of, local_of;
  std::vector<std::vector<std::uint32_t>> own;  ///< tile, local -> place
  std::vector<std::uint32_t> boundary_counts;

  static std::uint32_t copies_at(std::uint32_t place) {
    return place % 3 == 0 ? 1 + place / 3 % 3 : 0;
  }
  bool touches(const TriangleCorners& t, std::uint32_t tile) const {
    return std::ranges::any_of(t, [&](const Corner& c) { return tile_of[c.place] == tile; });
  }
  bool is_inside(const TriangleCorners& t) const {
    return std::ranges::all_of(
        t, [&](const Corner& c) { return tile_of[c.place] == tile_of[t[0].place]; });
  }

  void number() {
    std::vector<bool> on_boundary(positions.size());
    for (const TriangleCorners& t : triangles) {
      for (const Corner& corner : t)
        on_boundary[corner.place] = on_boundary[corner.place] || !is_inside(t);
    }
    own.resize(kTiles);
    boundary_counts.resize(kTiles);
    local_of.resize(positions.size());
    for (const bool boundary : {true, false}) {
      for (std::uint32_t place = 0; place < positions.size(); ++place) {
        if (on_boundary[place] != boundary)
          continue;
        std::vector<std::uint32_t>& tile = own[tile_of[place]];
        local_of[place] = static_cast<std::uint32_t>(tile.size());
        tile.push_back(place);
        boundary_counts[tile_of[place]] += boundary ? 1 : 0;
      }
    }
  }

  /// Triangles with a corner in a tile of `tiles`, all of them or not; flat ones, too, or not.
  std::vector<TriangleCorners> select(const std::set<std::uint32_t>& tiles, bool inside,
                                      bool flat) const {
    std::vector<TriangleCorners> selected;
    for (const TriangleCorners& t : triangles) {
      const auto corners = std::ranges::count_if(
          t, [&](const Corner& c) { return tiles.contains(tile_of[c.place]); });
      if (corners > 0 && (corners == 3) == inside && (flat || !cluster_simplify::is_flat(t)))
        selected.push_back(smallest_first(t));
    }
    std::ranges::sort(selected);
    return selected;
  }
};

WedgeWorld make_world(const tests::TestMesh& mesh, bool scattered) {
  WedgeWorld world;
  world.positions = mesh.positions;
  for (std::uint32_t place = 0; place < mesh.positions.size(); ++place) {
    const float where = scattered ? tests::hash_noise(place, 77) : mesh.positions[place].x / 1.5F;
    world.tile_of.push_back(
        static_cast<std::uint32_t>(std::clamp((where + 1) / 2, 0.0F, 0.999F) * kTiles));
  }
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    TriangleCorners& corners = world.triangles.emplace_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t place = mesh.triangles[i][k];
      corners[k] = {place, i % 4 == 0 ? 0 : (i + k) % (WedgeWorld::copies_at(place) + 1)};
    }
    const Corner first = corners[0];
    if (i % 50 == 0 && WedgeWorld::copies_at(first.place) > 0)  // as inputs have them
      world.triangles.push_back({Corner{first.place, 0}, {first.place, 1}, corners[1]});
  }
  world.number();
  return world;
}

/// Returns the boundary that a tile shows: its own places, [0, count) of them, and their copies.
Boundary shown(const WedgeWorld& world, std::uint32_t tile, std::uint32_t count) {
  Boundary boundary;
  boundary.vertices.channels = boundary.copies.vertices.channels = 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t place = world.own[tile][i];
    for (std::uint32_t wedge = 0; wedge <= WedgeWorld::copies_at(place); ++wedge) {
      const float attribute = attribute_of({place, wedge});
      (wedge == 0 ? boundary.vertices : boundary.copies.vertices)
          .append(world.positions[place], std::span(&attribute, 1));
      if (wedge > 0)
        boundary.copies.places.push_back(i);
    }
  }
  return boundary;
}

/// The tile as its own stage would leave it: foreign corners named as in their tiles.
SimplifiedTile work_tile(const WedgeWorld& world, std::uint32_t tile) {
  SimplifiedTile work;
  const auto own_count = static_cast<std::uint32_t>(world.own[tile].size());
  Boundary all = shown(world, tile, own_count);
  work.vertices = std::move(all.vertices);
  work.copies = std::move(all.copies);
  work.history.weights.assign(own_count, 1);
  work.boundary_count = world.boundary_counts[tile];
  std::set<GhostRef> refs;
  const std::vector<TriangleCorners> inside = world.select({tile}, true, true);
  const std::vector<TriangleCorners> across = world.select({tile}, false, true);
  for (const TriangleCorners& t : across) {
    for (const Corner& corner : t) {
      if (world.tile_of[corner.place] != tile)
        refs.insert({world.tile_of[corner.place], world.local_of[corner.place]});
    }
  }
  for (const GhostRef& ref : refs)
    work.foreign.push_back({ref});
  const auto local = [&](std::uint32_t place) {
    const GhostRef ref{world.tile_of[place], world.local_of[place]};
    return static_cast<TileVertex>(
        ref.tile == tile
            ? ref.index
            : own_count + static_cast<std::uint32_t>(std::distance(refs.begin(), refs.find(ref))));
  };
  const auto add = [&](const TriangleCorners& t, std::vector<TileTriangle>& triangles,
                       std::vector<CornerWedges>& wedges) {
    triangles.push_back({local(t[0].place), local(t[1].place), local(t[2].place)});
    wedges.push_back({t[0].wedge, t[1].wedge, t[2].wedge});
  };
  for (const TriangleCorners& t : inside)
    add(t, work.interior, work.interior_wedges);
  for (const TriangleCorners& t : across)
    add(t, work.border, work.border_wedges);
  normalize_triangles(work.interior, work.interior_wedges, false);
  return work;
}

BuildTile build_tile(const WedgeWorld& world, std::uint32_t tile) {
  SimplifiedTile work = work_tile(world, tile);
  std::vector<GhostRef> same;
  for (const FinerGhost& corner : work.foreign)
    same.push_back(corner.ref);
  BuildTile built = resolve(std::move(work), same, false, 0);
  for (std::uint32_t neighbour = 0; neighbour < kTiles; ++neighbour) {
    if (neighbour != tile)
      fill_ghosts(built, neighbour, shown(world, neighbour, world.boundary_counts[neighbour]));
  }
  return built;
}

BuildTile join_pair(const WedgeWorld& world, std::uint32_t pair) {
  return join(build_tile(world, 2 * pair), 2 * pair, build_tile(world, 2 * pair + 1), 2 * pair + 1);
}

/// A tile, and the places of the world that its own ones are.
struct Placed {
  const WedgeWorld& world;
  const TileMesh& mesh;
  std::vector<std::uint32_t> own;

  std::uint32_t place_of(TileVertex v) const {
    return mesh.is_own(v) ? own.at(raw(v)) : world.own[mesh.ghost(v).tile].at(mesh.ghost(v).index);
  }
  /// Triangles as the world has them, told by the attributes at their corners.
  std::vector<TriangleCorners> triangles(std::span<const TileTriangle> places,
                                         std::span<const CornerWedges> wedges) const {
    EXPECT_TRUE(wedges.empty() || wedges.size() == places.size());
    std::vector<TriangleCorners> result;
    for (std::size_t i = 0; i < places.size(); ++i) {
      TriangleCorners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t wedge = wedges.empty() ? 0 : wedges[i][k];
        const auto id =
            static_cast<std::uint32_t>(tests::wedge_of(mesh, raw(places[i][k]), wedge)[0]);
        corners[k] = {id / kMostWedges, id % kMostWedges};
        EXPECT_EQ(corners[k].place, place_of(places[i][k])) << "a wedge of another place";
      }
      result.push_back(smallest_first(corners));
    }
    std::ranges::sort(result);
    return result;
  }
};

Placed placed_pair(const WedgeWorld& world, const TileMesh& mesh, std::uint32_t pair) {
  Placed placed{world, mesh, world.own[2 * pair]};
  const std::vector<std::uint32_t>& second = world.own[2 * pair + 1];
  placed.own.insert(placed.own.end(), second.begin(), second.end());
  return placed;
}

/// All copies of own places; of ghosts those that border triangles name, flat ones included.
/// `tiles`: which the tile stands for.
void expect_copies(const Placed& placed, const std::set<std::uint32_t>& tiles) {
  const TileMesh& mesh = placed.mesh;
  std::set<Corner> expected;  // those of the world
  for (const std::uint32_t place : placed.own) {
    for (std::uint32_t k = 1; k <= WedgeWorld::copies_at(place); ++k)
      expected.insert({place, k});
  }
  for (const TriangleCorners& t : placed.world.select(tiles, false, true)) {
    for (const Corner& corner : t) {
      if (corner.wedge > 0)
        expected.insert(corner);
    }
  }
  std::vector<Corner> found;
  const std::size_t own_copies = mesh.copies.size() - mesh.ghost_wedges.size();
  for (std::size_t i = 0; i < mesh.copies.size(); ++i) {
    const std::uint32_t place = mesh.copies.places[i];
    const std::uint32_t wedge =
        i < own_copies ? static_cast<std::uint32_t>(i - mesh.copies.first_of(place)) + 1
                       : mesh.ghost_wedges[i - own_copies];
    found.push_back({placed.place_of(TileVertex{place}), wedge});
    EXPECT_EQ(mesh.copies.vertices.attributes_of(i)[0], attribute_of(found.back()));
    EXPECT_EQ(mesh.copies.vertices.positions[i], placed.world.positions[found.back().place]);
    if (i > 0 && i != own_copies) {
      EXPECT_LE(mesh.copies.places[i - 1], place);
    }
  }
  std::ranges::sort(found);
  EXPECT_EQ(found, std::vector<Corner>(expected.begin(), expected.end()));
}

/// That ghosts' wedges get the numbers that their tiles have given them.
void expect_named(const TileMesh& mesh) {
  std::vector<CornerWedges> owners = mesh.border_wedges;
  name_ghost_wedges(mesh, owners);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float attribute =
          tests::wedge_of(mesh, raw(mesh.border[i][k]), mesh.border_wedges[i][k])[0];
      EXPECT_EQ(owners[i][k], static_cast<std::uint32_t>(attribute) % kMostWedges);
    }
  }
}

std::vector<std::pair<std::string, WedgeWorld>> worlds() {
  return {{"sphere", make_world(tests::sphere(1200, 0.02F), false)},
          {"sphere, scattered tiles", make_world(tests::sphere(600), true)},
          {"torus", make_world(tests::torus(900), false)},
          {"non-manifold", make_world(tests::non_manifold(600), false)},
          {"soup", make_world(tests::soup(200), true)},
          {"points", make_world(tests::points(100), false)}};
}

TEST(SeamWedgesTest, AResolvedTileNamesItsNeighboursVertices) {
  for (const auto& [name, world] : worlds()) {
    SCOPED_TRACE(name);
    for (std::uint32_t tile = 0; tile < kTiles; ++tile) {
      const BuildTile built = build_tile(world, tile);
      const Placed placed{world, built.mesh, world.own[tile]};
      const TileMesh& mesh = built.mesh;
      EXPECT_EQ(placed.triangles(mesh.interior, mesh.interior_wedges),
                world.select({tile}, true, true));
      EXPECT_EQ(placed.triangles(mesh.border, mesh.border_wedges),
                world.select({tile}, false, true));
      expect_copies(placed, {tile});
      expect_named(mesh);
    }
  }
}

TEST(SeamWedgesTest, ATileWithoutCopiesNamesNone) {
  WedgeWorld world = make_world(tests::sphere(600), false);
  for (TriangleCorners& t : world.triangles) {
    for (Corner& corner : t)
      corner.wedge = 0;
  }
  SimplifiedTile work = work_tile(world, 1);
  work.copies = {};
  std::vector<GhostRef> same;
  for (const FinerGhost& corner : work.foreign)
    same.push_back(corner.ref);
  const BuildTile built = resolve(std::move(work), same, false, 0);
  EXPECT_TRUE(built.mesh.copies.empty());
  EXPECT_THAT(built.mesh.interior_wedges, IsEmpty());
  EXPECT_THAT(built.mesh.border_wedges, IsEmpty());
}

TEST(SeamWedgesTest, AWedgeThatTheNeighbourDoesNotHaveIsADefect) {
  const WedgeWorld world = make_world(tests::sphere(600), false);
  SimplifiedTile work = work_tile(world, 0);
  std::vector<GhostRef> same;
  for (const FinerGhost& corner : work.foreign)
    same.push_back(corner.ref);
  BuildTile built = resolve(std::move(work), same, false, 0);
  Boundary boundary = shown(world, 1, world.boundary_counts[1]);
  ASSERT_FALSE(built.mesh.ghost_wedges.empty());
  boundary.copies = {};
  EXPECT_THROW(fill_ghosts(built, 1, boundary), Error);
}

TEST(SeamWedgesTest, AJoinedTileNamesTheSameVerticesAsBoth) {
  for (const auto& [name, world] : worlds()) {
    SCOPED_TRACE(name);
    for (std::uint32_t pair = 0; pair < 2; ++pair) {
      const BuildTile joined = join_pair(world, pair);
      const TileMesh& mesh = joined.mesh;
      const Placed placed = placed_pair(world, mesh, pair);
      EXPECT_EQ(placed.triangles(mesh.interior, mesh.interior_wedges),
                world.select({2 * pair, 2 * pair + 1}, true, false));
      EXPECT_EQ(placed.triangles(mesh.border, mesh.border_wedges),
                world.select({2 * pair, 2 * pair + 1}, false, false));
      expect_copies(placed, {2 * pair, 2 * pair + 1});
      expect_named(mesh);
    }
  }
}

// ---- contraction ---------------------------------------------------------------------------

/// A corner of a contracted tile: its own place, or that of another tile, and its wedge there.
using NewCorner = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  ///< tile, place, wedge
using NewTriangle = std::array<NewCorner, 3>;
constexpr std::uint32_t kOwn = 0;  ///< own ones first

std::pair<std::uint32_t, std::uint32_t> place_of(const NewCorner& c) {
  return {std::get<0>(c), std::get<1>(c)};
}

/// Ascending, without flat ones; of those at equal places the first.
/// Equal ones once; those of equal places once, too, if `of_places`.
std::vector<NewTriangle> normalized(std::vector<NewTriangle> triangles, bool of_places) {
  std::erase_if(triangles, [](const NewTriangle& t) {
    return place_of(t[0]) == place_of(t[1]) || place_of(t[1]) == place_of(t[2]) ||
           place_of(t[2]) == place_of(t[0]);
  });
  for (NewTriangle& t : triangles)
    std::ranges::rotate(t, std::ranges::min_element(t));
  const auto by_place = [](const NewTriangle& t) {
    return std::array{place_of(t[0]), place_of(t[1]), place_of(t[2])};
  };
  std::ranges::sort(triangles, {}, [&](const NewTriangle& t) { return std::pair(by_place(t), t); });
  const auto are_equal = [&](const NewTriangle& a, const NewTriangle& b) {
    return of_places ? by_place(a) == by_place(b) : a == b;
  };
  triangles.erase(std::unique(triangles.begin(), triangles.end(), are_equal), triangles.end());
  return triangles;
}

/// Returns the triangles of a tile after a contraction; tiles count from 1.
std::vector<NewTriangle> triangles_of(const SimplifiedTile& tile,
                                      std::span<const TileTriangle> triangles,
                                      std::span<const CornerWedges> wedges) {
  EXPECT_EQ(triangles.size(), wedges.size());
  std::vector<NewTriangle> result;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    NewTriangle& t = result.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = raw(triangles[i][k]);
      const auto own_count = static_cast<std::uint32_t>(tile.vertices.size());
      if (v < own_count) {
        t[k] = {kOwn, v, wedges[i][k]};
      } else {
        const GhostRef& ref = tile.foreign.at(v - own_count).ref;
        t[k] = {1 + ref.tile, ref.index, wedges[i][k]};
      }
    }
  }
  return result;
}

/// Returns the images of a joined tile's triangles by the maps of its contraction.
std::vector<NewTriangle> images(const Placed& joined, const ContractedTile& contracted,
                                std::span<const TileTriangle> triangles,
                                std::span<const CornerWedges> wedges, bool of_places) {
  std::vector<NewTriangle> result;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    NewTriangle& t = result.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const TileVertex v = triangles[i][k];
      const auto id = static_cast<std::uint32_t>(
          tests::wedge_of(joined.mesh, raw(v), wedges[i][k])[0]);  // tells the wedge in its tile
      if (joined.mesh.is_own(v)) {
        t[k] = {kOwn, contracted.parent_map[raw(v)],
                contracted.wedge_map(raw(v), id % kMostWedges)};
      } else {
        t[k] = {1 + joined.mesh.ghost(v).tile, joined.mesh.ghost(v).index, id % kMostWedges};
      }
    }
  }
  return normalized(result, of_places);
}

/// A contraction that no method would choose, to `count` places with up to three wedges.
std::pair<Contraction, ContractedWedges> wild_contraction(const TileMesh& joined,
                                                          std::uint32_t count) {
  std::pair<Contraction, ContractedWedges> result;
  auto& [contraction, wedges] = result;
  const auto wedges_at = [](std::uint32_t place) { return 1 + place % 3; };
  contraction.representatives.channels = wedges.copies.vertices.channels = 1;
  for (std::uint32_t place = 0; place < count; ++place) {
    const Vec3f position{tests::hash_noise(place, 1), tests::hash_noise(place, 2), 0};
    const float unused = -1;
    contraction.representatives.append(position, std::span(&unused, 1));
    contraction.deviation.around.push_back(0);
    wedges.attributes.push_back(attribute_of({place, 0}));
    for (std::uint32_t k = 1; k < wedges_at(place); ++k) {
      const float attribute = attribute_of({place, k});
      wedges.copies.places.push_back(place);
      wedges.copies.vertices.append(position, std::span(&attribute, 1));
    }
  }
  for (std::uint32_t i = 0; i < joined.own_count; ++i) {
    const std::uint32_t place = i < count ? i : i * 7 % count;
    contraction.parent_of.push_back(place);
    wedges.map.firsts.push_back(i % wedges_at(place));
    for (std::size_t c = joined.copies.first_of(i); c < joined.copies.first_of(i + 1); ++c) {
      wedges.map.places.push_back(i);
      wedges.map.copies.push_back(static_cast<std::uint32_t>(c) % wedges_at(place));
    }
  }
  return result;
}

TEST(SeamWedgesTest, AContractedTileNamesTheWedgesThatStandForTheOldOnes) {
  for (const auto& [name, world] : worlds()) {
    for (const std::uint32_t target : {3U, 12U, 1000U}) {
      SCOPED_TRACE(name + ", " + std::to_string(target));
      const BuildTile joined = join_pair(world, 1);
      const Placed placed = placed_pair(world, joined.mesh, 1);
      const auto [contraction, wedges] =
          wild_contraction(joined.mesh, std::min(target, joined.mesh.own_count));
      const ContractedTile result = apply(joined, contraction, wedges);
      const SimplifiedTile& tile = result.tile;
      const TileMesh& mesh = joined.mesh;
      EXPECT_EQ(triangles_of(tile, tile.interior, tile.interior_wedges),
                images(placed, result, mesh.interior, mesh.interior_wedges, true));
      // resolve() keeps one of border triangles that differ by wedges.
      EXPECT_EQ(triangles_of(tile, tile.border, tile.border_wedges),
                images(placed, result, mesh.border, mesh.border_wedges, false));
    }
  }
}

// Two tiles that number the same three places differently.
TEST(SeamWedgesTest, OfTrianglesOfTheSamePlacesAllTilesKeepTheSame) {
  const GhostRef a{1, 4}, b{2, 3}, c{2, 7};
  const std::vector<std::array<std::pair<GhostRef, std::uint32_t>, 3>> all{
      {{{a, 0}, {c, 1}, {b, 0}}}, {{{b, 1}, {a, 0}, {c, 0}}}, {{{c, 0}, {b, 0}, {a, 1}}}};
  std::set<std::map<GhostRef, std::uint32_t>> kept;
  for (const std::vector<GhostRef>& names : {std::vector{a, b, c}, {c, a, b}, {b, c, a}}) {
    std::vector<TileTriangle> triangles(all.size());
    std::vector<CornerWedges> wedges(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& [ref, wedge] = all[i][k];
        triangles[i][k] = static_cast<TileVertex>(std::ranges::find(names, ref) - names.begin());
        wedges[i][k] = wedge;
      }
    }
    keep_one_of_places(triangles, wedges, [&](TileVertex v) { return names[raw(v)]; });
    ASSERT_EQ(triangles.size(), 1U);
    std::map<GhostRef, std::uint32_t> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[names[raw(triangles[0][k])]] = wedges[0][k];
    kept.insert(corners);
  }
  EXPECT_EQ(kept.size(), 1U);
}

TEST(SeamWedgesTest, CopiesFollowTheirRepresentatives) {
  const WedgeWorld world = make_world(tests::sphere(1200, 0.02F), false);
  const BuildTile joined = join_pair(world, 0);
  const auto [contraction, wedges] = wild_contraction(joined.mesh, 60);
  const ContractedTile result = apply(joined, contraction, wedges);
  const SimplifiedTile& tile = result.tile;
  EXPECT_GT(tile.boundary_count, 0U);
  EXPECT_TRUE(std::ranges::is_sorted(tile.copies.places));
  EXPECT_EQ(tile.copies.size(), wedges.copies.size());
  std::map<std::uint32_t, std::uint32_t> next;  // wedge of each place
  for (std::size_t i = 0; i < tile.copies.size(); ++i) {
    const std::uint32_t place = tile.copies.places[i];
    const auto first = static_cast<std::uint32_t>(tile.vertices.attributes_of(place)[0]);
    EXPECT_EQ(tile.copies.vertices.attributes_of(i)[0],
              attribute_of({first / kMostWedges, ++next[place]}));
    EXPECT_EQ(tile.copies.vertices.positions[i], tile.vertices.positions[place]);
  }
  for (std::uint32_t i = 0; i < joined.mesh.own_count; ++i) {
    EXPECT_EQ(tile.vertices.attributes_of(result.parent_map[i])[0],
              attribute_of({contraction.parent_of[i], 0}));
  }
}

TEST(SeamWedgesTest, AKeptTileNamesForeignWedgesAsTheirTilesDo) {
  for (const auto& [name, world] : worlds()) {
    SCOPED_TRACE(name);
    const BuildTile built = build_tile(world, 2);
    const TileMesh& mesh = built.mesh;
    const ContractedTile kept = keep(built);
    const Placed placed{world, mesh, world.own[2]};
    EXPECT_TRUE(kept.wedge_map.empty());
    EXPECT_EQ(triangles_of(kept.tile, kept.tile.interior, kept.tile.interior_wedges),
              images(placed, kept, mesh.interior, mesh.interior_wedges, true));
    EXPECT_EQ(triangles_of(kept.tile, kept.tile.border, kept.tile.border_wedges),
              images(placed, kept, mesh.border, mesh.border_wedges, true));
    EXPECT_EQ(kept.tile.copies.size(), mesh.copies.size() - mesh.ghost_wedges.size());
  }
}

}  // namespace
}  // namespace meshhier::cluster_simplify

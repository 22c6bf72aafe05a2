#include "partition/leaf_tiles.h"

#include "base/error.h"
#include "partition/spatial_order.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace meshhier::partition {
namespace {

/// A mesh cut into the chunks of one level. Its vertices carry their provisional rank as their only
/// attribute (exact: below 2^24), so that every tile vertex can be told.
struct Cut {
  Tree tree;
  ChunkMap map;
  std::vector<ChunkMesh> chunks;
  std::vector<std::vector<PartitionId>> partitions;  ///< per chunk, of its vertices
  std::vector<RankTriangle> triangles;               ///< all of them, in provisional ranks

  std::uint32_t partition_of(std::uint32_t rank) const {
    const std::uint32_t chunk = map.chunk_of(rank);
    return raw(partitions[chunk][rank - map.first_rank(chunk)]);
  }
};

Cut cut(const tests::TestMesh& mesh, std::uint32_t partition_count, Level level) {
  const Tree tree(mesh.positions.size(), partition_count);
  Cut result{tree, ChunkMap(tree, level), {}, {}, {}};
  // Chunks along x; within a chunk by id.
  std::vector<std::uint32_t> order(mesh.positions.size());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(mesh.positions[a].x, a) < std::pair(mesh.positions[b].x, b);
  });
  std::vector<std::uint32_t> rank_of(order.size());
  for (std::uint32_t c = 0; c < result.map.count(); ++c) {
    const auto begin = order.begin() + result.map.first_rank(c);
    std::sort(begin, begin + result.map.size(c));
    ChunkMesh chunk;
    chunk.node = {level, c};
    chunk.vertices.channels = 1;
    for (std::uint32_t i = 0; i < result.map.size(c); ++i) {
      const std::uint32_t rank = result.map.first_rank(c) + i;
      const auto attribute = static_cast<float>(rank);
      rank_of[begin[i]] = rank;
      chunk.vertices.append(mesh.positions[begin[i]], std::span(&attribute, 1));
    }
    result.chunks.push_back(std::move(chunk));
  }
  for (const tests::MeshTriangle& t : mesh.triangles) {
    const RankTriangle ranks{rank_of[t[0]], rank_of[t[1]], rank_of[t[2]]};
    result.triangles.push_back(ranks);
    const std::set<std::uint32_t> touched{result.map.chunk_of(ranks[0]),
                                          result.map.chunk_of(ranks[1]),
                                          result.map.chunk_of(ranks[2])};
    for (const std::uint32_t c : touched)
      result.chunks[c].triangles.push_back(ranks);
  }
  for (const ChunkMesh& chunk : result.chunks)
    result.partitions.push_back(split_chunk(chunk, tree, Axis::compactness));
  return result;
}

ChunkLeaves leaves_of(const Cut& mesh, std::uint32_t chunk) {
  return build_leaves(mesh.chunks[chunk], mesh.partitions[chunk], mesh.tree, mesh.map);
}

std::uint32_t rank_of(const LeafTile& tile, std::size_t vertex) {
  return static_cast<std::uint32_t>(tile.vertices.attributes_of(vertex)[0]);
}

RankTriangle canonical_ranks(RankTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// The tile's triangles by provisional ranks, ascending.
std::vector<RankTriangle> ranks_of(const Cut& mesh, const LeafTile& tile,
                                   const std::vector<TileTriangle>& triangles) {
  std::vector<RankTriangle> result;
  for (const TileTriangle& t : triangles) {
    RankTriangle ranks{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t own = tile.vertices.size();
      if (raw(t[k]) < own) {
        ranks[k] = rank_of(tile, raw(t[k]));
      } else {
        const ChunkVertex& foreign = tile.foreign.at(raw(t[k]) - own);
        ranks[k] = mesh.map.first_rank(foreign.chunk) + foreign.local;
      }
    }
    result.push_back(canonical_ranks(ranks));
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// One partition as the definitions say.
struct Expected {
  std::vector<std::uint32_t> boundary, inner;  ///< ranks, ascending
  std::vector<RankTriangle> interior, border;
  std::set<ChunkVertex> foreign;
};

std::vector<Expected> expected_leaves(const Cut& mesh) {
  std::vector<Expected> leaves(mesh.tree.partition_count());
  std::set<std::uint32_t> boundary;
  for (const RankTriangle& t : mesh.triangles) {
    const std::set<std::uint32_t> touched{mesh.partition_of(t[0]), mesh.partition_of(t[1]),
                                          mesh.partition_of(t[2])};
    for (const std::uint32_t p : touched) {
      (touched.size() == 1 ? leaves[p].interior : leaves[p].border).push_back(canonical_ranks(t));
      for (const std::uint32_t rank : t) {
        if (touched.size() > 1)
          boundary.insert(rank);
        if (mesh.partition_of(rank) != p) {
          const std::uint32_t chunk = mesh.map.chunk_of(rank);
          leaves[p].foreign.insert({chunk, rank - mesh.map.first_rank(chunk)});
        }
      }
    }
  }
  for (std::uint32_t c = 0; c < mesh.map.count(); ++c) {
    for (const std::uint32_t v : spatial_order(mesh.chunks[c].vertices.positions)) {
      const std::uint32_t rank = mesh.map.first_rank(c) + v;
      Expected& leaf = leaves[mesh.partition_of(rank)];
      (boundary.contains(rank) ? leaf.boundary : leaf.inner).push_back(rank);
    }
  }
  for (Expected& leaf : leaves) {
    std::sort(leaf.interior.begin(), leaf.interior.end());
    std::sort(leaf.border.begin(), leaf.border.end());
  }
  return leaves;
}

void expect_tile(const Cut& mesh, const LeafTile& tile, const Expected& expected) {
  std::vector<std::uint32_t> ranks;
  for (std::size_t i = 0; i < tile.vertices.size(); ++i)
    ranks.push_back(rank_of(tile, i));
  std::vector<std::uint32_t> order = expected.boundary;
  order.insert(order.end(), expected.inner.begin(), expected.inner.end());
  EXPECT_EQ(ranks, order);
  EXPECT_EQ(tile.boundary_count, expected.boundary.size());
  EXPECT_EQ(ranks_of(mesh, tile, tile.interior), expected.interior);
  EXPECT_EQ(ranks_of(mesh, tile, tile.border), expected.border);
  EXPECT_EQ(tile.foreign,
            std::vector<ChunkVertex>(expected.foreign.begin(), expected.foreign.end()));
  EXPECT_EQ(tile.history.weights, std::vector<float>(ranks.size(), 1.0F));
  for (const auto* triangles : {&tile.interior, &tile.border}) {
    EXPECT_TRUE(std::is_sorted(triangles->begin(), triangles->end()));
    for (const TileTriangle& t : *triangles)
      EXPECT_EQ(t, canonical(t));
  }
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    const std::uint32_t chunk = mesh.map.chunk_of(ranks[i]);
    EXPECT_EQ(tile.vertices.positions[i],
              mesh.chunks[chunk].vertices.positions[ranks[i] - mesh.map.first_rank(chunk)]);
  }
}

void expect_leaves(const tests::TestMesh& source, std::uint32_t partitions, Level level) {
  const Cut mesh = cut(source, partitions, level);
  const std::vector<Expected> expected = expected_leaves(mesh);
  std::set<std::uint32_t> used;
  for (const RankTriangle& t : mesh.triangles)
    used.insert(t.begin(), t.end());
  std::uint64_t unreferenced = 0;
  for (std::uint32_t c = 0; c < mesh.map.count(); ++c) {
    const ChunkLeaves leaves = leaves_of(mesh, c);
    const PartitionRange range = mesh.tree.partitions({level, c});
    ASSERT_EQ(leaves.tiles.size(), range.size());
    for (std::uint32_t i = 0; i < range.size(); ++i) {
      SCOPED_TRACE(range.begin + i);
      expect_tile(mesh, leaves.tiles[i], expected[range.begin + i]);
    }
    unreferenced += leaves.unreferenced_count;
  }
  EXPECT_EQ(unreferenced, source.positions.size() - used.size());
}

std::vector<tests::TestMesh> kinds_of_meshes() {
  tests::TestMesh with_loose = tests::shuffled(tests::sphere(2000, 0.02F), 5);
  for (const Vec3f& p : tests::points(100).positions)
    with_loose.positions.push_back(p);
  return {tests::shuffled(tests::torus(3000, 0.02F), 1),
          tests::open_grid(40, 30),
          tests::non_manifold(2000),
          tests::duplicates(2000, 0.02F),
          tests::soup(500),
          tests::points(300),
          with_loose};
}

TEST(LeafTiles, AreWhatTheDefinitionsSayForEveryKindOfMesh) {
  for (const tests::TestMesh& mesh : kinds_of_meshes()) {
    expect_leaves(mesh, 13, Level{2});
    expect_leaves(mesh, 13, Level{0});
  }
}

TEST(LeafTiles, AreWhatTheDefinitionsSayForEveryNumberOfPartitions) {
  const tests::TestMesh mesh = tests::shuffled(tests::sphere(1500, 0.02F), 3);
  expect_leaves(mesh, 1, Level{0});
  for (const std::uint32_t partitions : {2U, 3U, 16U, 100U}) {
    for (const int level : {0, 1})
      expect_leaves(mesh, partitions, static_cast<Level>(level));
  }
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  expect_leaves(mesh, n, Level{2});  // a vertex each: every triangle is in three
}

TEST(LeafTiles, PlacesTellWhereEveryBoundaryVertexWent) {
  const Cut mesh = cut(tests::shuffled(tests::sphere(3000, 0.02F), 2), 13, Level{2});
  for (std::uint32_t c = 0; c < mesh.map.count(); ++c) {
    const ChunkLeaves leaves = leaves_of(mesh, c);
    std::size_t boundary = 0;
    for (const LeafTile& tile : leaves.tiles)
      boundary += tile.boundary_count;
    ASSERT_EQ(leaves.places.size(), boundary);
    ASSERT_GT(boundary, 0U);
    std::uint32_t next = 0;
    for (const LeafPlace& place : leaves.places) {
      EXPECT_GE(place.local, next);
      next = place.local + 1;
      const LeafTile& tile = leaves.tiles.at(place.partition);
      EXPECT_LT(place.index, tile.boundary_count);
      EXPECT_EQ(rank_of(tile, place.index), mesh.map.first_rank(c) + place.local);
      EXPECT_EQ(&find_place(leaves.places, place.local), &place);
    }
  }
}

TEST(LeafTiles, EveryForeignCornerIsFoundInItsChunksPlaces) {
  const Cut mesh = cut(tests::shuffled(tests::torus(3000, 0.02F), 2), 13, Level{2});
  std::vector<ChunkLeaves> leaves;
  for (std::uint32_t c = 0; c < mesh.map.count(); ++c)
    leaves.push_back(leaves_of(mesh, c));
  for (const ChunkLeaves& chunk : leaves) {
    for (const LeafTile& tile : chunk.tiles) {
      for (const ChunkVertex& foreign : tile.foreign)
        EXPECT_NO_THROW((void)find_place(leaves[foreign.chunk].places, foreign.local));
    }
  }
}

TEST(LeafTiles, ACornerThatIsInNoBoundaryIsADefect) {
  const std::vector<LeafPlace> places{{3, 0, 0}, {7, 1, 0}};
  EXPECT_EQ(find_place(places, 7).partition, 1U);
  for (const std::uint32_t local : {0U, 4U, 8U}) {
    try {
      (void)find_place(places, local);
      ADD_FAILURE() << local;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::internal);
    }
  }
  EXPECT_THROW((void)find_place({}, 0), Error);
}

TEST(LeafTiles, DoNotDependOnTheOrderOrTheFirstCornerOfTriangles) {
  Cut mesh = cut(tests::duplicates(2000, 0.02F), 13, Level{2});
  for (std::uint32_t c = 0; c < mesh.map.count(); ++c) {
    const ChunkLeaves before = leaves_of(mesh, c);
    std::vector<RankTriangle>& triangles = mesh.chunks[c].triangles;
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(c));
    for (std::size_t i = 0; i < triangles.size(); i += 2)
      std::rotate(triangles[i].begin(), triangles[i].begin() + 1, triangles[i].end());
    const ChunkLeaves after = leaves_of(mesh, c);
    ASSERT_EQ(after.tiles.size(), before.tiles.size());
    for (std::size_t i = 0; i < after.tiles.size(); ++i) {
      EXPECT_EQ(after.tiles[i].vertices.positions, before.tiles[i].vertices.positions);
      EXPECT_EQ(after.tiles[i].vertices.attributes, before.tiles[i].vertices.attributes);
      EXPECT_EQ(after.tiles[i].interior, before.tiles[i].interior);
      EXPECT_EQ(after.tiles[i].border, before.tiles[i].border);
      EXPECT_EQ(after.tiles[i].foreign, before.tiles[i].foreign);
      EXPECT_EQ(after.tiles[i].boundary_count, before.tiles[i].boundary_count);
    }
  }
}

TEST(LeafTiles, EveryDuplicateOfATriangleIsKept) {
  const tests::TestMesh source = tests::duplicates(2000, 0.02F);
  const Cut mesh = cut(source, 1, Level{0});
  EXPECT_EQ(leaves_of(mesh, 0).tiles[0].interior.size(), source.triangles.size());
}

TEST(LeafTiles, CopiesStayWithoutTriangles) {
  Cut mesh = cut(tests::points(6), 2, Level{0});
  Copies& copies = mesh.chunks[0].copies;
  copies.vertices.channels = 1;
  for (const std::uint32_t place : {0U, 0U, 5U}) {
    copies.places.push_back(place);
    copies.vertices.append(mesh.chunks[0].vertices.positions[place],
                           mesh.chunks[0].vertices.attributes_of(place));
  }
  const ChunkLeaves leaves = leaves_of(mesh, 0);
  EXPECT_EQ(leaves.tiles[0].copies.size() + leaves.tiles[1].copies.size(), 3U);
  EXPECT_EQ(leaves.unreferenced_count, 9U);
}

// ---- copies --------------------------------------------------------------------------------

/// A corner by its place's provisional rank and its wedge.
using Corner = std::pair<std::uint32_t, std::uint32_t>;
using WedgedTriangle = std::array<Corner, 3>;

/// A cut mesh whose every third place has copies, one to three, which some triangles name. Copies
/// have 1,000,000 times their wedge more as attribute than their places.
struct CopiedCut {
  Cut mesh;
  std::vector<WedgedTriangle> triangles;  ///< all, each once
};

constexpr float kWedgeStep = 1'000'000;

std::uint32_t copies_at(std::uint32_t rank) {
  return rank % 3 == 0 ? 1 + rank / 3 % 3 : 0;
}

/// `copied_chunks`: chunks from there on have no copies.
CopiedCut with_copies(Cut mesh, std::uint32_t copied_chunks = UINT32_MAX) {
  CopiedCut result{std::move(mesh), {}};
  Cut& cut = result.mesh;
  const auto copies_of = [&](std::uint32_t rank) {
    return cut.map.chunk_of(rank) < copied_chunks ? copies_at(rank) : 0;
  };
  for (std::uint32_t i = 0; i < cut.triangles.size(); ++i) {
    WedgedTriangle& wedged = result.triangles.emplace_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t rank = cut.triangles[i][k];
      wedged[k] = {rank, i % 5 == 0 ? 0 : (i + k) % (copies_of(rank) + 1)};
    }
  }
  // A triangle that has a place twice, by two vertices: these are there in any input.
  for (std::uint32_t i = 0; i < cut.triangles.size(); i += 40) {
    const auto [a, b, c] = cut.triangles[i];
    if (copies_of(a) > 0)
      result.triangles.push_back({Corner{a, 0}, {a, 1}, {c, 0}});
  }
  for (std::uint32_t c = 0; c < cut.map.count(); ++c) {
    ChunkMesh& chunk = cut.chunks[c];
    chunk.triangles.clear();
    chunk.copies.vertices.channels = 1;
    for (std::uint32_t local = 0; local < cut.map.size(c); ++local) {
      const std::uint32_t rank = cut.map.first_rank(c) + local;
      for (std::uint32_t k = 1; k <= copies_of(rank); ++k) {
        const float attribute = static_cast<float>(rank) + kWedgeStep * static_cast<float>(k);
        chunk.copies.places.push_back(local);
        chunk.copies.vertices.append(chunk.vertices.positions[local], std::span(&attribute, 1));
      }
    }
  }
  for (const bool named : {false, true}) {
    for (const WedgedTriangle& t : result.triangles) {
      const CornerWedges wedges{t[0].second, t[1].second, t[2].second};
      if ((wedges != CornerWedges{}) != named)
        continue;
      std::set<std::uint32_t> touched;
      for (const Corner& corner : t)
        touched.insert(cut.map.chunk_of(corner.first));
      for (const std::uint32_t c : touched) {
        cut.chunks[c].triangles.push_back({t[0].first, t[1].first, t[2].first});
        if (named)
          cut.chunks[c].wedges.push_back(wedges);
      }
    }
  }
  return result;
}

WedgedTriangle smallest_first(WedgedTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// The tile's triangles with their wedges, ascending.
std::vector<WedgedTriangle> wedged_of(const Cut& mesh, const LeafTile& tile,
                                      const std::vector<TileTriangle>& triangles,
                                      const std::vector<CornerWedges>& wedges) {
  EXPECT_TRUE(wedges.empty() || wedges.size() == triangles.size());
  std::vector<WedgedTriangle> result;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    WedgedTriangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = raw(triangles[i][k]);
      const std::size_t own = tile.vertices.size();
      const std::uint32_t rank = v < own ? rank_of(tile, v)
                                         : mesh.map.first_rank(tile.foreign.at(v - own).chunk) +
                                               tile.foreign.at(v - own).local;
      corners[k] = {rank, wedges.empty() ? 0 : wedges[i][k]};
    }
    result.push_back(smallest_first(corners));
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Those of a partition, ascending; inside it, or across its border.
std::vector<WedgedTriangle> expected_of(const CopiedCut& copied, std::uint32_t partition,
                                        bool inside) {
  std::vector<WedgedTriangle> result;
  for (const WedgedTriangle& t : copied.triangles) {
    std::set<std::uint32_t> touched;
    for (const Corner& corner : t)
      touched.insert(copied.mesh.partition_of(corner.first));
    if (touched.contains(partition) && (touched.size() == 1) == inside)
      result.push_back(smallest_first(t));
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Every copy lies where its place does, in its order.
void expect_copies(const LeafTile& tile, const ChunkMap& map, std::uint32_t copied_chunks) {
  std::vector<std::uint32_t> places;
  for (std::uint32_t v = 0; v < tile.vertices.size(); ++v) {
    const std::uint32_t rank = rank_of(tile, v);
    const std::uint32_t count = map.chunk_of(rank) < copied_chunks ? copies_at(rank) : 0;
    for (std::uint32_t k = 1; k <= count; ++k) {
      const std::size_t copy = places.size();
      places.push_back(v);
      ASSERT_LT(copy, tile.copies.size());
      EXPECT_EQ(tile.copies.vertices.positions[copy], tile.vertices.positions[v]);
      EXPECT_EQ(tile.copies.vertices.attributes[copy],
                static_cast<float>(rank) + kWedgeStep * static_cast<float>(k));
    }
  }
  EXPECT_EQ(tile.copies.places, places);
}

void expect_copied_leaves(const tests::TestMesh& source, std::uint32_t partitions, Level level,
                          std::uint32_t copied_chunks = UINT32_MAX) {
  const CopiedCut copied = with_copies(cut(source, partitions, level), copied_chunks);
  std::set<Corner> used;
  for (const WedgedTriangle& t : copied.triangles)
    used.insert(t.begin(), t.end());
  std::uint64_t unreferenced = 0, vertices = 0;
  for (std::uint32_t c = 0; c < copied.mesh.map.count(); ++c) {
    const ChunkLeaves leaves = leaves_of(copied.mesh, c);
    unreferenced += leaves.unreferenced_count;
    const PartitionRange range = copied.mesh.tree.partitions({level, c});
    for (std::uint32_t i = 0; i < range.size(); ++i) {
      SCOPED_TRACE(range.begin + i);
      const LeafTile& tile = leaves.tiles[i];
      vertices += tile.vertices.size() + tile.copies.size();
      expect_copies(tile, copied.mesh.map, copied_chunks);
      EXPECT_EQ(wedged_of(copied.mesh, tile, tile.interior, tile.interior_wedges),
                expected_of(copied, range.begin + i, true));
      EXPECT_EQ(wedged_of(copied.mesh, tile, tile.border, tile.border_wedges),
                expected_of(copied, range.begin + i, false));
      EXPECT_TRUE(std::is_sorted(tile.interior.begin(), tile.interior.end()));
      EXPECT_TRUE(std::is_sorted(tile.border.begin(), tile.border.end()));
    }
  }
  EXPECT_EQ(unreferenced, vertices - used.size());
}

TEST(CopiedLeafTiles, AreWhatTheDefinitionsSayForEveryKindOfMesh) {
  for (const tests::TestMesh& mesh : kinds_of_meshes()) {
    expect_copied_leaves(mesh, 13, Level{2});
    expect_copied_leaves(mesh, 13, Level{0});
  }
}

TEST(CopiedLeafTiles, NeighboursMayHaveNone) {
  expect_copied_leaves(tests::shuffled(tests::sphere(2000, 0.02F), 5), 13, Level{2}, 1);
  expect_copied_leaves(tests::shuffled(tests::sphere(2000, 0.02F), 5), 13, Level{2}, 3);
}

TEST(CopiedLeafTiles, TilesWithoutCopiesAreAsIfThereWereNone) {
  const Cut plain = cut(tests::shuffled(tests::sphere(2000, 0.02F), 5), 13, Level{0});
  Cut copied = plain;
  // One copy of the first place of a partition, which one triangle inside it names.
  ChunkMesh& chunk = copied.chunks[0];
  const auto inside = std::find_if(chunk.triangles.begin(), chunk.triangles.end(), [&](auto& t) {
    return copied.partition_of(t[0]) == copied.partition_of(t[1]) &&
           copied.partition_of(t[1]) == copied.partition_of(t[2]);
  });
  ASSERT_NE(inside, chunk.triangles.end());
  const RankTriangle named = *inside;
  chunk.triangles.erase(inside);
  chunk.triangles.push_back(named);
  chunk.wedges.push_back({1, 0, 0});
  chunk.copies.vertices.channels = 1;
  chunk.copies.places.push_back(named[0]);
  chunk.copies.vertices.append(chunk.vertices.positions[named[0]],
                               chunk.vertices.attributes_of(named[0]));
  const ChunkLeaves before = leaves_of(plain, 0), after = leaves_of(copied, 0);
  for (std::uint32_t i = 0; i < after.tiles.size(); ++i) {
    SCOPED_TRACE(i);
    const bool has_copy = i == copied.partition_of(named[0]);
    EXPECT_EQ(after.tiles[i].copies.size(), has_copy ? 1U : 0U);
    EXPECT_EQ(after.tiles[i].interior_wedges.size(), has_copy ? after.tiles[i].interior.size() : 0);
    EXPECT_TRUE(after.tiles[i].border_wedges.empty());
    EXPECT_EQ(after.tiles[i].vertices.positions, before.tiles[i].vertices.positions);
    EXPECT_EQ(after.tiles[i].border, before.tiles[i].border);
    EXPECT_EQ(after.tiles[i].interior, before.tiles[i].interior);
  }
}

TEST(CopiedLeafTiles, DoNotDependOnTheOrderOrTheFirstCornerOfTriangles) {
  CopiedCut copied = with_copies(cut(tests::duplicates(2000, 0.02F), 13, Level{2}));
  for (std::uint32_t c = 0; c < copied.mesh.map.count(); ++c) {
    const ChunkLeaves before = leaves_of(copied.mesh, c);
    ChunkMesh& chunk = copied.mesh.chunks[c];
    const std::size_t plain = chunk.triangles.size() - chunk.wedges.size();
    for (std::size_t i = 0; i < chunk.wedges.size(); i += 2) {
      auto& corners = chunk.triangles[plain + i];
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      std::rotate(chunk.wedges[i].begin(), chunk.wedges[i].begin() + 1, chunk.wedges[i].end());
    }
    std::reverse(chunk.triangles.begin() + static_cast<std::ptrdiff_t>(plain),
                 chunk.triangles.end());
    std::reverse(chunk.wedges.begin(), chunk.wedges.end());
    const ChunkLeaves after = leaves_of(copied.mesh, c);
    for (std::size_t i = 0; i < after.tiles.size(); ++i) {
      EXPECT_EQ(after.tiles[i].interior, before.tiles[i].interior);
      EXPECT_EQ(after.tiles[i].interior_wedges, before.tiles[i].interior_wedges);
      EXPECT_EQ(after.tiles[i].border, before.tiles[i].border);
      EXPECT_EQ(after.tiles[i].border_wedges, before.tiles[i].border_wedges);
      EXPECT_EQ(after.tiles[i].copies.places, before.tiles[i].copies.places);
    }
  }
}

// A count of partitions near that of the vertices: one chunk has more than 65536 of them.
TEST(LeafTiles, PlacesTellPartitionsBeyond16BitsApart) {
  constexpr std::uint32_t kCount = 70000;
  const Tree tree(kCount, kCount);
  ChunkMesh chunk;
  std::vector<PartitionId> partition_of;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    chunk.vertices.append({static_cast<float>(i), static_cast<float>(i % 2), 0}, {});
    partition_of.push_back(static_cast<PartitionId>(i));
    if (i >= 2)
      chunk.triangles.push_back({i - 2, i - 1, i});
  }
  const ChunkLeaves leaves = build_leaves(chunk, partition_of, tree, ChunkMap(tree, Level{0}));
  ASSERT_EQ(leaves.places.size(), kCount);
  for (const LeafPlace& place : leaves.places)
    ASSERT_EQ(std::uint32_t{place.partition}, place.local);
}

}  // namespace
}  // namespace meshhier::partition

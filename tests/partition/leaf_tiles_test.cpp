#include "partition/leaf_tiles.h"

#include "hierarchy/error.h"
#include "partition/spatial_order.h"
#include "tests/support/meshes.h"

#include <algorithm>
#include <random>
#include <set>

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

/// What the definitions say of one partition.
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

TEST(LeafTiles, AreWhatTheDefinitionsSayForEveryKindOfMesh) {
  tests::TestMesh with_loose = tests::shuffled(tests::sphere(2000, 0.02F), 5);
  for (const Vec3f& p : tests::points(100).positions)
    with_loose.positions.push_back(p);
  for (const tests::TestMesh& mesh :
       {tests::shuffled(tests::torus(3000, 0.02F), 1), tests::open_grid(40, 30),
        tests::non_manifold(2000), tests::duplicates(2000, 0.02F), tests::soup(500),
        tests::points(300), with_loose}) {
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

#include "pipeline/tiles/chunks.h"

#include "execution/parallel.h"
#include "pipeline/plan/tile_room.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using partition::RankTriangle;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

TEST(PackedTriangleTest, HoldsEveryPlaceOfAChunk) {
  constexpr std::uint32_t kFirst = 4'000'000'000U;
  for (const RankTriangle& t : {RankTriangle{kFirst, kFirst + 1, kFirst + 2},
                                RankTriangle{kFirst + 131071, kFirst, kFirst + 7},
                                RankTriangle{kFirst + 1, kFirst + 131070, kFirst + 131071}}) {
    EXPECT_EQ(PackedTriangle(t, kFirst).ranks(kFirst), t);
  }
}

class ChunksTest : public testing::Test {
 protected:
  // 300,000 vertices: four chunks of 75,000.
  Tree tree_{300'000, 40};
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
  Chunks chunks_{tree_, 1, false, scratch_, 4096};

  /// As the first block of all.
  static void rank(ChunkedVertices& block, const Chunks& chunks) {
    std::vector<std::uint32_t> ranks;
    Ranker(chunks.map()).rank(block, ranks);
  }
};

TEST_F(ChunksTest, VerticesKeepTheirOrderWithinTheirChunkInWhateverOrderBlocksCome) {
  ASSERT_EQ(chunks_.count(), 4U);
  Ranker ranker(chunks_.map());
  std::vector<ChunkedVertices> blocks;
  std::vector<std::uint32_t> ranks;
  for (std::uint32_t first = 0; first < 300'000; first += 1000) {
    std::vector<Vec3f> positions;
    std::vector<float> attributes;
    ChunkedVertices& block = blocks.emplace_back();
    for (std::uint32_t id = first; id < first + 1000; ++id) {
      positions.push_back({static_cast<float>(id), 1, 2});
      attributes.push_back(static_cast<float>(id) + 0.5F);
      block.chunk_of.push_back(id * 7 % 4);
    }
    block.sort(4, positions, attributes);
    ranker.rank(block, ranks);
  }
  execution::parallel_for(blocks.size(),
                          [&](std::size_t i) { chunks_.append(blocks[i * 7 % blocks.size()]); });
  for (std::uint32_t c = 0; c < 4; ++c) {
    EXPECT_TRUE(chunks_.is_whole(c));
    const partition::ChunkMesh chunk = chunks_.take(c);
    ASSERT_EQ(chunk.vertices.size(), 75'000U);
    std::uint32_t id = 0;
    for (std::size_t v = 0; v < chunk.vertices.size(); ++v, ++id) {
      while (id * 7 % 4 != c)
        ++id;
      ASSERT_EQ(chunk.vertices.positions[v], (Vec3f{static_cast<float>(id), 1, 2}));
      ASSERT_EQ(chunk.vertices.attributes_of(v)[0], static_cast<float>(id) + 0.5F);
    }
  }
}

TEST_F(ChunksTest, CountsTrianglesThatReachAcross) {
  // Chunks 0 to 3 begin at multiples of 75,000; 0 and 1 have one parent, 2 and 3 the other.
  const std::vector<RankTriangle> triangles{{0, 1, 2},
                                            {0, 80'000, 1},
                                            {0, 80'000, 160'000},
                                            {160'000, 0, 299'999},
                                            {0, 160'000, 160'001}};
  ChunkedTriangles block;
  for (int i = 0; i < 2; ++i) {
    block.sort(triangles, chunks_.map());
    chunks_.append(block);
  }
  EXPECT_EQ(chunks_.wide_triangles(chunks_.level()), 4U);
  EXPECT_EQ(chunks_.wide_triangles(Level{1}), 0U) << "there are two nodes only";
  EXPECT_EQ(chunks_.wide_triangles(Level{0}), 0U);
  EXPECT_EQ(expected_contracted(chunks_), 3U * 4 / 2 * sizeof(TileTriangle) * TileRoom::kContracted)
      << "each is in three tiles, and two nodes are made of these";
}

TEST_F(ChunksTest, ATriangleGoesToEachChunkItTouches) {
  const RankTriangle inner{75'000, 149'999, 80'000};
  const RankTriangle two{74'999, 75'000, 0}, two_apart{0, 299'999, 1};
  const RankTriangle three{1, 75'001, 150'001};
  ChunkedTriangles block;
  block.sort(std::vector<RankTriangle>{inner, two, two_apart, three}, chunks_.map());
  EXPECT_EQ(block.inner.size(), 1U);
  chunks_.append(block);
  block.sort(std::vector<RankTriangle>{inner}, chunks_.map());  // nothing of the last block stays
  chunks_.append(block);
  EXPECT_EQ(chunks_.triangle_bytes(1), 4 * sizeof(RankTriangle));
  const auto triangles = [&](std::uint32_t chunk) {
    ChunkedVertices none;
    std::vector<Vec3f> positions(75'000);
    std::vector<float> attributes(75'000);
    none.chunk_of.assign(75'000, chunk);
    none.sort(4, positions, attributes);
    rank(none, chunks_);
    chunks_.append(none);
    return chunks_.take(chunk).triangles;
  };
  EXPECT_THAT(triangles(0), UnorderedElementsAre(two, two_apart, three));
  EXPECT_THAT(triangles(1), UnorderedElementsAre(inner, inner, two, three));
  EXPECT_THAT(triangles(2), ElementsAre(three));
  EXPECT_THAT(triangles(3), ElementsAre(two_apart));
}

// ---- copies --------------------------------------------------------------------------------

/// A triangle's corners: their ranks, and their wedges there.
using Corners = std::pair<RankTriangle, CornerWedges>;

TEST_F(ChunksTest, WhatSlicesHaveStoredIsOneBehindTheOther) {
  const auto place = [](std::uint32_t id) { return Vec3f{static_cast<float>(id), 1, 2}; };
  const auto slice = [&](std::uint32_t first, std::uint32_t end) {
    auto chunks = std::make_unique<Chunks>(tree_, 1, false, scratch_, 4096);
    ChunkedVertices vertices;
    std::vector<Vec3f> positions;
    for (std::uint32_t id = first; id < end; ++id)
      positions.push_back(place(id));
    vertices.chunk_of.assign(positions.size(), 2);
    vertices.sort(4, positions, std::vector<float>(positions.size(), 7));
    rank(vertices, *chunks);
    chunks->append(vertices);
    ChunkedTriangles triangles;
    triangles.sort(std::vector<RankTriangle>{{150'000 + first, 150'000 + end - 1, 150'001},
                                             {first, 150'000, 150'001}},
                   chunks->map());
    chunks->append(triangles);
    return chunks;
  };
  const auto empty = std::make_unique<Chunks>(tree_, 1, false, scratch_, 4096);
  ASSERT_FALSE(chunks_.has(2));
  std::uint32_t first = 0;
  std::vector<std::unique_ptr<Chunks>> slices;  // rows that they have released would be used again
  for (const std::uint32_t end : {20'000U, 20'001U, 75'000U}) {
    ASSERT_FALSE(chunks_.is_whole(2));
    slices.push_back(slice(first, end));
    ASSERT_TRUE(slices.back()->has(2));
    ASSERT_TRUE(chunks_.restore(2, slices.back()->store(2)));
    ASSERT_TRUE(chunks_.restore(2, empty->store(2)));
    first = end;
  }
  EXPECT_TRUE(chunks_.is_as_stored(2));
  EXPECT_EQ(chunks_.triangle_count(2), 6U);
  const partition::ChunkMesh chunk = chunks_.take(2);
  ASSERT_EQ(chunk.vertices.size(), 75'000U);
  for (std::uint32_t i = 0; i < 75'000; ++i)
    ASSERT_EQ(chunk.vertices.positions[i], place(i));
  EXPECT_THAT(chunk.triangles,
              UnorderedElementsAre(
                  RankTriangle{150'000, 169'999, 150'001}, RankTriangle{170'000, 170'000, 150'001},
                  RankTriangle{170'001, 224'999, 150'001}, RankTriangle{0, 150'000, 150'001},
                  RankTriangle{20'000, 150'000, 150'001}, RankTriangle{20'001, 150'000, 150'001}));
  EXPECT_FALSE(chunks_.restore(2, {{3, 0, 4096, {0}, 1},
                                   {0, 0, 8, nlohmann::json::array()},
                                   {0, 0, 8, nlohmann::json::array()}}))
      << "no whole numbers";
}

class CopiedChunksTest : public ChunksTest {
 protected:
  CopiedChunksTest() {
    // Every place (p, 1, 2) of rank p, and an attribute; chunks begin at multiples of 75,000.
    ChunkedVertices block;
    for (std::uint32_t rank = 0; rank < 300'000; ++rank) {
      positions_.push_back({static_cast<float>(rank), 1, 2});
      attributes_.push_back(static_cast<float>(rank) + 0.5F);
      block.chunk_of.push_back(rank / 75'000);
    }
    block.sort(4, positions_, attributes_);
    rank(block, copied_);
    copied_.append(block);
  }

  /// A copy of that place, with an attribute of its own.
  void copy(std::uint32_t rank, float attribute) {
    const Vec3f& p = positions_[rank];
    copied_.append_copy(rank, std::array{p.x, p.y, p.z, attribute});
  }
  void add(const std::vector<RankTriangle>& triangles, const std::vector<Corners>& named) {
    std::vector<WedgedTriangle> wedged;
    for (const auto& [ranks, wedges] : named)
      wedged.push_back({ranks, wedges});
    triangles_.sort(triangles, copied_.map());
    triangles_.sort_wedged(wedged, copied_.map());
    copied_.append(triangles_);
  }

  std::vector<Vec3f> positions_;
  std::vector<float> attributes_;
  ChunkedTriangles triangles_;
  Chunks copied_{tree_, 1, true, scratch_, 4096};
};

/// The triangles of a chunk that name copies.
std::vector<Corners> wedged_of(const partition::ChunkMesh& mesh) {
  std::vector<Corners> wedged;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.wedges_of(i) != CornerWedges{})
      wedged.emplace_back(mesh.triangles[i], mesh.wedges_of(i));
  }
  return wedged;
}

TEST_F(CopiedChunksTest, CopiesComeByPlaceInTheirOrder) {
  copy(80'000, 1);
  copy(75'001, 2);
  copy(80'000, 3);
  copy(299'999, 4);
  copy(75'001, 5);
  copy(75'000, 6);
  EXPECT_EQ(copied_.copy_count(1), 5U);
  EXPECT_EQ(copied_.copy_bytes(1), 5 * (4 + 12 + 4U));
  EXPECT_EQ(copied_.copy_count(0), 0U);
  const Copies second = copied_.take(1).copies;
  EXPECT_THAT(second.places, ElementsAre(0, 1, 1, 5000, 5000));
  EXPECT_THAT(second.vertices.attributes, ElementsAre(6, 2, 5, 1, 3));
  EXPECT_EQ(second.vertices.channels, 1);
  for (std::size_t i = 0; i < second.size(); ++i)
    EXPECT_EQ(second.vertices.positions[i], positions_[75'000 + second.places[i]]);
  EXPECT_THAT(copied_.take(3).copies.places, ElementsAre(74'999));
  EXPECT_TRUE(copied_.take(0).copies.empty());
}

TEST_F(CopiedChunksTest, MoreCopiesThanAreReadAtATime) {
  for (std::uint32_t i = 0; i < 40'000; ++i)
    copy(74'999 - i, static_cast<float>(i));
  const Copies copies = copied_.take(0).copies;
  ASSERT_EQ(copies.size(), 40'000U);
  for (std::uint32_t i = 0; i < 40'000; ++i) {
    ASSERT_EQ(copies.places[i], 35'000 + i);
    ASSERT_EQ(copies.vertices.attributes[i], static_cast<float>(39'999 - i));
  }
}

TEST_F(CopiedChunksTest, TrianglesThatNameCopiesComeLastInEachChunkTheyTouch) {
  const RankTriangle plain{75'000, 75'001, 75'002};
  const Corners inner{{75'000, 149'999, 80'000}, {0, 2, 0}};
  const Corners flat{{80'000, 80'000, 75'000}, {0, 1, 0}};
  const Corners two{{74'999, 75'000, 0}, {1, 0, 3}}, two_apart{{299'999, 1, 0}, {1, 0, 0}};
  const Corners three{{1, 75'001, 150'001}, {0, 0, 4}};
  add({plain}, {inner, two, flat});
  add({}, {two_apart, three});
  add({plain}, {});  // nothing of the last block stays
  EXPECT_EQ(copied_.triangle_count(1), 6U);
  EXPECT_EQ(copied_.triangle_bytes(1), 6 * sizeof(RankTriangle) + 4 * sizeof(CornerWedges));
  const partition::ChunkMesh second = copied_.take(1);
  EXPECT_EQ(second.triangles.size(), 6U);
  EXPECT_EQ(second.triangles[0], plain);
  EXPECT_EQ(second.triangles[1], plain);
  EXPECT_EQ(second.wedges.size(), 4U);
  EXPECT_THAT(wedged_of(second), UnorderedElementsAre(inner, two, flat, three));
  EXPECT_THAT(wedged_of(copied_.take(0)), UnorderedElementsAre(two, two_apart, three));
  EXPECT_THAT(wedged_of(copied_.take(2)), ElementsAre(three));
  EXPECT_THAT(wedged_of(copied_.take(3)), ElementsAre(two_apart));
}

TEST_F(CopiedChunksTest, TrianglesThatReachAcrossCountWhetherTheyNameCopiesOrNot) {
  const RankTriangle three{0, 80'000, 160'000}, two{160'000, 0, 160'001};
  add({three, two}, {{three, {0, 1, 0}}, {two, {1, 0, 0}}, {{0, 0, 80'000}, {0, 1, 0}}});
  EXPECT_EQ(copied_.wide_triangles(copied_.level()), 2U);
  EXPECT_EQ(copied_.wide_triangles(Level{1}), 0U);
}

TEST_F(CopiedChunksTest, WhatIsStoredIsThereInAnotherProcess) {
  copy(80'000, 1);
  copy(75'001, 2);
  add({{75'000, 75'001, 75'002}}, {{{75'000, 149'999, 80'000}, {0, 2, 0}}});
  std::vector<nlohmann::json> stored;
  for (std::uint32_t c = 0; c < 4; ++c)
    stored.push_back(copied_.store(c));
  Chunks restored(tree_, 1, true, scratch_, 4096);
  for (std::uint32_t c = 0; c < 4; ++c) {
    ASSERT_TRUE(restored.restore(c, stored[c])) << c;
    EXPECT_TRUE(restored.is_as_stored(c)) << c;
    const partition::ChunkMesh before = copied_.take(c), after = restored.take(c);
    EXPECT_EQ(after.vertices.positions, before.vertices.positions);
    EXPECT_EQ(after.triangles, before.triangles);
    EXPECT_EQ(after.wedges, before.wedges);
    EXPECT_EQ(after.copies.places, before.copies.places);
    EXPECT_EQ(after.copies.vertices.positions, before.copies.vertices.positions);
    EXPECT_EQ(after.copies.vertices.attributes, before.copies.vertices.attributes);
    EXPECT_EQ(after.copies.empty(), c != 1);
  }
}

TEST_F(CopiedChunksTest, CopiesAndTheirTrianglesThatChangedOnDiskAreNotAsStored) {
  copy(80'000, 1);
  add({}, {{{75'000, 149'999, 80'000}, {0, 2, 0}}});
  const nlohmann::json stored = copied_.store(1);
  ASSERT_EQ(stored.size(), 5U);
  for (const std::size_t spool : {0, 3, 4}) {  // the others are empty
    nlohmann::json other = stored;
    other[spool][1] = other[spool][1].get<std::uint64_t>() ^ 1;  // the checksum
    Chunks restored(tree_, 1, true, scratch_, 4096);
    ASSERT_TRUE(restored.restore(1, other));
    EXPECT_FALSE(restored.is_as_stored(1)) << spool;
  }
  nlohmann::json short_of_copies = stored;
  short_of_copies.erase(3);
  EXPECT_THROW((void)Chunks(tree_, 1, true, scratch_, 4096).restore(1, short_of_copies),
               nlohmann::json::exception);
}

TEST_F(CopiedChunksTest, WhatIsDroppedIsForgotten) {
  copy(80'000, 1);
  add({}, {{{75'000, 149'999, 80'000}, {0, 2, 0}}});
  copied_.drop(1);
  EXPECT_EQ(copied_.triangle_count(1), 0U);
  EXPECT_EQ(copied_.triangle_bytes(1), 0U);
}

}  // namespace
}  // namespace meshhier::pipeline

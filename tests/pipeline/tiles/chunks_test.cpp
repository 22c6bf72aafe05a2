#include "pipeline/tiles/chunks.h"

#include "pipeline/plan/tile_room.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <memory>
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
  Chunks chunks_{tree_, 1, scratch_, 4096};
};

TEST_F(ChunksTest, VerticesKeepTheirOrderWithinTheirChunk) {
  ASSERT_EQ(chunks_.count(), 4U);
  ChunkedVertices block;
  for (std::uint32_t first = 0; first < 300'000; first += 1000) {
    std::vector<Vec3f> positions;
    std::vector<float> attributes;
    block.chunk_of.clear();
    for (std::uint32_t id = first; id < first + 1000; ++id) {
      positions.push_back({static_cast<float>(id), 1, 2});
      attributes.push_back(static_cast<float>(id) + 0.5F);
      block.chunk_of.push_back(id * 7 % 4);
    }
    block.sort(4, positions, attributes);
    chunks_.append(block);
  }
  for (std::uint32_t c = 0; c < 4; ++c) {
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
    chunks_.append(none);
    return chunks_.take(chunk).triangles;
  };
  EXPECT_THAT(triangles(0), UnorderedElementsAre(two, two_apart, three));
  EXPECT_THAT(triangles(1), UnorderedElementsAre(inner, inner, two, three));
  EXPECT_THAT(triangles(2), ElementsAre(three));
  EXPECT_THAT(triangles(3), ElementsAre(two_apart));
}

}  // namespace
}  // namespace meshhier::pipeline

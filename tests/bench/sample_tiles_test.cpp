#include "bench/sample_tiles.h"

#include "tests/bench/collected.h"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

std::unique_ptr<GeneratedMesh> torus() {
  SurfaceOptions options;
  options.shape = BaseShape::torus;
  options.triangles = 8000;
  options.noise = 0.2;
  return make_surface(options);
}

using Place = std::array<float, 9>;

Place place_of(Vec3f a, Vec3f b, Vec3f c) {
  std::array<std::array<float, 3>, 3> corners{{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}};
  std::ranges::rotate(corners, std::ranges::min_element(corners));
  Place place;
  for (std::size_t k = 0; k < 9; ++k)
    place[k] = corners[k / 3][k % 3];
  return place;
}

std::vector<Place> places_of(const BuildTile& tile) {
  const auto& positions = tile.mesh.vertices.positions;
  std::vector<Place> places;
  for (const auto* list : {&tile.mesh.interior, &tile.mesh.border}) {
    for (const auto& [a, b, c] : *list)
      places.push_back(place_of(positions.at(raw(a)), positions.at(raw(b)), positions.at(raw(c))));
  }
  std::ranges::sort(places);
  return places;
}

/// The triangles of `sample` with a corner in one of the partitions [first, last].
std::vector<Place> expected(const SampleChunk& sample, partition::Axis axis, std::uint32_t first,
                            std::uint32_t last) {
  const auto partition_of = partition::split_chunk(sample.chunk, sample.tree, axis);
  const auto inside = [&](std::uint32_t v) {
    return raw(partition_of[v]) >= first && raw(partition_of[v]) <= last;
  };
  const auto& positions = sample.chunk.vertices.positions;
  std::vector<Place> places;
  for (const auto& t : sample.chunk.triangles) {
    if (std::ranges::any_of(t, inside))
      places.push_back(place_of(positions[t[0]], positions[t[1]], positions[t[2]]));
  }
  std::ranges::sort(places);
  return places;
}

TEST(SampleTilesTest, ResolvedTilesAreTheMeshAroundTheirPartitions) {
  const SampleChunk sample(*torus(), 500);
  const SampleTiles tiles(sample, partition::Axis::compactness);
  ASSERT_EQ(tiles.count(), sample.tree.partition_count());
  ASSERT_GE(tiles.count(), 8U);
  for (std::uint32_t p = 0; p < tiles.count(); ++p) {
    const BuildTile tile = tiles.resolved(p);
    EXPECT_LE(tile.mesh.own_count, 500U);
    EXPECT_EQ(tile.mesh.vertices.size(), tile.mesh.own_count + tile.mesh.ghosts.size());
    EXPECT_EQ(places_of(tile), expected(sample, partition::Axis::compactness, p, p)) << p;
  }
}

TEST(SampleTilesTest, JoinedPairsAreTheMeshAroundBoth) {
  const SampleChunk sample(*torus(), 500);
  const SampleTiles tiles(sample, partition::Axis::longest);
  for (std::uint32_t pair = 0; 2 * pair + 1 < tiles.count(); ++pair) {
    const BuildTile joined = joined_pair(tiles, pair);
    EXPECT_EQ(joined.mesh.own_count,
              tiles.work(2 * pair).vertices.size() + tiles.work(2 * pair + 1).vertices.size());
    EXPECT_EQ(places_of(joined),
              expected(sample, partition::Axis::longest, 2 * pair, 2 * pair + 1));
    EXPECT_FALSE(joined.mesh.border.empty());
  }
}

}  // namespace
}  // namespace meshhier::bench

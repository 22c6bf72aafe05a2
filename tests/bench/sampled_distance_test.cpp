#include "bench/sampled_distance.h"

#include "hierarchy/error.h"
#include "tests/bench/plain.h"

#include <cmath>

#include <gtest/gtest.h>

namespace meshhier::bench {
namespace {

PlainMesh raised(PlainMesh mesh, float height) {
  for (Vec3f& p : mesh.positions)
    p.z += height;
  return mesh;
}

TEST(SampledDistanceTest, ParallelPlanesAreAsFarAsTheyAre) {
  const PlainMesh low = plain(tests::open_grid(7, 5));
  const PlainMesh high = raised(low, 0.5F);
  const Distances distances = SearchableSurface(low).distances_from(high, 1000);
  EXPECT_NEAR(distances.mean, 0.5, 1e-12);
  EXPECT_NEAR(distances.rms, 0.5, 1e-12);
  EXPECT_NEAR(distances.max, 0.5, 1e-12);
}

TEST(SampledDistanceTest, ASurfaceIsAtItself) {
  const PlainMesh mesh = plain(tests::torus(2000, 0.01F));
  EXPECT_LT(SearchableSurface(mesh).distances_from(mesh, 5000).max, 1e-7);
}

TEST(SampledDistanceTest, TheTwoDirectionsDiffer) {
  const PlainMesh small = plain(tests::open_grid(2, 2));
  const PlainMesh large = plain(tests::open_grid(20, 2));
  EXPECT_LT(SearchableSurface(large).distances_from(small, 1000).max, 1e-12);
  const Distances outward = SearchableSurface(small).distances_from(large, 2000);
  EXPECT_NEAR(outward.max, 18, 0.05);
  EXPECT_NEAR(outward.mean, 18.0 * 18 / 2 / 20, 0.05);
}

/// A quarter of the area at height 1, the rest at height 0; the small triangles are many.
TEST(SampledDistanceTest, SamplesAreSpreadByArea) {
  const PlainMesh ground = plain(tests::open_grid(40, 40));
  PlainMesh mesh = raised(plain(tests::open_grid(10, 10)), 1);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{15, 0, 0}, {35, 0, 0}, {15, 30, 0}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  const Distances distances = SearchableSurface(ground).distances_from(mesh, 4000);
  EXPECT_NEAR(distances.mean, 0.25, 1e-3);  // one sample may fall to either side
  EXPECT_NEAR(distances.rms, 0.5, 1e-3);
  EXPECT_NEAR(distances.max, 1, 1e-12);
}

TEST(SampledDistanceTest, SamplesAreUniformInATriangle) {
  const PlainMesh base{{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}}};
  const PlainMesh upright{{{0, 0, 0}, {1, 0, 0}, {0, 0, 3}}, {{0, 1, 2}}};
  const Distances distances = SearchableSurface(base).distances_from(upright, 100'000);
  EXPECT_NEAR(distances.mean, 1, 0.01);                  // a third of the height
  EXPECT_NEAR(distances.rms, std::sqrt(9.0 / 6), 0.01);  // the mean square is a sixth of h^2
}

TEST(SampledDistanceTest, MoreSamplesFindTheSame) {
  const PlainMesh fine = plain(tests::sphere(8000));
  const PlainMesh coarse = plain(tests::sphere(500));
  const SearchableSurface surface(coarse);
  const Distances few = surface.distances_from(fine, 5000);
  const Distances many = surface.distances_from(fine, 50'000);
  EXPECT_NEAR(few.mean / many.mean, 1, 0.05);
  EXPECT_EQ(surface.distances_from(fine, 5000).mean, few.mean);
}

TEST(SampledDistanceTest, TrianglesWithoutAreaHaveNoSamples) {
  PlainMesh mesh = plain(tests::open_grid(3, 3));
  const SearchableSurface ground(mesh);
  const Distances before = ground.distances_from(raised(mesh, 2), 100);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 7}, {1, 1, 7}, {2, 2, 7}});
  mesh.triangles.insert(mesh.triangles.begin(), {first, first + 1, first + 2});
  mesh.triangles.push_back({first, first, first});
  const Distances after = ground.distances_from(raised(mesh, 2), 100);
  EXPECT_EQ(after.mean, before.mean);
  EXPECT_EQ(after.max, before.max);
}

TEST(SampledDistanceTest, WithoutAreaThereIsNoSurface) {
  const PlainMesh nothing = plain(tests::points(10));
  const PlainMesh grid = plain(tests::open_grid(1, 1));
  EXPECT_THROW(SearchableSurface{nothing}, Error);
  EXPECT_THROW(SearchableSurface(grid).distances_from(nothing, 10), Error);
}

}  // namespace
}  // namespace meshhier::bench

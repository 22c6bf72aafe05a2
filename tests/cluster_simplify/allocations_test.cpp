// A tile's work asks for memory a few times, not for each of its vertices.
#include "cluster_simplify/contraction.h"
#include "shading/own_normals.h"
#include "support/taken_memory.h"
#include "tests/cluster_simplify/test_tiles.h"
#include "tests/support/meshes.h"

#include <cmath>
#include <cstddef>
#include <functional>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

/// Makes a noisy tile, so that some stars are no discs, and normals have creases.
BuildTile rough_tile(std::size_t triangles) {
  return tests::tile_of(tests::torus(triangles, 0.6F / static_cast<float>(std::sqrt(triangles))));
}

std::size_t allocations_of(const std::function<void()>& work) {
  const std::size_t before = tests::taken_count();
  work();
  return tests::taken_count() - before;
}

/// Arrays that grow by halves or doubles are asked for some times more; nothing else may be.
void expect_as_many(const std::function<void(const BuildTile&)>& work) {
  const BuildTile small = rough_tile(4'000), large = rough_tile(32'000);
  work(small);  // some memory is taken once
  const std::size_t of_small = allocations_of([&] { work(small); });
  const std::size_t of_large = allocations_of([&] { work(large); });
  EXPECT_GT(of_small, 0U);
  EXPECT_LT(of_small, 300U);
  EXPECT_LT(of_large, of_small + 60);
}

TEST(Allocations, OfAContractionAreAsManyForLargeTiles) {
  expect_as_many([](const BuildTile& tile) {
    contract(tile, tile.mesh.own_count / 2, {}, ContractionOptions{});
  });
}

TEST(Allocations, OfNormalsAreAsManyForLargeTiles) {
  expect_as_many([](const BuildTile& tile) { shading::shade(tile.mesh); });
}

}  // namespace
}  // namespace meshhier::cluster_simplify

#include "cluster_simplify/collapse_driver.h"

#include "bench/stress.h"
#include "tests/cluster_simplify/test_tiles.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::cluster_simplify {
namespace {

/// Edges to vertex 0 cost nothing, others a little: everything would go into it. Counts the
/// triangles that are gone through.
class GreedyCosts {
 public:
  GreedyCosts(const CollapseMesh& mesh, std::vector<Vec3f> positions)
      : mesh_(mesh), positions_(std::move(positions)) {}

  std::span<const Vec3f> positions() const { return positions_; }
  void best(std::span<const std::uint32_t> edges, std::span<Collapse> collapses) const {
    std::transform(edges.begin(), edges.end(), collapses.begin(), [this](std::uint32_t e) {
      const auto [a, b, count] = mesh_.edge(e);
      return Collapse{std::max(a, b), std::min(a, b), cost(e), positions_[std::min(a, b)]};
    });
  }
  void costs(std::uint32_t first, std::span<float> costs) const {
    for (std::size_t i = 0; i < costs.size(); ++i)
      costs[i] = cost(first + static_cast<std::uint32_t>(i));
  }
  float price(std::uint32_t, TopologyChange) const { return 0; }
  void collapsed(const Collapse& c) {
    triangles_ += mesh_.most_triangles(c.to);
    ++collapses_;
  }

  std::uint64_t triangles() const { return triangles_; }
  std::uint64_t collapses() const { return collapses_; }

 private:
  float cost(std::uint32_t e) const {
    return mesh_.edge(e).a == 0 || mesh_.edge(e).b == 0 ? 0.0F : 1.0F;
  }

  const CollapseMesh& mesh_;
  std::vector<Vec3f> positions_;
  std::uint64_t triangles_ = 0;
  std::uint64_t collapses_ = 0;
};

/// Triangles gone through to halve the vertices of the case.
std::uint64_t triangles_gone_through(std::string_view stress_case, std::uint32_t size) {
  const bench::LoadedMesh made = bench::make_stress(stress_case, size);
  tests::TestMesh mesh;
  for (const Vec3d& p : made.positions)
    mesh.positions.push_back(to_float(p));
  mesh.triangles = made.triangles;
  const BuildTile tile = tests::tile_of(mesh);
  CollapseMesh collapsing(tile.mesh);
  GreedyCosts costs(collapsing, tile.mesh.vertices.positions);
  DeviationMeter deviation(collapsing, tile.history.weights);
  collapse_edges(collapsing, costs, deviation, tile.mesh.own_count / 2);
  EXPECT_LE(costs.collapses(), tile.mesh.own_count);
  return costs.triangles();
}

TEST(CollapseDriverTest, AVertexOfManyTrianglesTakesStepsInProportionToThem) {
  for (const std::string_view stress_case : {"hub", "book"}) {
    SCOPED_TRACE(stress_case);
    const std::uint64_t once = triangles_gone_through(stress_case, 5000);
    const std::uint64_t four_times = triangles_gone_through(stress_case, 20000);
    EXPECT_LE(four_times, 5 * once);
    EXPECT_LE(four_times, 20000U * 32U);
  }
}

TEST(CollapseDriverTest, AVertexOfSomeHundredTrianglesTakesPart) {
  EXPECT_GT(triangles_gone_through("hub", 500), 500U * 100U);
}

}  // namespace
}  // namespace meshhier::cluster_simplify

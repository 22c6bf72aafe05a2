#include "verify/edge_census.h"

#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::verifying {
namespace {

struct Counted {
  std::vector<tests::Edge> border, unbalanced;
};

/// The edges that the census finds in a cut, and those that counting all triangles at once finds.
struct Comparison {
  Counted census, direct;
};

Comparison compare(const tests::TestMesh& mesh, const tests::SampleOptions& options,
                   std::uint64_t seed, std::uint64_t memory_bytes) {
  const tests::TemporaryDirectory directory;
  const auto files = storage::make_posix_file_system();
  tests::Sample sample = tests::make_sample(mesh, options);
  tests::write_sample(*files, directory.path() / "a.hier", sample);
  const storage::HierarchyReader reader(*files, directory.path() / "a.hier");
  const Tree& tree = reader.tree();
  const auto numbered = exporting::number_vertices(
      reader, seed == 0 ? Cut::of_level(tree, tree.depth()) : exporting::random_cut(tree, seed));

  Comparison result;
  storage::MemoryPool pool(0);  // whatever spills goes to the disk
  storage::ScratchFile scratch(*files, directory.path() / "scratch", pool);
  EdgeCensus census(scratch, memory_bytes, [&](const EdgeCount& count) {
    const tests::Edge edge{count.edge.low, count.edge.high};
    if (count.is_border())
      result.census.border.push_back(edge);
    if (count.is_unbalanced())
      result.census.unbalanced.push_back(edge);
  });
  std::vector<exporting::CutTriangle> triangles;
  for (std::size_t i = 0; i < numbered.cut.size(); ++i) {
    const PublishedTile tile = reader.read_tile(numbered.cut[i]);
    const exporting::DrawnTile drawn = exporting::draw_tile(tree, numbered, i, tile);
    triangles.insert(triangles.end(), drawn.triangles.begin(), drawn.triangles.end());
    census.add(tile, numbered.base(i), drawn);
  }
  census.finish();

  result.direct.border = tests::boundary_edges(triangles);
  for (tests::Edge edge : tests::unmatched_edges(triangles)) {
    result.direct.unbalanced.push_back({std::min(edge[0], edge[1]), std::max(edge[0], edge[1])});
  }
  for (auto* edges :
       {&result.census.border, &result.census.unbalanced, &result.direct.unbalanced}) {
    std::sort(edges->begin(), edges->end());
  }
  return result;
}

TEST(EdgeCensus, CountsEveryEdgeOfACutOnce) {
  const std::vector<tests::TestMesh> meshes = {
      tests::sphere(1500),      tests::open_grid(30, 20, 0.2F), tests::moebius(900),
      tests::non_manifold(700), tests::duplicates(900),         tests::soup(200)};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const Comparison found = compare(meshes[i], {13, 14, seed % 2 == 1}, seed, 1 << 16);
      EXPECT_EQ(found.census.border, found.direct.border) << "mesh " << i << ", cut " << seed;
      EXPECT_EQ(found.census.unbalanced, found.direct.unbalanced)
          << "mesh " << i << ", cut " << seed;
    }
  }
}

}  // namespace
}  // namespace meshhier::verifying

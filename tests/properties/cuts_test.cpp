// Promise 3 on built hierarchies: every cut shows the image of the input under one map of vertices.
#include "config/config.h"
#include "export/cut_mesh.h"
#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/simplify_methods.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using tests::TestMesh;

struct Case {
  std::string name;
  TestMesh mesh;
  std::uint32_t partitions = 1;
  TargetVertexCounts tile_vertices = 4;
  std::uint64_t cuts = 1;
  config::SimplifyConfig simplify = {};  ///< its vertices are tile_vertices
};

exporting::CutTriangle smallest_first(exporting::CutTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

bool is_flat(const exporting::CutTriangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// A built hierarchy, all in memory.
class Built {
 public:
  explicit Built(const Case& c) {
    tests::write_ply(c.mesh, directory_.path() / "mesh.ply");
    config::Config config = tests::quick_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = directory_.path() / "mesh.hier";
    config.partition.count = c.partitions;
    config.simplify = c.simplify;
    config.simplify.vertices = c.tile_vertices;
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    pipeline::build_hierarchy(config, {}, {*files_, progress, cancel});
    reader_ = std::make_unique<storage::HierarchyReader>(*files_, config.output);
    for (const TileRecord& record : reader_->records()) {
      tiles_.emplace(record.node, reader_->read_tile(record.node));
    }
    const exporting::NumberedCut last =
        exporting::number_vertices(*reader_, Cut::of_level(tree(), tree().depth()));
    for (NodeId node : last.cut.nodes()) {
      for (std::uint32_t v = 0; v < tiles_.at(node).mesh.own_count; ++v)
        owners_.push_back({node, v});
    }
    originals_ = drawn(last);
  }

  const Tree& tree() const { return reader_->tree(); }
  exporting::NumberedCut numbered(Cut cut) const {
    return exporting::number_vertices(*reader_, std::move(cut));
  }

  /// The input's triangles, corners as numbers of the cut of all partitions.
  const std::vector<exporting::CutTriangle>& originals() const { return originals_; }

  /// Returns the triangles that the tiles of a cut draw.
  std::vector<exporting::CutTriangle> drawn(const exporting::NumberedCut& shown) const {
    std::vector<exporting::CutTriangle> all;
    for (std::size_t i = 0; i < shown.cut.size(); ++i) {
      for (const exporting::CutTriangle& t :
           exporting::draw_tile(tree(), shown, i, tiles_.at(shown.cut[i])).triangles) {
        all.push_back(smallest_first(t));
      }
    }
    tests::sort_triangles(all);
    return all;
  }

  /// Where a cut shows each original vertex: up through the parent maps, without any ghost.
  std::vector<std::uint32_t> vertex_images(const exporting::NumberedCut& shown) const {
    std::vector<std::uint32_t> images;
    for (auto [node, vertex] : owners_) {
      const auto position = shown.cut.position_of(static_cast<PartitionId>(node.index));
      while (node != shown.cut[position]) {
        vertex = tiles_.at(node).parent_map.at(vertex);
        node = tree().parent_tile(node);
      }
      images.push_back(shown.base(position) + vertex);
    }
    return images;
  }

 private:
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  std::unique_ptr<storage::HierarchyReader> reader_;
  std::map<NodeId, PublishedTile> tiles_;
  std::vector<std::pair<NodeId, std::uint32_t>> owners_;  ///< owners of the original vertices
  std::vector<exporting::CutTriangle> originals_;
};

std::vector<exporting::CutTriangle> image(const std::vector<exporting::CutTriangle>& triangles,
                                          const std::vector<std::uint32_t>& map) {
  std::vector<exporting::CutTriangle> images;
  for (const exporting::CutTriangle& t : triangles) {
    const exporting::CutTriangle corners = {map[t[0]], map[t[1]], map[t[2]]};
    if (!is_flat(corners))
      images.push_back(smallest_first(corners));
  }
  tests::sort_triangles(images);
  return images;
}

/// Triangles along an edge from its lower vertex, less those that run back, where that is not zero.
std::map<tests::Edge, std::int64_t> border(const std::vector<exporting::CutTriangle>& triangles) {
  std::map<tests::Edge, std::int64_t> net;
  for (const tests::Edge& edge : tests::unmatched_edges(triangles))
    net[edge] = 0;
  const auto count = [&](const tests::Edge& edge, std::int64_t direction) {
    for (const tests::Edge& key : {edge, tests::Edge{edge[1], edge[0]}}) {
      const auto found = net.find(key);
      if (found != net.end())
        found->second += key == edge ? direction : -direction;
    }
  };
  for (const tests::Edge& edge : tests::directed_edges(triangles))
    count(edge, 1);
  std::map<tests::Edge, std::int64_t> oriented;
  for (const auto& [edge, value] : net) {
    const bool upward = edge[0] < edge[1];
    oriented[upward ? edge : tests::Edge{edge[1], edge[0]}] = upward ? value : -value;
  }
  return oriented;
}

std::map<tests::Edge, std::int64_t> image(const std::map<tests::Edge, std::int64_t>& edges,
                                          const std::vector<std::uint32_t>& map) {
  std::map<tests::Edge, std::int64_t> images;
  for (const auto& [edge, net] : edges) {
    const std::uint32_t a = map[edge[0]], b = map[edge[1]];
    if (a < b)
      images[{a, b}] += net;
    if (b < a)
      images[{b, a}] -= net;
  }
  std::erase_if(images, [](const auto& entry) { return entry.second == 0; });
  return images;
}

void expect_seamless(const Case& c) {
  SCOPED_TRACE(c.name + ", " + std::to_string(c.partitions) + " partitions");
  const Built built(c);
  const auto original_border = border(built.originals());
  EXPECT_EQ(original_border.empty(),
            tests::is_closed(c.mesh.triangles) || c.mesh.triangles.empty());
  for (std::uint64_t seed = 0; seed < c.cuts; ++seed) {
    SCOPED_TRACE("cut " + std::to_string(seed));
    const exporting::NumberedCut shown = built.numbered(exporting::random_cut(built.tree(), seed));
    const auto map = built.vertex_images(shown);
    auto images = image(built.originals(), map);

    // Before duplicates are dropped, the border is exactly the image of the input's border.
    if (original_border.empty()) {
      ASSERT_TRUE(tests::unmatched_edges(images).empty());
    } else {
      ASSERT_EQ(border(images), image(original_border, map));
    }
    images.erase(std::unique(images.begin(), images.end()), images.end());
    auto drawn = built.drawn(shown);
    if (original_border.empty()) {
      ASSERT_TRUE(tests::boundary_edges(drawn).empty());
    }
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
    ASSERT_EQ(drawn, images);
  }
}

TEST(Cuts, SLOW_ClosedSurfacesHaveNoBorderInTwoHundredRandomCuts) {
  expect_seamless({"sphere", tests::sphere(100000, 0.01F), 200, 250, 200});
  expect_seamless({"torus", tests::torus(100000, 0.01F), 197, 400, 200});
  expect_seamless({"genus 5", tests::genus_n(5, 100000, 0.005F), 128, 390, 200});
  expect_seamless({"nested shells", tests::nested_shells(100000, 0.01F), 101, 300, 200});
}

TEST(Cuts, SLOW_ClosedSurfacesHaveNoBorderWhateverTheMethod) {
  for (const auto& [name, method] : tests::all_simplify_methods()) {
    SCOPED_TRACE(name);
    expect_seamless({"torus", tests::torus(20000, 0.02F), 67, 150, 200, method});
    expect_seamless({"nested shells", tests::nested_shells(10000, 0.01F), 33, 120, 200, method});
  }
}

TEST(Cuts, SmallTilesAndAnyNumberOfPartitions) {
  for (std::uint32_t partitions : {1U, 2U, 3U, 5U, 6U, 7U, 12U, 33U}) {
    for (std::uint32_t tile_vertices : {4U, 20U, 200U}) {
      expect_seamless({"torus", tests::torus(3000, 0.02F), partitions, tile_vertices, 40});
      expect_seamless({"shells", tests::nested_shells(3000), partitions, tile_vertices, 40});
    }
  }
}

TEST(Cuts, TilesOfOtherSizesOnEachLevel) {
  for (const std::uint32_t partitions : {5U, 33U}) {
    for (const TargetVertexCounts& tile_vertices :
         {TargetVertexCounts({300, 20, 200, 30}), TargetVertexCounts({4, 4, 4, 100})}) {
      expect_seamless({"torus", tests::torus(3000, 0.02F), partitions, tile_vertices, 40});
      expect_seamless({"shells", tests::nested_shells(3000), partitions, tile_vertices, 40});
    }
  }
}

TEST(Cuts, BordersOfOtherMeshesAreTheImagesOfTheInputs) {
  for (std::uint32_t partitions : {2U, 7U, 40U}) {
    for (std::uint32_t tile_vertices : {8U, 150U}) {
      expect_seamless({"grid", tests::open_grid(50, 40, 0.3F), partitions, tile_vertices, 40});
      expect_seamless({"moebius", tests::moebius(4000), partitions, tile_vertices, 40});
      expect_seamless({"non-manifold", tests::non_manifold(4000), partitions, tile_vertices, 40});
      expect_seamless({"soup", tests::soup(500), partitions, tile_vertices, 40});
      expect_seamless({"duplicates", tests::duplicates(3000), partitions, tile_vertices, 40});
      expect_seamless({"points", tests::points(900), partitions, tile_vertices, 5});
    }
  }
}

TEST(Cuts, VertexOrderOfTheInputDoesNotMatter) {
  const TestMesh mesh = tests::shuffled(tests::torus(20000, 0.01F), 5);
  expect_seamless({"shuffled torus", mesh, 37, 300, 40});
}

}  // namespace
}  // namespace meshhier::pipeline

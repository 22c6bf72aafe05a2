// The forest with the stages that fill it: every tile it hands out must show the image of the
// whole mesh under the composed parent maps.
#include "pipeline/tiles/forest.h"

#include "partition/chunk.h"
#include "partition/leaf_tiles.h"
#include "pipeline/simplify_stage.h"
#include "storage/io/spool.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using tests::MeshTriangle;

/// Where a vertex of the input is at some level.
struct Place {
  std::uint32_t tile = 0;
  std::uint32_t index = 0;
  friend constexpr auto operator<=>(const Place&, const Place&) = default;
};
using PlaceTriangle = std::array<Place, 3>;

std::vector<PlaceTriangle> normalized(std::vector<PlaceTriangle> triangles, bool unique) {
  std::erase_if(triangles,
                [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  for (PlaceTriangle& t : triangles)
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  std::ranges::sort(triangles);
  if (unique)
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

/// The mesh in the order of provisional ranks: along x, whatever that cuts.
tests::TestMesh ranked(const tests::TestMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t v) { return mesh.positions[v].x; });
  std::vector<std::uint32_t> rank(order.size());
  tests::TestMesh result;
  for (std::uint32_t r = 0; r < order.size(); ++r) {
    rank[order[r]] = r;
    result.positions.push_back(mesh.positions[order[r]]);
  }
  for (const MeshTriangle& t : mesh.triangles)
    result.triangles.push_back({rank[t[0]], rank[t[1]], rank[t[2]]});
  return result;
}

/// One attribute channel holds each vertex's number.
AttributeLayout numbering() {
  AttributeLayout layout;
  layout.texcoords = true;
  return layout;
}

// That of no mesh here is larger.
constexpr double kForestDiagonal = 100;

struct Setting {
  std::uint32_t partitions = 1;
  int chunk_level = 0;
  std::uint64_t pool_bytes = 0;
  std::size_t in_flight = 1;
};

class Grove {
 public:
  Grove(const tests::TestMesh& mesh, const Setting& setting)
      : mesh_(ranked(mesh)),
        pool_(setting.pool_bytes),
        scratch_(*files_, directory_.path() / "scratch", pool_),
        tree_(mesh_.positions.size(), setting.partitions),
        forest_(tree_, static_cast<Level>(setting.chunk_level), numbering(), scratch_) {
    const auto chunks = static_cast<Level>(setting.chunk_level);
    const partition::ChunkMap map(tree_, chunks);
    for (std::uint32_t c = 0; c < map.count(); ++c)
      put_chunk(c, chunks, map);
    BuildPlan plan{.tree = tree_, .target_vertex_counts = 60};
    plan.memory.work_bytes = 1 << 20;
    plan.memory.tiles_in_flight = setting.in_flight;
    const config::Config config = tests::smooth_config();
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    simplify(forest_, journal_, numbering(), {0, raw(tree_.depth())},
             {config, plan, *files_, progress, cancel});
    errors_ = add_up(journal_, tree_, kForestDiagonal);
    place_vertices();
  }

  const Tree& tree() const { return tree_; }
  const Forest& forest() const { return forest_; }
  const TileErrors& errors() const { return errors_; }
  const tests::TestMesh& mesh() const { return mesh_; }
  const std::vector<std::vector<Place>>& places() const { return places_; }

  /// The triangles that the tile of `node` must hold: with all corners in it, or with some.
  std::vector<PlaceTriangle> expected(NodeId node, bool interior) const {
    const std::vector<Place>& places = places_[raw(node.level)];
    std::vector<PlaceTriangle> result;
    for (const MeshTriangle& t : mesh_.triangles) {
      const PlaceTriangle image{places[t[0]], places[t[1]], places[t[2]]};
      const auto inside =
          std::ranges::count_if(image, [&](const Place& p) { return p.tile == node.index; });
      if (interior ? inside == 3 : inside == 1 || inside == 2)
        result.push_back(image);
    }
    return normalized(std::move(result), !tree_.is_partition(node));
  }

 private:
  void put_chunk(std::uint32_t index, Level level, const partition::ChunkMap& map) {
    partition::ChunkMesh chunk;
    chunk.node = {level, index};
    chunk.vertices.channels = 2;
    const std::uint32_t first = map.first_rank(index);
    for (std::uint32_t v = first; v < first + map.size(index); ++v) {
      const std::array<float, 2> number{static_cast<float>(v), 0};
      chunk.vertices.append(mesh_.positions[v], number);
    }
    for (const MeshTriangle& t : mesh_.triangles) {
      if (std::ranges::any_of(t, [&](std::uint32_t v) { return map.chunk_of(v) == index; }))
        chunk.triangles.push_back({t[0], t[1], t[2]});
    }
    const auto partition_of = partition::split_chunk(chunk, tree_, partition::Axis::compactness);
    const auto leaves = partition::build_leaves(chunk, partition_of, tree_, map);
    forest_.put_places(index, leaves.places);
    const std::uint32_t first_leaf = tree_.partitions(chunk.node).begin;
    for (std::uint32_t p = 0; p < leaves.tiles.size(); ++p)
      forest_.put_tile({tree_.depth(), first_leaf + p}, leaves.tiles[p]);
  }

  /// Follows the published maps from the partitions up.
  void place_vertices() {
    places_.assign(std::size_t{raw(tree_.depth())} + 1,
                   std::vector<Place>(mesh_.positions.size(), Place{UINT32_MAX, UINT32_MAX}));
    for (std::uint32_t p = 0; p < tree_.partition_count(); ++p) {
      const BuildTile tile = forest_.load({tree_.depth(), p});
      for (std::uint32_t i = 0; i < tile.mesh.own_count; ++i) {
        const auto v = static_cast<std::size_t>(tile.mesh.vertices.attributes_of(i)[0]);
        places_.back().at(v) = {p, i};
      }
    }
    for (int level = raw(tree_.depth()); level > 0; --level)
      place_above(static_cast<Level>(level));
  }

  void place_above(Level level) {
    for (std::uint32_t i = 0; i < tree_.node_count(level); ++i) {
      const NodeId node{level, i};
      const NodeId parent = tree_.parent(node);
      const bool kept = tree_.is_early(parent);
      const std::vector<std::uint16_t> map = forest_.published_parent_map(node);
      for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
        const Place place = places_[raw(level)][v];
        if (place.tile == i)
          places_[raw(level) - 1][v] = {parent.index, kept ? place.index : map.at(place.index)};
      }
    }
  }

  tests::TestMesh mesh_;
  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_;
  storage::ScratchFile scratch_;
  Tree tree_;
  Forest forest_;
  TileErrors errors_{tree_};
  Chunks chunks_{tree_, numbering().channels(), false, scratch_, 4096};
  execution::CancelToken never_;
  BuildJournal journal_{*files_, directory_.path(), {}, pool_.scratch_use(), {forest_, chunks_},
                        never_};
  std::vector<std::vector<Place>> places_;  ///< [level][vertex]
};

std::vector<PlaceTriangle> shown(NodeId node, const TileMesh& mesh,
                                 std::span<const TileTriangle> triangles) {
  const auto place = [&](TileVertex v) {
    return mesh.is_own(v) ? Place{node.index, raw(v)}
                          : Place{mesh.ghost(v).tile, mesh.ghost(v).index};
  };
  std::vector<PlaceTriangle> result;
  for (const TileTriangle& t : triangles)
    result.push_back({place(t[0]), place(t[1]), place(t[2])});
  return normalized(std::move(result), false);
}

void for_each_node(const Tree& tree, const auto& visit) {
  for (int level = 0; level <= raw(tree.depth()); ++level) {
    for (std::uint32_t i = 0; i < tree.node_count(static_cast<Level>(level)); ++i) {
      const NodeId node{static_cast<Level>(level), i};
      SCOPED_TRACE("node " + std::to_string(level) + "/" + std::to_string(i));
      visit(node);
    }
  }
}

void expect_true_image(const Grove& grove) {
  for_each_node(grove.tree(), [&](NodeId node) {
    const BuildTile tile = grove.forest().load(node);
    EXPECT_EQ(shown(node, tile.mesh, tile.mesh.interior), grove.expected(node, true));
    EXPECT_EQ(shown(node, tile.mesh, tile.mesh.border), grove.expected(node, false));
    for (std::uint32_t g = 0; g < tile.mesh.ghosts.size(); ++g) {
      const GhostRef ref = tile.mesh.ghosts[g];
      const BuildTile neighbour = grove.forest().load({node.level, ref.tile});
      const std::uint32_t v = tile.mesh.own_count + g;
      ASSERT_LT(ref.index, neighbour.mesh.boundary_count);
      ASSERT_EQ(tile.mesh.vertices.positions[v], neighbour.mesh.vertices.positions[ref.index]);
    }
  });
}

const std::vector<Setting>& settings() {
  static const std::vector<Setting> all = {
      {1, 0, 0, 1},       {2, 0, 1 << 30, 2}, {3, 0, 0, 2},       {5, 1, 0, 1},
      {8, 2, 1 << 30, 4}, {13, 1, 20000, 3},  {16, 0, 1 << 30, 1}};
  return all;
}

std::string text_of(const Setting& s) {
  return std::to_string(s.partitions) + " partitions, chunks at level " +
         std::to_string(s.chunk_level) + ", " + std::to_string(s.pool_bytes) + " bytes of memory";
}

TEST(ForestTest, EveryTileShowsTheImageOfTheMeshUnderOneMap) {
  const std::vector<std::pair<std::string, tests::TestMesh>> meshes = {
      {"sphere", tests::sphere(1000, 0.01F)},
      {"open grid", tests::open_grid(20, 20, 0.2F)},
      {"non-manifold", tests::non_manifold(600, 0.01F)},
      {"duplicates", tests::duplicates(600)},
      {"points", tests::points(300)}};
  for (const auto& [name, mesh] : meshes) {
    for (const Setting& setting : settings()) {
      SCOPED_TRACE(name + ", " + text_of(setting));
      expect_true_image(Grove(mesh, setting));
    }
  }
}

TEST(ForestTest, EveryVertexHasAPlaceAtEveryLevel) {
  const Grove grove(tests::sphere(1000, 0.01F), {13, 1, 0, 2});
  for (int level = 0; level <= raw(grove.tree().depth()); ++level) {
    for (const Place& place : grove.places()[static_cast<std::size_t>(level)]) {
      ASSERT_LT(place.tile, grove.tree().node_count(static_cast<Level>(level)));
      ASSERT_LT(place.index, grove.forest().own_count({static_cast<Level>(level), place.tile}));
    }
  }
}

TEST(ForestTest, ChainsNameAGhostsPlacesUpToBelowTheCommonAncestor) {
  for (const Setting& setting : settings()) {
    SCOPED_TRACE(text_of(setting));
    const Grove grove(tests::sphere(1000, 0.01F), setting);
    for_each_node(grove.tree(), [&](NodeId node) {
      const TileMesh mesh = grove.forest().load(node).mesh;
      const std::vector<std::uint16_t> chains = grove.forest().chains(node, mesh.ghosts);
      const std::vector<Place>& here = grove.places()[raw(node.level)];
      std::size_t at = 0;
      for (const GhostRef& ghost : mesh.ghosts) {
        const auto vertex = std::ranges::find(here, Place{ghost.tile, ghost.index}) - here.begin();
        const int length = grove.tree().chain_length(node, {node.level, ghost.tile});
        for (int step = 0; step < length; ++step, ++at) {
          const auto level = static_cast<std::size_t>(raw(node.level) - step);
          ASSERT_LT(at, chains.size());
          ASSERT_EQ(chains[at], grove.places()[level][static_cast<std::size_t>(vertex)].index);
        }
      }
      ASSERT_EQ(at, chains.size());
    });
  }
}

TEST(ForestTest, AnEarlyNodeShowsItsPartition) {
  const Grove grove(tests::sphere(1000, 0.01F), {5, 0, 0, 1});
  int early = 0;
  for_each_node(grove.tree(), [&](NodeId node) {
    if (!grove.tree().is_early(node))
      return;
    ++early;
    const NodeId child = grove.tree().children(node).nodes[0];
    const BuildTile tile = grove.forest().load(node);
    const BuildTile partition = grove.forest().load(child);
    EXPECT_EQ(grove.errors()[node].error, 0);
    EXPECT_EQ(grove.errors()[node].bound, 0);
    EXPECT_EQ(tile.mesh.interior, partition.mesh.interior);
    EXPECT_TRUE(std::equal(tile.mesh.vertices.positions.begin(),
                           tile.mesh.vertices.positions.begin() + tile.mesh.own_count,
                           partition.mesh.vertices.positions.begin()));
    EXPECT_EQ(grove.forest().published_parent_map(child),
              grove.forest().published_parent_map(node));
  });
  EXPECT_EQ(early, 3);  // 5 partitions under 4 nodes
}

TEST(ForestTest, MapsGoUpSeveralLevels) {
  const Grove grove(tests::sphere(1000, 0.01F), {5, 0, 0, 1});
  const Level last = grove.tree().depth();
  for (std::size_t v = 0; v < grove.places()[raw(last)].size(); ++v) {
    const Place& place = grove.places()[raw(last)][v];
    const NodeId partition{last, place.tile};
    for (NodeId at = grove.tree().parent_tile(partition);; at = grove.tree().parent(at)) {
      ASSERT_EQ(grove.forest().map_up(partition, at.level).at(place.index),
                grove.places()[raw(at.level)][v].index);
      if (at == grove.tree().root())
        break;
    }
  }
}

TEST(ForestTest, ErrorsAndBoundsStrictlyDecreaseFromParentToChild) {
  for (const tests::TestMesh& mesh :
       {tests::sphere(1000, 0.01F), tests::open_grid(25, 25),
        tests::TestMesh{std::vector<Vec3f>(500, Vec3f{1, 2, 3}), {}}}) {
    const Grove grove(mesh, {8, 0, 0, 2});
    for_each_node(grove.tree(), [&](NodeId node) {
      const Tree::Children children = grove.tree().children(node);
      for (const NodeId child : children.span()) {
        EXPECT_GT(grove.errors()[node].error, grove.errors()[child].error);
        EXPECT_GT(grove.errors()[node].bound, grove.errors()[child].bound);
      }
      if (grove.tree().is_partition(node)) {
        EXPECT_EQ(grove.errors()[node].error, 0);
        EXPECT_EQ(grove.errors()[node].bound, 0);
      }
    });
  }
}

TEST(ForestTest, WeightsCountTheOriginalVertices) {
  const Grove grove(tests::sphere(2000), {7, 0, 0, 2});
  for_each_node(grove.tree(), [&](NodeId node) {
    const std::vector<float> weights = grove.forest().load(node).history.weights;
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    EXPECT_EQ(sum, static_cast<double>(grove.tree().ranks(node).size()));
  });
}

TEST(ForestTest, WhereItsBytesLieDoesNotMatter) {
  const tests::TestMesh mesh = tests::torus(1500, 0.02F);
  const Grove on_disk(mesh, {13, 1, 0, 1});
  const Grove in_memory(mesh, {13, 1, 1 << 30, 5});
  for_each_node(on_disk.tree(), [&](NodeId node) {
    const BuildTile a = on_disk.forest().load(node);
    const BuildTile b = in_memory.forest().load(node);
    EXPECT_EQ(a.mesh.vertices.positions, b.mesh.vertices.positions);
    EXPECT_EQ(a.mesh.interior, b.mesh.interior);
    EXPECT_EQ(a.mesh.border, b.mesh.border);
    EXPECT_EQ(a.mesh.ghosts, b.mesh.ghosts);
    EXPECT_EQ(on_disk.forest().published_parent_map(node),
              in_memory.forest().published_parent_map(node));
  });
}

}  // namespace
}  // namespace meshhier::pipeline

#include "export/cut_mesh.h"

#include "base/error.h"
#include "export/cut_file.h"
#include "export/node_cache.h"
#include "export/random_cut.h"
#include "hierarchy/cut.h"
#include "tests/support/error_message.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::exporting {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::node;
using tests::usage_error;

TEST(RandomCut, CutsAreCutsOfMixedLevelsAndRepeatable) {
  for (std::uint32_t partitions : {1U, 2U, 3U, 5U, 8U, 13U, 100U}) {
    const Tree tree(1000, partitions);
    std::set<Level> levels;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Cut cut = random_cut(tree, seed);
      const Cut again = random_cut(tree, seed);
      EXPECT_TRUE(std::equal(cut.nodes().begin(), cut.nodes().end(), again.nodes().begin(),
                             again.nodes().end()));
      std::uint32_t covered = 0;
      for (NodeId shown : cut.nodes()) {
        EXPECT_FALSE(tree.is_early(shown));
        EXPECT_EQ(tree.partitions(shown).begin, covered);
        covered = tree.partitions(shown).end;
        levels.insert(shown.level);
      }
      EXPECT_EQ(covered, partitions);
    }
    // All levels but the root's, which alone is a cut without seams.
    if (partitions > 1) {
      EXPECT_EQ(levels.size(), std::size_t{raw(tree.depth())}) << partitions;
    }
  }
}

TEST(ParseNodes, ReadsLinesWithCommentsAndBlanks) {
  EXPECT_THAT(parse_nodes("# a cut\n1/0\r\n\n  2/2 # the third\n\t2 / 3", "cut.txt"),
              ElementsAre(node(1, 0), node(2, 2), node(2, 3)));
  EXPECT_TRUE(parse_nodes("", "cut.txt").empty());
  EXPECT_TRUE(parse_nodes("# nothing\n\n", "cut.txt").empty());
}

TEST(ParseNodes, ReadsJson) {
  EXPECT_THAT(parse_nodes(R"(  ["1/0", "2/2"] )", "cut.json"), ElementsAre(node(1, 0), node(2, 2)));
}

TEST(ParseNodes, AMarkOfUtf8IsNoNode) {
  EXPECT_THAT(parse_nodes("\xef\xbb\xbf"
                          "1/0\r\n1/1\r\n",
                          "cut.txt"),
              ElementsAre(node(1, 0), node(1, 1)));
  EXPECT_THAT(parse_nodes("\xef\xbb\xbf[\"1/0\"]", "cut.txt"), ElementsAre(node(1, 0)));
}

TEST(ParseNodes, NamesLineOrEntryOfAMistake) {
  const auto error = [](std::string_view text) {
    return usage_error([&] { parse_nodes(text, "cut.txt"); });
  };
  EXPECT_THAT(error("1/0\n# fine\n2-2\n"), HasSubstr("cut.txt: line 3: expected a node"));
  EXPECT_THAT(error("1/0\n# fine\n2-2\n"), HasSubstr("found \"2-2\""));
  EXPECT_THAT(error("1/-1"), HasSubstr("line 1"));
  EXPECT_THAT(error("1/4294967296"), HasSubstr("line 1"));
  EXPECT_THAT(error("256/0"), HasSubstr("line 1"));
  EXPECT_THAT(error("1/2/3"), HasSubstr("line 1"));
  EXPECT_THAT(error("/"), HasSubstr("line 1"));
  EXPECT_THAT(error(R"(["1/0", 7])"), HasSubstr("cut.txt: entry 2"));
  EXPECT_THAT(error(R"(["1/0", ["1/1"]])"), HasSubstr("cut.txt: entry 2"));
  EXPECT_THAT(error(R"(["1/0", "x"])"), HasSubstr("cut.txt: entry 2"));
  EXPECT_THAT(error("[1/0"), HasSubstr("expected a JSON array"));
  EXPECT_THAT(error(std::string(100000, '[')), HasSubstr("expected a JSON array"));
}

TEST(ParseNodes, ALongListTakesNoLongerThanItsLines) {
  constexpr std::size_t kLines =
      400'000;  // searching the rest of the list from each takes a minute
  std::string list;
  for (std::size_t i = 0; i < kLines; ++i)
    list += "17/123456\n";
  EXPECT_EQ(parse_nodes(list, "cut").size(), kLines);
}

TEST(ParseNodes, QuotesWithoutControlCharacters) {
  for (const std::string text : {"\x1b[2J", "[\"\\u001b[2J\"]"}) {
    try {
      parse_nodes(text, "cut");
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("\"?[2J\""));
    }
  }
}

TEST(NodeCache, KeepsTheLastUsedWithinItsLimit) {
  std::vector<std::uint32_t> loaded;
  NodeCache<int> cache(
      30,
      [&](NodeId n) {
        loaded.push_back(n.index);
        return static_cast<int>(n.index);
      },
      [](int) { return 10; });
  for (std::uint32_t i : {1U, 2U, 3U, 1U, 4U, 1U, 3U, 2U})
    EXPECT_EQ(*cache.get(node(0, i)), i);
  EXPECT_THAT(loaded, ElementsAre(1, 2, 3, 4, 2));
  EXPECT_EQ(cache.used_bytes(), 30U);
}

TEST(NodeCache, HoldsOneValueLargerThanItsLimitAndSurvivesAFailedLoad) {
  NodeCache<int> cache(
      5,
      [](NodeId n) {
        if (n.index == 9)
          throw Error(ErrorCode::corrupt, "broken");
        return static_cast<int>(n.index);
      },
      [](int) { return 10; });
  EXPECT_EQ(*cache.get(node(0, 1)), 1);
  EXPECT_THROW(cache.get(node(0, 9)), Error);
  EXPECT_EQ(*cache.get(node(0, 2)), 2);
  EXPECT_EQ(cache.used_bytes(), 10U);
}

// The mesh of a cut.

CutTriangle smallest_first(CutTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// A sample on disk, with its reader.
struct Published {
  tests::TemporaryDirectory directory;
  std::unique_ptr<storage::FileSystem> files = storage::make_posix_file_system();
  tests::Sample sample;
  storage::HierarchyReader reader;

  Published(const tests::TestMesh& mesh, const tests::SampleOptions& options)
      : sample(tests::make_sample(mesh, options)), reader(publish()) {}

  std::vector<CutTriangle> drawn(const NumberedCut& numbered) const {
    std::vector<CutTriangle> all;
    for (std::size_t i = 0; i < numbered.cut.size(); ++i) {
      const auto tile = draw_tile(reader.tree(), numbered, i, reader.read_tile(numbered.cut[i]));
      for (const CutTriangle& t : tile.triangles)
        all.push_back(smallest_first(t));
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  /// Where the cut shows an original vertex, by the sample's own book-keeping.
  std::uint32_t image(const NumberedCut& numbered, std::uint32_t rank) const {
    const auto position = numbered.cut.position_of(reader.tree().partition_of(rank));
    return numbered.base(position) + sample.local[raw(numbered.cut[position].level)][rank];
  }

  /// The image of the original mesh; `copies` keeps exact duplicates.
  std::vector<CutTriangle> images(const NumberedCut& numbered, bool copies) const {
    std::vector<CutTriangle> all;
    for (const auto& t : sample.ranked.triangles) {
      const CutTriangle corners = {image(numbered, t[0]), image(numbered, t[1]),
                                   image(numbered, t[2])};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        continue;
      all.push_back(smallest_first(corners));
    }
    std::sort(all.begin(), all.end());
    if (!copies)
      all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

 private:
  storage::HierarchyReader publish() {
    tests::write_sample(*files, directory.path() / "a.hier", sample);
    return {*files, directory.path() / "a.hier"};
  }
};

struct CutShape {
  std::string name;
  tests::TestMesh mesh;
};

std::vector<CutShape> cut_shapes() {
  return {{"sphere", tests::sphere(500)},
          {"torus", tests::torus(500)},
          {"shells", tests::nested_shells(500)},
          {"grid", tests::open_grid(15, 12, 0.2F)},
          {"moebius", tests::moebius(400)},
          {"non-manifold", tests::non_manifold(300)},
          {"soup", tests::soup(60)},
          {"duplicates", tests::duplicates(300)}};
}

TEST(CutMesh, SLOW_EveryCutShowsTheImageOfTheOriginalEachTriangleOnce) {
  for (const CutShape& shape : cut_shapes()) {
    for (std::uint32_t partitions : {1U, 2U, 3U, 6U, 13U}) {
      for (bool scatter : {false, true}) {
        const Published hierarchy(shape.mesh, {partitions, 12, scatter});
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
          const Tree& tree = hierarchy.reader.tree();
          const auto numbered = number_vertices(hierarchy.reader, random_cut(tree, seed));
          auto drawn = hierarchy.drawn(numbered);
          const auto last = std::unique(drawn.begin(), drawn.end());
          if (shape.name != "duplicates") {
            EXPECT_EQ(last, drawn.end());
          }
          drawn.erase(last, drawn.end());
          ASSERT_EQ(drawn, hierarchy.images(numbered, false))
              << shape.name << ", " << partitions << " partitions, cut " << seed;
        }
      }
    }
  }
}

TEST(CutMesh, CutsOfAClosedSurfaceHaveNoBorder) {
  for (const CutShape& shape : cut_shapes()) {
    if (!tests::is_closed(shape.mesh.triangles))
      continue;
    const Published hierarchy(shape.mesh, {11, 15, true});
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const Tree& tree = hierarchy.reader.tree();
      const auto numbered = number_vertices(hierarchy.reader, random_cut(tree, seed));
      EXPECT_TRUE(tests::boundary_edges(hierarchy.drawn(numbered)).empty()) << shape.name;
      EXPECT_TRUE(tests::unmatched_edges(hierarchy.images(numbered, true)).empty()) << shape.name;
    }
  }
}

TEST(CutMesh, TheCutOfAllPartitionsIsTheInputWithAllItsCopies) {
  for (const CutShape& shape : cut_shapes()) {
    const Published hierarchy(shape.mesh, {7, 12, false});
    const Tree& tree = hierarchy.reader.tree();
    const auto numbered = number_vertices(hierarchy.reader, Cut::of_level(tree, tree.depth()));
    EXPECT_EQ(numbered.vertex_count(), shape.mesh.positions.size());
    EXPECT_EQ(hierarchy.drawn(numbered), hierarchy.images(numbered, true)) << shape.name;
  }
}

TEST(CutMesh, FindsTheNodeOfAVertex) {
  const Published hierarchy(tests::sphere(500), {6, 12, false});
  const Tree& tree = hierarchy.reader.tree();
  const auto numbered = number_vertices(hierarchy.reader, random_cut(tree, 3));
  for (std::size_t i = 0; i < numbered.cut.size(); ++i) {
    EXPECT_EQ(numbered.position_of_vertex(numbered.base(i)), i);
    EXPECT_EQ(numbered.position_of_vertex(numbered.base(i + 1) - 1), i);
  }
}

TEST(CutMesh, AChainThatLeadsNowhereIsTold) {
  const Published hierarchy(tests::sphere(500), {4, 12, false});
  const Tree& tree = hierarchy.reader.tree();
  const auto numbered =
      number_vertices(hierarchy.reader, Cut(tree, {node(1, 0), node(2, 2), node(2, 3)}));
  PublishedTile tile = hierarchy.reader.read_tile(node(2, 2));
  std::size_t far = 0;
  while (far < tile.chains.size() && tile.chains[far].size() != 2)
    ++far;
  ASSERT_LT(far, tile.chains.size());
  tile.chains[far].back() = 12;  // the tile above has the vertices 0 to 11
  try {
    draw_tile(tree, numbered, numbered.cut.position_of(static_cast<PartitionId>(2)), tile);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_THAT(error.what(), HasSubstr("tile 2/2"));
    EXPECT_THAT(error.what(), HasSubstr("tile 1/0"));
  }
}

}  // namespace
}  // namespace meshhier::exporting

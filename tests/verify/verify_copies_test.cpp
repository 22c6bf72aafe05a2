// verify, where places have several vertices.
#include "export/tile_vertices.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"
#include "verify/verify.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::node;

class VerifyCopiesTest : public testing::Test {
 protected:
  tests::Sample make(const tests::TestMesh& mesh, std::uint32_t partitions,
                     const tests::CopiesOptions& copies = {false, true}) {
    tests::Sample sample = tests::make_sample(mesh, {partitions, 20, false, true, {}});
    tests::write_input(tests::add_copies(sample, copies), sample, input());
    return sample;
  }

  VerifyReport verify(tests::Sample& sample) {
    fs::remove_all(directory_.path() / "mesh.hier");
    tests::write_sample(*files_, directory_.path() / "mesh.hier", sample);
    VerifyOptions options;
    options.cuts = 10;
    options.input = input();
    execution::NoProgress progress;
    return verify_hierarchy(*files_, directory_.path() / "mesh.hier", options, progress,
                            execution::CancelToken());
  }

  /// Problems after something was changed in a sound sample.
  std::vector<std::string> problems_after(const std::function<void(tests::Sample&)>& change) {
    tests::Sample sample = make(tests::sphere(2000), 4);
    change(sample);
    return verify(sample).problems;
  }

  fs::path input() const { return directory_.path() / "mesh.ply"; }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

/// A tile and two copies in it: of one ghost, with different attributes, the first before the
/// other.
struct GhostCopies {
  PublishedTile& tile;
  std::size_t first;
};

GhostCopies ghost_copies(tests::Sample& sample) {
  for (PublishedTile& tile : sample.tiles) {
    const Copies& copies = tile.mesh.copies;
    for (std::size_t i = exporting::own_copy_count(tile.mesh); i + 1 < copies.size(); ++i) {
      if (copies.places[i] == copies.places[i + 1] && sample.tree.is_partition(tile.node))
        return {tile, i};
    }
  }
  throw std::runtime_error("no ghost has two copies");
}

TEST_F(VerifyCopiesTest, SoundHierarchiesOfAllKindsPass) {
  const std::vector<tests::TestMesh> meshes = {tests::sphere(1000), tests::open_grid(25, 22, 0.2F),
                                               tests::moebius(800), tests::non_manifold(600),
                                               tests::soup(150),    tests::duplicates(700),
                                               tests::points(300)};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    for (std::uint32_t partitions : {1U, 2U, 4U, 16U}) {
      for (bool equal : {false, true}) {
        for (bool flat : {false, true}) {
          tests::Sample sample = make(meshes[i], partitions, {equal, flat});
          EXPECT_THAT(verify(sample).problems, IsEmpty())
              << "mesh " << i << ", " << partitions << " partitions";
        }
      }
    }
  }
}

TEST_F(VerifyCopiesTest, AModelThatIsClosedByPlaceIsClosed) {
  tests::Sample sample = make(tests::torus(2000), 8);
  EXPECT_THAT(verify(sample).checks,
              Contains(HasSubstr("0 border edges, 0 unbalanced edges: closed and oriented")));
}

TEST_F(VerifyCopiesTest, TrianglesWithAPlaceTwiceCloseNoBorder) {
  const auto surface = [&](bool flat) {
    tests::Sample sample = make(tests::open_grid(25, 22), 8, {false, flat});
    const std::vector<std::string> checks = verify(sample).checks;
    return *std::find_if(checks.begin(), checks.end(), [](const std::string& check) {
      return check.starts_with("input surface");
    });
  };
  EXPECT_THAT(surface(true), HasSubstr("94 border edges"));
  EXPECT_EQ(surface(true), surface(false));
}

TEST_F(VerifyCopiesTest, ACopyOfAGhostThatItsTileHasNotIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                const auto [tile, copy] = ghost_copies(sample);
                tile.mesh.copies.vertices.attributes[3 * copy + 1] += 1;
              }),
              Contains(HasSubstr("are not there, or in another order")));
}

TEST_F(VerifyCopiesTest, CopiesOfAGhostInAnotherOrderAreFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                const auto [tile, copy] = ghost_copies(sample);
                std::vector<float>& values = tile.mesh.copies.vertices.attributes;
                std::swap(values[3 * copy], values[3 * copy + 3]);
              }),
              Contains(HasSubstr("are not there, or in another order")));
}

TEST_F(VerifyCopiesTest, ACopyOfAGhostWithoutABorderTriangleIsFound) {
  EXPECT_THAT(
      problems_after([](tests::Sample& sample) {
        const auto [tile, copy] = ghost_copies(sample);
        TileMesh& mesh = tile.mesh;
        for (std::size_t t = 0; t < mesh.border.size(); ++t) {
          for (std::size_t i = 0; i < 3; ++i) {
            if (raw(mesh.border[t][i]) == mesh.copies.places[copy] && mesh.border_wedges[t][i] == 2)
              mesh.border_wedges[t][i] = 0;
          }
        }
        normalize_triangles(mesh.border, mesh.border_wedges, false);
      }),
      Contains(HasSubstr("a copy of a ghost has no border triangle")));
}

TEST_F(VerifyCopiesTest, AnotherCopyThanTheInputsIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                // A copy of an own place that no other tile knows.
                TileMesh& mesh = sample.tile(node(2, 1)).mesh;
                const std::size_t copy = mesh.copies.first_of(mesh.boundary_count);
                ASSERT_LT(copy, exporting::own_copy_count(mesh));
                mesh.copies.vertices.attributes[3 * copy + 2] += 1;
              }),
              testing::ElementsAre(HasSubstr("but some are not the same"),
                                   HasSubstr("but some are not the same")));
}

TEST_F(VerifyCopiesTest, ACornerAtAnotherCopyThanTheInputsIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                TileMesh& mesh = sample.tile(node(2, 1)).mesh;
                const auto with_copy =
                    std::find_if(mesh.interior_wedges.begin(), mesh.interior_wedges.end(),
                                 [](const CornerWedges& wedges) { return wedges[0] == 1; });
                ASSERT_NE(with_copy, mesh.interior_wedges.end());
                (*with_copy)[0] = 0;
                normalize_triangles(mesh.interior, mesh.interior_wedges, false);
              }),
              Contains(HasSubstr("triangles, but some are not the same")));
}

TEST_F(VerifyCopiesTest, ALostFlatTriangleIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                PublishedTile& tile = sample.tile(node(2, 1));
                TileMesh& mesh = tile.mesh;
                const auto flat =
                    std::find_if(mesh.border.begin(), mesh.border.end(),
                                 [](const TileTriangle& t) { return is_degenerate(t); });
                ASSERT_NE(flat, mesh.border.end());
                mesh.border_wedges.erase(mesh.border_wedges.begin() + (flat - mesh.border.begin()));
                mesh.border.erase(flat);
                --sample.record(tile.node).border_count;
              }),
              Contains(HasSubstr("border triangles with tile 2/1 are not listed there")));
}

TEST_F(VerifyCopiesTest, AFlatTriangleAboveThePartitionsIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) {
                PublishedTile& tile = sample.tile(node(1, 0));
                TileMesh& mesh = tile.mesh;
                const auto place = static_cast<TileVertex>(mesh.copies.places.front());
                mesh.interior.push_back({place, place, static_cast<TileVertex>(raw(place) + 1)});
                mesh.interior_wedges.push_back({0, 1, 0});
                normalize_triangles(mesh.interior, mesh.interior_wedges, false);
                ++sample.record(tile.node).interior_count;
              }),
              Contains(HasSubstr("has a place twice, above the partitions")));
}

TEST_F(VerifyCopiesTest, ZeroAndMinusZeroAreOnePlaceButNotTheSameBits) {
  tests::TestMesh grid = tests::open_grid(30, 30);  // z is 0
  tests::Sample sample = tests::make_sample(grid, {1, 20, false, true, {}});
  tests::WedgedInput mesh = tests::add_copies(sample);
  sample.manifest.config["topology"] = "place";
  tests::write_input(mesh, sample, input());
  TileMesh& tile = sample.tile(node(0, 0)).mesh;
  tile.copies.vertices.positions.front().z = -0.0F;
  EXPECT_THAT(verify(sample).problems, Contains(HasSubstr("vertices, but some are not the same")));
  mesh.mesh.positions[tile.own_count].z = -0.0F;
  tests::write_input(mesh, sample, input());
  EXPECT_THAT(verify(sample).problems, IsEmpty());
}

TEST_F(VerifyCopiesTest, TwoPlacesOfEqualCoordinatesAreFound) {
  tests::Sample sample = make(tests::duplicates(700), 4);
  EXPECT_THAT(verify(sample).problems, IsEmpty());  // nobody says that they are one
  sample.manifest.config["topology"] = "place";
  EXPECT_THAT(verify(sample).problems, Contains(HasSubstr("different places of vertices, but")));
}

TEST_F(VerifyCopiesTest, AnotherCountOfTheInputsVerticesIsFound) {
  EXPECT_THAT(problems_after([](tests::Sample& sample) { ++sample.manifest.source.vertices; }),
              Contains(HasSubstr("source.vertices is")));
}

}  // namespace
}  // namespace meshhier::verifying

// verify and export, where tiles have computed normals.
#include "export/export.h"
#include "export/tile_vertices.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sample_shading.h"
#include "verify/verify.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::node;

class VerifyNormalsTest : public testing::Test {
 protected:
  /// Makes a sample of a mesh with copies and splits.
  tests::Sample make(const tests::TestMesh& mesh, std::uint32_t partitions) {
    tests::Sample sample = tests::make_sample(mesh, {partitions, 20, false, true, {}});
    tests::write_input(tests::add_copies(sample), sample, input());
    tests::add_shading(sample);
    return sample;
  }

  VerifyReport verify(tests::Sample& sample) {
    write(sample);
    VerifyOptions options;
    options.cuts = 5;
    options.input = input();
    execution::NoProgress progress;
    return verify_hierarchy(*files_, hierarchy(), options, progress, execution::CancelToken());
  }

  void write(tests::Sample& sample) {
    fs::remove_all(hierarchy());
    tests::write_sample(*files_, hierarchy(), sample);
  }

  /// Problems after the shading of 2/1 was changed; its files are sealed again.
  std::vector<std::string> problems_after(const std::function<void(PublishedTile&)>& change) {
    tests::Sample sample = make(tests::sphere(2000), 4);
    change(sample.tile(node(2, 1)));
    return verify(sample).problems;
  }

  fs::path input() const { return directory_.path() / "mesh.ply"; }
  fs::path hierarchy() const { return directory_.path() / "mesh.hier"; }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

void change_normal(PublishedTile& tile, std::size_t number) {
  NormalCode& code = tile.shading.normals[number];
  code = code == NormalCode{127, 0, 0, 0} ? NormalCode{0, 127, 0, 0} : NormalCode{127, 0, 0, 0};
}

/// The place of a vertex or split.
std::uint32_t place_of(const PublishedTile& tile, std::uint32_t number) {
  const VertexNumbers numbers = exporting::vertex_numbers(tile.mesh);
  const std::size_t vertices = tile.mesh.vertices.size() + tile.mesh.copies.size();
  return numbers[number < vertices ? number : tile.shading.split_of[number - vertices]].place;
}

/// Returns a corner of a border triangle that `fits`.
template <class Fits>
std::uint32_t border_corner(const PublishedTile& tile, Fits fits) {
  for (const TileTriangle& t : tile.shading.border) {
    for (const TileVertex corner : t) {
      if (fits(raw(corner)))
        return raw(corner);
    }
  }
  ADD_FAILURE() << "no such corner";
  return 0;
}

TEST_F(VerifyNormalsTest, SoundHierarchiesOfAllKindsPass) {
  const std::vector<tests::TestMesh> meshes = {
      tests::sphere(1000), tests::open_grid(25, 22, 0.2F), tests::non_manifold(600),
      tests::soup(150),    tests::duplicates(700),         tests::points(300)};
  for (const tests::TestMesh& mesh : meshes) {
    for (const std::uint32_t partitions : {1U, 2U, 4U, 16U}) {
      tests::Sample sample = make(mesh, partitions);
      EXPECT_THAT(verify(sample).problems, IsEmpty()) << partitions << " partitions";
    }
  }
}

TEST_F(VerifyNormalsTest, EarlyNodesPass) {
  for (const std::uint32_t partitions : {3U, 5U, 7U, 11U}) {
    const tests::TestMesh mesh = tests::sphere(1500);
    tests::Sample sample = tests::make_sample(mesh, {partitions, 40, false, true, {}});
    tests::add_shading(sample);
    write(sample);
    execution::NoProgress progress;
    EXPECT_THAT(
        verify_hierarchy(*files_, hierarchy(), {}, progress, execution::CancelToken()).problems,
        IsEmpty())
        << partitions;
  }
}

TEST_F(VerifyNormalsTest, NormalsThatTheConfigDoesNotAskForAreFound) {
  tests::Sample sample = make(tests::sphere(1000), 4);
  sample.manifest.config["storage"]["normals"] = "none";
  EXPECT_THAT(verify(sample).problems, Contains(HasSubstr("asks for none")));
}

TEST_F(VerifyNormalsTest, NormalsThatTheConfigAsksForAreMissed) {
  const auto problems_of = [&](const tests::TestMesh& mesh, const char* asked) {
    tests::Sample sample = tests::make_sample(mesh, {4, 20, false, true, {}});
    sample.manifest.config["storage"]["normals"] = asked;
    write(sample);
    execution::NoProgress progress;
    return verify_hierarchy(*files_, hierarchy(), {}, progress, execution::CancelToken()).problems;
  };
  EXPECT_THAT(problems_of(tests::sphere(1000), "smooth"),
              testing::ElementsAre(HasSubstr("\"storage.normals\" are not computed")));
  EXPECT_THAT(problems_of(tests::sphere(1000), "none"), IsEmpty());
  EXPECT_THAT(problems_of(tests::points(300), "smooth"), IsEmpty());
}

TEST_F(VerifyNormalsTest, AnotherNormalOfAGhostIsFound) {
  EXPECT_THAT(
      problems_after([](PublishedTile& tile) {
        ASSERT_EQ(tile.mesh.ghosts.front().tile, 0U);
        change_normal(tile, tile.mesh.own_count);
      }),
      Contains(HasSubstr("tile 2/1: of its ghosts in tile 2/0, 1 have not its normal (the first")));
}

TEST_F(VerifyNormalsTest, AnotherNormalOnTheBoundaryIsFound) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) { change_normal(tile, 0); }),
              Contains(AllOf(HasSubstr("of its ghosts in tile 2/1, 1 have not its normal"))));
}

TEST_F(VerifyNormalsTest, AnotherNormalOfACopyIsFound) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) {
                const std::size_t places = tile.mesh.vertices.size();
                change_normal(tile, border_corner(tile, [&](std::uint32_t corner) {
                                return corner >= places &&
                                       corner < places + tile.mesh.copies.size();
                              }));
              }),
              Contains(HasSubstr("of its copies and splits of vertices in tile")));
}

TEST_F(VerifyNormalsTest, AnotherNormalOfASplitIsFound) {
  for (const bool own : {false, true}) {
    const auto problems = problems_after([&](PublishedTile& tile) {
      const std::size_t vertices = tile.mesh.vertices.size() + tile.mesh.copies.size();
      change_normal(tile, border_corner(tile, [&](std::uint32_t corner) {
                      return corner >= vertices &&
                             (place_of(tile, corner) < tile.mesh.own_count) == own;
                    }));
    });
    EXPECT_THAT(problems, Contains(HasSubstr("have other normals there"))) << own;
    EXPECT_THAT(problems, Contains(AllOf(HasSubstr("of its copies and splits of vertices in tile"),
                                         HasSubstr("1 are not there"))))
        << own;
  }
}

TEST_F(VerifyNormalsTest, ACornerWithAnotherNormalIsFound) {
  // The vertex has a split and is a corner itself, so no split is without a triangle.
  EXPECT_THAT(problems_after([](PublishedTile& tile) {
                const std::size_t vertices = tile.mesh.vertices.size() + tile.mesh.copies.size();
                for (TileTriangle& t : tile.shading.border) {
                  for (TileVertex& corner : t) {
                    const auto split = std::ranges::find(tile.shading.split_of, raw(corner));
                    if (place_of(tile, raw(corner)) >= tile.mesh.own_count ||
                        split == tile.shading.split_of.end())
                      continue;
                    corner = static_cast<TileVertex>(
                        vertices + static_cast<std::size_t>(split - tile.shading.split_of.begin()));
                    return;
                  }
                }
                FAIL() << "no such corner";
              }),
              Contains(AllOf(HasSubstr("border triangles with tile 2/"),
                             HasSubstr("have other normals there"))));
}

TEST_F(VerifyNormalsTest, ASplitOfAGhostWithoutABorderTriangleIsFound) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) {
                const std::size_t vertices = tile.mesh.vertices.size() + tile.mesh.copies.size();
                const std::uint32_t split = border_corner(tile, [&](std::uint32_t corner) {
                  return corner >= vertices && place_of(tile, corner) >= tile.mesh.own_count;
                });
                for (TileTriangle& t : tile.shading.border) {
                  for (TileVertex& corner : t) {
                    if (raw(corner) == split)
                      corner = static_cast<TileVertex>(tile.shading.split_of[split - vertices]);
                  }
                }
              }),
              Contains(HasSubstr("a split of a ghost has no border triangle")));
}

TEST_F(VerifyNormalsTest, ExportsDoNotKnowThem) {
  tests::Sample shaded = make(tests::sphere(1000), 4);
  tests::Sample plain = shaded;
  plain.format.computed_normals = plain.manifest.computed_normals = false;
  for (PublishedTile& tile : plain.tiles)
    tile.shading = {};
  for (TileRecord& record : plain.records)
    record.split_count = 0;
  const auto exported = [&](tests::Sample& sample, const char* name) {
    write(sample);
    execution::NoProgress progress;
    const fs::path file = directory_.path() / name;
    exporting::export_mesh(*files_, hierarchy(), {Level{2}, file}, progress,
                           execution::CancelToken());
    return storage::read_file(*files_, file, UINT32_MAX);
  };
  EXPECT_EQ(exported(shaded, "a.ply"), exported(plain, "b.ply"));
}

}  // namespace
}  // namespace meshhier::verifying

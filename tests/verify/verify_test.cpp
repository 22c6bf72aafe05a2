#include "verify/verify.h"

#include "base/bounds.h"
#include "base/error.h"
#include "storage/format/build_name.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "storage/io/forwarding_files.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
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
using testing::Not;
using testing::SizeIs;
using tests::node;

/// Mirrors the first triangle whose mirror image is not there yet.
void mirror_one(std::vector<TileTriangle>& triangles) {
  for (TileTriangle& t : triangles) {
    const TileTriangle mirrored = {t[0], t[2], t[1]};
    if (std::find(triangles.begin(), triangles.end(), mirrored) != triangles.end())
      continue;
    t = mirrored;
    return normalize_triangles(triangles, false);
  }
  FAIL() << "every triangle has its mirror image";
}

/// A directory with a mesh and a hierarchy of it.
class VerifyTest : public testing::Test {
 protected:
  fs::path mesh_path() const { return directory_.path() / "mesh.ply"; }
  fs::path hierarchy_path() const { return directory_.path() / "mesh.hier"; }

  tests::Sample make(const tests::TestMesh& mesh, const tests::SampleOptions& options = {}) {
    tests::write_ply(mesh, mesh_path());
    return tests::make_sample(mesh, options, mesh_path());
  }

  VerifyReport verify(tests::Sample& sample, VerifyOptions options = {}) {
    fs::remove_all(hierarchy_path());
    tests::write_sample(*files_, hierarchy_path(), sample);
    return verify_again(options);
  }

  VerifyReport verify_again(VerifyOptions options = {}) {
    execution::NoProgress progress;
    return verify_hierarchy(*files_, hierarchy_path(), options, progress, execution::CancelToken());
  }

  /// Problems after something was changed in a sound sample.
  std::vector<std::string> problems_after(const std::function<void(tests::Sample&)>& change,
                                          const tests::SampleOptions& options = {
                                              6, 40, false, true, {}}) {
    tests::Sample sample = make(tests::sphere(2000), options);
    change(sample);
    return verify(sample).problems;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

/// Another build takes a hierarchy's place when its index is opened, or when it has been listed.
class ReplacingFiles final : public storage::ForwardingFiles {
 public:
  enum class When { opened, listed };
  ReplacingFiles(storage::FileSystem& others, When when, std::function<void()> replace)
      : ForwardingFiles(others), when_(when), replace_(std::move(replace)) {}

  std::unique_ptr<storage::File> open(const fs::path& path) override {
    if (when_ == When::opened && path.filename() == storage::index_path({}))
      replace_();
    return ForwardingFiles::open(path);
  }
  std::vector<fs::path> children(const fs::path& directory) override {
    std::vector<fs::path> found = ForwardingFiles::children(directory);
    if (when_ == When::listed)
      replace_();
    return found;
  }

 private:
  When when_;
  std::function<void()> replace_;
};

TEST_F(VerifyTest, AHierarchyThatIsReplacedMeanwhileIsNotCalledDamaged) {
  tests::Sample before = make(tests::sphere(2000), {16, 40, false, false, {}});
  tests::Sample after = make(tests::sphere(500), {1, 40, false, false, {}});
  const auto put = [&](tests::Sample& sample) {
    fs::remove_all(hierarchy_path());
    tests::write_sample(*files_, hierarchy_path(), sample);
  };
  for (const auto when : {ReplacingFiles::When::opened, ReplacingFiles::When::listed}) {
    put(before);
    ReplacingFiles files(*files_, when, [&] { put(after); });
    execution::NoProgress progress;
    EXPECT_THROW(verify_hierarchy(files, hierarchy_path(), {}, progress, execution::CancelToken()),
                 storage::Replaced);
  }
}

struct VerifiedShape {
  std::string name;
  tests::TestMesh mesh;
};

std::vector<VerifiedShape> sound_shapes() {
  return {{"sphere", tests::sphere(1000)},
          {"torus", tests::torus(1000)},
          {"shells", tests::nested_shells(1000)},
          {"grid", tests::open_grid(25, 22, 0.2F)},
          {"moebius", tests::moebius(800)},
          {"non-manifold", tests::non_manifold(600)},
          {"soup", tests::soup(150)},
          {"duplicates", tests::duplicates(700)},
          {"points", tests::points(300)}};
}

TEST_F(VerifyTest, SoundHierarchiesOfAllKindsPass) {
  for (const VerifiedShape& shape : sound_shapes()) {
    for (std::uint32_t partitions : {1U, 2U, 3U, 5U, 6U, 12U, 16U}) {
      for (bool scatter : {false, true}) {
        tests::Sample sample = make(shape.mesh, {partitions, 20, scatter, scatter, {}});
        VerifyOptions options;
        options.cuts = 10;
        if (!scatter)
          options.input = mesh_path();  // the mesh on disk has no colours
        EXPECT_THAT(verify(sample, options).problems, IsEmpty())
            << shape.name << ", " << partitions << " partitions";
      }
    }
  }
}

TEST_F(VerifyTest, APieceIsVerifiedByItsTilesAlone) {
  VerifyOptions left, right;
  left.region.box = BoundsD{{-9, -9, -9}, {-0.9, 9, 9}};
  right.region.box = BoundsD{{0.9, -9, -9}, {9, 9, 9}};
  for (const VerifiedShape& shape : sound_shapes()) {
    tests::Sample sample = make(shape.mesh, {12, 20, true, true, {}});
    VerifyOptions all;
    all.region.box = BoundsD{{-1e3, -1e3, -1e3}, {1e3, 1e3, 1e3}};
    const VerifyReport report = verify(sample, all);
    EXPECT_THAT(report.problems, IsEmpty()) << shape.name;
    EXPECT_THAT(report.checks.back(), HasSubstr("structure of 23 of 23 tiles")) << shape.name;
  }
  // One partition is broken on the disk: who looks elsewhere does not see it.
  tests::Sample sample = make(tests::sphere(2000), {16, 40, false, true, {}});
  EXPECT_THAT(verify(sample, left).problems, IsEmpty());
  const storage::HierarchyReader reader(*files_, hierarchy_path());
  const auto leftmost =
      std::ranges::min_element(reader.records(), {}, [&](const TileRecord& record) {
        return reader.tree().is_partition(record.node) ? record.bounds.max.x : 1e9F;
      });
  std::fstream file(storage::tile_path(hierarchy_path(), leftmost->node),
                    std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-5, std::ios::end).put('?');
  file.close();
  EXPECT_THAT(verify_again(left).problems, Not(IsEmpty()));
  EXPECT_THAT(verify_again(right).problems, IsEmpty());
  left.input = mesh_path();
  EXPECT_THROW(verify_again(left), Error);
}

TEST_F(VerifyTest, SLOW_ResultDoesNotDependOnTheBudget) {
  tests::Sample sample = make(tests::open_grid(450, 400, 0.2F), {13, 2000, false, false, {}});
  VerifyOptions options;
  options.input = mesh_path();
  options.cuts = 5;
  const VerifyReport large = verify(sample, options);
  options.memory_budget = 4 << 20;  // one tile in the cache, the table of hashes spilled
  const std::uint64_t written = files_->counters().bytes_written;
  const VerifyReport small = verify_again(options);
  EXPECT_GT(files_->counters().bytes_written, written);
  EXPECT_THAT(small.problems, IsEmpty());
  EXPECT_EQ(small.checks, large.checks);
  for (const auto& entry : fs::directory_iterator(directory_.path())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("meshhier-verify")));
  }
}

// Every tile is the neighbour of all others, and few of them fit into memory at a time.
TEST_F(VerifyTest, SLOW_TilesAreReadAFewTimesHoweverManyNeighboursTheyHave) {
  tests::Sample sample = make(tests::soup(20'000), {96, 600, false, false, {}});
  VerifyOptions options;
  options.cuts = 1;
  options.memory_budget = 1 << 20;  // a quarter of it for tiles
  tests::write_sample(*files_, hierarchy_path(), sample);
  std::uint64_t bytes = 0;
  for (const TileRecord& record : sample.records)
    bytes += fs::file_size(storage::tile_path(hierarchy_path(), record.node));
  ASSERT_GT(bytes, 4 * options.memory_budget);

  const std::uint64_t before = files_->counters().bytes_read;
  EXPECT_THAT(verify_again(options).problems, IsEmpty());
  // Its checksum, itself, as a child, for the cuts; parent maps for those below; and the sorts.
  EXPECT_LT(files_->counters().bytes_read - before, 8 * bytes);
}

TEST_F(VerifyTest, ChecksSayWhatWasFound) {
  tests::Sample sample = make(tests::sphere(1000), {6, 40, false, false, {}});
  VerifyOptions options;
  options.input = mesh_path();
  const auto checks = verify(sample, options).checks;
  EXPECT_THAT(checks, Contains(HasSubstr("files: 15 found, 11 tiles in the index")));
  EXPECT_THAT(checks, Contains(HasSubstr("structure of 11")));
  EXPECT_THAT(checks, Contains(HasSubstr("closed and oriented")));
  EXPECT_THAT(checks, Contains(HasSubstr("20 random cuts from seed 1")));
  EXPECT_THAT(checks, Contains(HasSubstr("input: 578 vertices and 1152 triangles compared")));
}

TEST_F(VerifyTest, NoHierarchyIsAnError) {
  try {
    verify_again();
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("not a hierarchy: there is no such file or directory"));
  }
}

TEST_F(VerifyTest, CancelStopsIt) {
  tests::Sample sample = make(tests::sphere(1000));
  verify(sample);
  execution::NoProgress progress;
  execution::CancelToken cancel;
  cancel.cancel();
  try {
    verify_hierarchy(*files_, hierarchy_path(), {}, progress, cancel);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

// Files.

TEST_F(VerifyTest, AFlippedBitInAnyFileIsFound) {
  tests::Sample sample = make(tests::sphere(200), {3, 20, false, false, {}});
  ASSERT_THAT(verify(sample).problems, IsEmpty());
  VerifyOptions options;
  options.cuts = 0;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(hierarchy_path())) {
    if (entry.is_regular_file())
      paths.push_back(entry.path());
  }
  ASSERT_THAT(paths, SizeIs(9));
  for (const fs::path& path : paths) {
    const auto size = fs::file_size(path);
    for (std::uintmax_t at = 0; at < size; at += std::max<std::uintmax_t>(size / 16, 1)) {
      const auto flip = [&] {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(at));
        const int byte = file.get();
        file.seekp(static_cast<std::streamoff>(at));
        file.put(static_cast<char>(byte ^ (1 << (at % 8))));
      };
      flip();
      EXPECT_THAT(verify_again(options).problems, Contains(HasSubstr(path.filename().string())))
          << path << " at " << at;
      flip();
    }
  }
  EXPECT_THAT(verify_again(options).problems, IsEmpty());
}

TEST_F(VerifyTest, MissingAndCutFilesAreNamed) {
  tests::Sample sample = make(tests::sphere(1000), {6, 40, false, false, {}});
  for (const fs::path& path :
       {storage::index_path(hierarchy_path()), storage::outline_path(hierarchy_path()),
        storage::tile_path(hierarchy_path(), node(1, 0)),
        storage::tile_path(hierarchy_path(), node(3, 4))}) {
    verify(sample);
    fs::resize_file(path, fs::file_size(path) - 1);
    EXPECT_THAT(verify_again().problems, Contains(HasSubstr(path.string()))) << "cut " << path;
    fs::remove(path);
    EXPECT_THAT(verify_again().problems, Contains(HasSubstr(path.string()))) << "missing " << path;
  }
}

TEST_F(VerifyTest, AllBrokenTilesAreListedOnce) {
  tests::Sample sample = make(tests::sphere(1000), {6, 40, false, false, {}});
  verify(sample);
  for (std::uint32_t i : {0U, 3U, 5U}) {
    fs::remove(storage::tile_path(hierarchy_path(), node(3, i)));
  }
  const auto problems = verify_again().problems;
  EXPECT_THAT(problems, SizeIs(4));
  EXPECT_THAT(problems, Contains(HasSubstr("000003.glb")));
  EXPECT_THAT(problems, Contains(HasSubstr("seams not looked at: 3 tiles cannot be read")));
}

TEST_F(VerifyTest, ExtraFilesAreNamed) {
  tests::Sample sample = make(tests::sphere(1000), {6, 40, false, false, {}});
  for (const char* name : {"note.txt", "tiles/note", "tiles/03/000006.glb", "tiles/02/000001.glb",
                           "tiles/3/000000.glb", "tiles/03/0.glb", "other/deep/file"}) {
    verify(sample);
    fs::create_directories((hierarchy_path() / name).parent_path());
    std::ofstream(hierarchy_path() / name) << "x";
    EXPECT_THAT(verify_again().problems, Contains(HasSubstr(name))) << name;
  }
}

TEST_F(VerifyTest, FilesOfTheTilesetAreMadeAgainAndCompared) {
  tests::Sample sample = make(tests::sphere(4000), {130, 20, false, false, {}});
  ASSERT_THAT(verify(sample).problems, IsEmpty());
  ASSERT_GT(sample.manifest.tileset_files, 1U);
  const auto below = storage::tileset_path(hierarchy_path(), node(5, 3));
  ASSERT_TRUE(fs::exists(below));
  std::ofstream(below, std::ios::app) << " ";
  EXPECT_THAT(verify_again().problems, ElementsAre(HasSubstr("000003.json: not the tileset")));
  fs::remove(below);
  EXPECT_THAT(verify_again().problems, ElementsAre(HasSubstr("000003.json: this file")));
}

TEST_F(VerifyTest, WrongTotalsAreFound) {
  tests::Sample sample = make(tests::sphere(1000));
  sample.manifest.source.triangles += 1;
  EXPECT_THAT(verify(sample).problems, Contains(HasSubstr("number of triangles")));
}

TEST_F(VerifyTest, ListsUpToAHundredProblems) {
  tests::Sample sample = make(tests::sphere(1000), {200, 4, false, false, {}});
  for (TileRecord& record : sample.records)
    record.error = 1;
  const auto problems = verify(sample).problems;
  ASSERT_THAT(problems, SizeIs(101));
  EXPECT_THAT(problems.back(), HasSubstr("more problems"));
}

// Structure: every change is sealed with right sizes and checksums.

TEST_F(VerifyTest, AChildWithTheErrorOfItsParentIsFound) {
  const auto problems =
      problems_after([](auto& s) { s.record(node(2, 2)).error = s.record(node(1, 1)).error; });
  EXPECT_THAT(problems, Contains(HasSubstr("tiles/02/000002.glb: error 0.5 is not below")));
}

TEST_F(VerifyTest, APartitionWithAnErrorIsFound) {
  const auto problems = problems_after([](auto& s) { s.record(node(3, 2)).error = 0.1F; });
  EXPECT_THAT(problems, Contains(HasSubstr("a partition has error")));
}

TEST_F(VerifyTest, AWrongDrawnCountIsFound) {
  const auto problems =
      problems_after([](auto& s) { s.record(node(2, 0)).drawn_border_count += 1; });
  EXPECT_THAT(problems, Contains(HasSubstr("tiles/02/000000.glb: draws")));
}

TEST_F(VerifyTest, MoreVerticesThanAskedForAreFound) {
  const auto problems = problems_after([](auto& s) { s.record(node(2, 0)).target_count = 39; });
  EXPECT_THAT(problems, Contains(HasSubstr("40 vertices, more than the 39 asked for")));
}

TEST_F(VerifyTest, ARimWithMoreThanItsBorderTrianglesUseIsSound) {
  const auto problems = problems_after([](auto& s) {
    for (NodeId where : {node(1, 0), node(3, 3)}) {
      s.tile(where).mesh.boundary_count = ++s.record(where).boundary_count;
    }
  });
  EXPECT_THAT(problems, IsEmpty());
}

TEST_F(VerifyTest, AGhostOfNoBorderTriangleIsFound) {
  const auto problems = problems_after([](auto& s) {
    PublishedTile& tile = s.tile(node(3, 3));
    const auto ghost = static_cast<TileVertex>(tile.mesh.own_count);
    const auto gone = std::erase_if(tile.mesh.border, [&](const TileTriangle& t) {
      return std::find(t.begin(), t.end(), ghost) != t.end();
    });
    s.record(node(3, 3)).border_count -= static_cast<std::uint32_t>(gone);
  });
  EXPECT_THAT(problems, Contains(HasSubstr("or a ghost has no border triangle")));
}

TEST_F(VerifyTest, AnOwnCornerOffTheBoundaryIsFound) {
  const auto problems = problems_after([](auto& s) {
    s.tile(node(2, 2)).mesh.boundary_count = --s.record(node(2, 2)).boundary_count;
  });
  EXPECT_THAT(problems, Contains(HasSubstr("tiles/02/000002.glb: ")));
}

TEST_F(VerifyTest, AMovedGhostIsFound) {
  for (NodeId where : {node(1, 0), node(2, 2), node(3, 4)}) {
    const auto problems = problems_after([&](auto& s) {
      PublishedTile& tile = s.tile(where);
      tile.mesh.vertices.positions.at(tile.mesh.own_count).x *= 0.99F;
      s.record(where).bounds = bounds_of(tile.mesh.vertices.positions);
    });
    EXPECT_THAT(problems, Contains(HasSubstr("have not its position (the first: ghost 0)")));
  }
}

TEST_F(VerifyTest, ARecolouredGhostIsFound) {
  const auto problems = problems_after([](auto& s) {
    PublishedTile& tile = s.tile(node(3, 4));
    float& red = tile.mesh.vertices.attributes.at(tile.mesh.own_count * 3U);
    red = red > 100 ? red - 1 : red + 1;
  });
  EXPECT_THAT(problems, Contains(HasSubstr("have not its attributes (the first: ghost 0)")));
}

TEST_F(VerifyTest, ABorderTriangleThatTheNeighbourDoesNotListIsFound) {
  for (NodeId where : {node(1, 0), node(2, 2), node(3, 2)}) {
    const auto problems = problems_after([&](auto& s) { mirror_one(s.tile(where).mesh.border); });
    EXPECT_THAT(problems, Contains(HasSubstr("are not listed there")));
  }
}

TEST_F(VerifyTest, AWrongChainIsFound) {
  for (NodeId where : {node(2, 2), node(3, 2), node(3, 3)}) {
    const auto problems = problems_after([&](auto& s) {
      PublishedTile& tile = s.tile(where);
      std::size_t far = 0;
      while (far < tile.chains.size() && tile.chains[far].size() == 1)
        ++far;
      ASSERT_LT(far, tile.chains.size());
      std::uint16_t& last = tile.chains[far].back();
      last = static_cast<std::uint16_t>(last == 0 ? 1 : last - 1);
    });
    EXPECT_THAT(problems, Contains(HasSubstr("have chains that are not its parent maps'")));
  }
}

TEST_F(VerifyTest, AnotherParentMapIsFound) {
  for (NodeId where : {node(1, 1), node(2, 2), node(3, 0), node(3, 2)}) {
    const auto problems = problems_after([&](auto& s) {
      auto& map = s.tile(where).parent_map;
      const auto other = std::find_if(map.begin(), map.end(), [&](auto v) { return v != map[0]; });
      ASSERT_NE(other, map.end());
      std::swap(map[0], *other);
    });
    EXPECT_THAT(problems, Not(IsEmpty())) << raw(where.level) << "/" << where.index;
  }
}

TEST_F(VerifyTest, AParentMapBeyondTheParentIsFound) {
  const auto problems = problems_after([](auto& s) { s.tile(node(3, 1)).parent_map[5] = 40; });
  EXPECT_THAT(problems, Contains(HasSubstr("leads to a vertex beyond the 40 of tile 2/0")));
}

TEST_F(VerifyTest, AVertexThatStandsForNothingIsFound) {
  const auto problems = problems_after([](auto& s) {
    for (NodeId child : {node(2, 2), node(3, 5)}) {
      for (auto& v : s.tile(child).parent_map) {
        if (v == 39)
          v = 38;
      }
    }
  });
  EXPECT_THAT(problems, Contains(HasSubstr("tile 1/1: 1 of its vertices stand for no vertex")));
}

TEST_F(VerifyTest, AHoleInASimplifiedTileIsFound) {
  for (NodeId where : {node(0, 0), node(1, 0), node(2, 2)}) {
    const auto problems = problems_after([&](auto& s) {
      s.tile(where).mesh.interior.pop_back();
      --s.record(where).interior_count;
    });
    EXPECT_THAT(problems, Contains(HasSubstr("not the image of its children: 1 triangles are "
                                             "missing, 0 are not theirs")));
  }
}

TEST_F(VerifyTest, AMirroredTriangleIsFound) {
  for (NodeId where : {node(0, 0), node(1, 0), node(2, 2)}) {
    const auto problems = problems_after([&](auto& s) { mirror_one(s.tile(where).mesh.interior); });
    EXPECT_THAT(problems, Contains(HasSubstr("not the image of its children: 1 triangles are "
                                             "missing, 1 are not theirs")));
  }
}

/// The triangle as corners (tile, vertex), the smallest first.
std::array<GhostRef, 3> corners(const PublishedTile& tile, const TileTriangle& t) {
  std::array<GhostRef, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] =
        tile.mesh.is_own(t[i]) ? GhostRef{tile.node.index, raw(t[i])} : tile.mesh.ghost(t[i]);
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

TEST_F(VerifyTest, ACrackAlongASeamIsFoundByTheProofAndInCuts) {
  // Nothing is merged, so that one lacking triangle leaves borders.
  const tests::SampleOptions unmerged{6, 5000, false, false, {}};
  const auto problems = problems_after(
      [](auto& s) {
        // From both lists, so that the neighbours agree.
        PublishedTile &left = s.tile(node(1, 0)), &right = s.tile(node(1, 1));
        const auto hole = corners(left, left.mesh.border.back());
        left.mesh.border.pop_back();
        ASSERT_EQ(std::erase_if(right.mesh.border,
                                [&](const TileTriangle& t) { return corners(right, t) == hole; }),
                  1U);
        for (NodeId side : {node(1, 0), node(1, 1)})
          --s.record(side).border_count;
        --s.record(node(1, 0)).drawn_border_count;
      },
      unmerged);
  EXPECT_THAT(problems,
              Contains(HasSubstr("tile 1/0: not the image of its children: 1 triangles")));
  EXPECT_THAT(problems,
              Contains(HasSubstr("tile 1/1: not the image of its children: 1 triangles")));
  EXPECT_THAT(problems, Contains(HasSubstr("a crack from vertex")));
}

// Losslessness.

TEST_F(VerifyTest, ADifferentInputIsFound) {
  const tests::TestMesh mesh = tests::sphere(1000);
  tests::Sample sample = make(mesh);
  ASSERT_THAT(verify(sample).problems, IsEmpty());
  VerifyOptions options;
  options.cuts = 0;
  options.input = directory_.path() / "other.ply";
  const auto problems_with = [&](const tests::TestMesh& other) {
    tests::write_ply(other, options.input.front());
    return verify_again(options).problems;
  };
  EXPECT_THAT(problems_with(mesh), IsEmpty());

  tests::TestMesh moved = mesh;
  moved.positions[7].y = std::nextafter(moved.positions[7].y, 2.0F);
  EXPECT_THAT(problems_with(moved), Contains(HasSubstr("vertices, but some are not the same")));

  tests::TestMesh turned = mesh;
  std::swap(turned.triangles[9][0], turned.triangles[9][1]);
  EXPECT_THAT(problems_with(turned), Contains(HasSubstr("triangles, but some are not the same")));
  EXPECT_THAT(problems_with(turned), Not(Contains(HasSubstr("vertices, but"))));

  tests::TestMesh fewer = mesh;
  fewer.triangles.pop_back();
  EXPECT_THAT(problems_with(fewer), Contains(HasSubstr("the partitions hold 1152")));
  EXPECT_THAT(problems_with(fewer), Contains(HasSubstr("bytes, but the hierarchy was made of")));

  const auto shuffled = problems_with(tests::shuffled(mesh, 4));
  EXPECT_THAT(shuffled, SizeIs(1));  // the same mesh, but not the same file
  EXPECT_THAT(shuffled, Contains(HasSubstr("checksum")));
}

TEST_F(VerifyTest, CopiesOfTrianglesCount) {
  tests::TestMesh mesh = tests::sphere(1000);
  tests::Sample sample = make(mesh);
  ASSERT_THAT(verify(sample).problems, IsEmpty());
  mesh.triangles[3] = mesh.triangles[4];  // one is lost, one is there twice
  VerifyOptions options;
  options.input = directory_.path() / "other.ply";
  tests::write_ply(mesh, options.input.front());
  EXPECT_THAT(verify_again(options).problems,
              Contains(HasSubstr("triangles, but some are not the same")));
}

TEST_F(VerifyTest, OtherAttributesAreFound) {
  tests::Sample sample = make(tests::sphere(1000), {5, 40, false, true, {}});
  VerifyOptions options;
  options.input = mesh_path();
  EXPECT_THAT(verify(sample, options).problems, Contains(HasSubstr("other vertex attributes")));
}

TEST_F(VerifyTest, ABrokenInputIsAnErrorOfTheInput) {
  tests::Sample sample = make(tests::sphere(1000));
  verify(sample);
  fs::resize_file(mesh_path(), fs::file_size(mesh_path()) - 5);
  VerifyOptions options;
  options.input = mesh_path();
  try {
    verify_again(options);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
  }
}

}  // namespace
}  // namespace meshhier::verifying

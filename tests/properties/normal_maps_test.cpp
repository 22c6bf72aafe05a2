// Hierarchies with normal maps: tiles above the partitions are lit as the original is.
#include "base/error.h"
#include "bench/generator.h"
#include "bench/shading_comparison.h"
#include "bench/stress.h"
#include "config/config.h"
#include "images/image_codec.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/files_of.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"
#include "tests/support/stopped_stage.h"
#include "verify/verify.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using config::Normals;
using tests::files_of;
using tests::kMiB;

/// A torus with relief: what a coarse tile has too few triangles for.
bench::SurfaceOptions rough_torus() {
  bench::SurfaceOptions options;
  options.shape = bench::BaseShape::torus;
  options.triangles = 40000;
  options.noise = 0.3;
  return options;
}

class NormalMapsTest : public testing::Test {
 protected:
  config::Config config(const bench::SurfaceOptions& options, Normals normals) {
    config::Config config = tests::quick_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = directory_.path() / "mesh.hier";
    std::filesystem::remove(config.input.front());
    bench::write_ply(*files_, {directory_.path() / "mesh.ply"}, *bench::make_surface(options));
    config.partition.vertices = 1024;
    config.simplify.vertices = 1024;
    config.storage.normals = normals;
    config.normal_map.texels = 256;
    return config;
  }

  void build(const config::Config& job) {
    execution::NoProgress progress;
    BuildOptions options;
    options.force = true;
    build_hierarchy(job, options, {*files_, progress, execution::CancelToken()});
  }

  std::vector<std::string> problems(const config::Config& job) {
    execution::NoProgress progress;
    return verifying::verify_hierarchy(*files_, job.output, {.input = job.input, .cuts = 3},
                                       progress, execution::CancelToken())
        .problems;
  }

  std::vector<bench::ShadingRow> shading(const config::Config& job) {
    const storage::HierarchyReader reader(*files_, job.output);
    return bench::compare_shading(reader, {.size = 128, .views = 3}).rows;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(NormalMapsTest, SimplifiedTilesHaveThemAndPartitionsNone) {
  config::Config job = config(rough_torus(), Normals::map);
  for (const ImageFormat format :
       {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp, ImageFormat::ktx2}) {
    job.normal_map.format.format = format;
    job.storage.compression =
        format == ImageFormat::png ? config::Compression::meshopt_zlib : config::Compression::none;
    build(job);
    const storage::HierarchyReader reader(*files_, job.output);
    EXPECT_EQ(reader.manifest().format_version(), 12);
    ASSERT_EQ(reader.manifest().normal_maps, job.normal_map.format);
    for (const TileRecord& record : reader.records()) {
      const bool is_partition = reader.tree().is_partition(record.node);
      ASSERT_NE(record.has_normal_map, is_partition);
      const PublishedTile tile = reader.read_tile(record.node);
      ASSERT_EQ(tile.normal_map.empty(), is_partition);
      if (is_partition)
        continue;
      EXPECT_EQ(tile.shading.tangents.size(), tile.shading.texcoords.size());
      EXPECT_GT(record.texel, 0);
      const images::Image map = images::decode_image(tile.normal_map.bytes, "map", 65536);
      EXPECT_EQ(map.width, record.image_width);
    }
    EXPECT_THAT(problems(job), testing::IsEmpty());
  }
}

TEST_F(NormalMapsTest, CoarseTilesAreLitAsTheOriginal) {
  build(config(rough_torus(), Normals::smooth));
  const auto without = shading(config(rough_torus(), Normals::smooth));
  const config::Config job = config(rough_torus(), Normals::map);
  build(job);
  const auto with = shading(job);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t l = 0; l + 1 < with.size(); ++l)
    EXPECT_LT(with[l].own.degrees, without[l].own.degrees * 0.7) << l;
  EXPECT_LT(with[0].own.degrees, without[0].own.degrees * 0.5);
}

TEST_F(NormalMapsTest, TheMeshIsWhatItIsWithoutThem) {
  config::Config job = config(rough_torus(), Normals::smooth);
  build(job);
  std::vector<TileMesh> meshes;
  {
    const storage::HierarchyReader reader(*files_, job.output);
    for (const TileRecord& record : reader.records())
      meshes.push_back(reader.read_tile(record.node).mesh);
  }
  job.storage.normals = Normals::map;
  build(job);
  const storage::HierarchyReader reader(*files_, job.output);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const TileMesh mesh = reader.read_tile(reader.records()[i].node).mesh;
    ASSERT_EQ(mesh.vertices.positions, meshes[i].vertices.positions);
    ASSERT_EQ(mesh.interior, meshes[i].interior);
    ASSERT_EQ(mesh.border, meshes[i].border);
  }
}

TEST_F(NormalMapsTest, NormalsColoursAndCoordinatesOfTheInputStay) {
  bench::SurfaceOptions options = rough_torus();
  options.normals = options.colours = true;
  const config::Config job = config(options, Normals::map);
  build(job);
  const storage::HierarchyReader reader(*files_, job.output);
  EXPECT_FALSE(reader.manifest().computed_normals);
  EXPECT_TRUE(reader.manifest().normal_maps);
  EXPECT_THAT(problems(job), testing::IsEmpty());
}

TEST_F(NormalMapsTest, WhereTheyDoNotPayThereAreNone) {
  bench::SurfaceOptions smooth = rough_torus();
  smooth.noise = 0;
  config::Config job = config(smooth, Normals::map_or_none);
  job.partition.vertices = 8192;
  job.simplify.vertices = 8192;
  build(job);
  EXPECT_FALSE(storage::HierarchyReader(*files_, job.output).manifest().normal_maps);
  EXPECT_THAT(problems(job), testing::IsEmpty());
  job = config(rough_torus(), Normals::map_or_none);
  build(job);
  EXPECT_TRUE(storage::HierarchyReader(*files_, job.output).manifest().normal_maps);
  EXPECT_THAT(problems(job), testing::IsEmpty());
}

TEST_F(NormalMapsTest, ByDefaultCoarseTilesAloneHaveThem) {
  EXPECT_EQ(config::Config().storage.normals, Normals::map_or_none);
  build(config(rough_torus(), Normals::map));
  const auto all = shading(config(rough_torus(), Normals::map));
  const config::Config job = config(rough_torus(), Normals::map_or_none);
  build(job);
  const storage::HierarchyReader reader(*files_, job.output);
  const Tree& tree = reader.tree();
  for (const TileRecord& record : reader.records())
    EXPECT_EQ(record.has_normal_map, raw(record.node.level) + 3 < raw(tree.depth()));
  const auto coarse = shading(job);
  for (std::size_t l = 0; l < 2; ++l)  // made from the partitions, not from the level between
    EXPECT_LT(coarse[l].own.degrees, all[l].own.degrees * 1.05) << l;
  EXPECT_THAT(problems(job), testing::IsEmpty());
}

/// A sheet of 16 x 16 bumps, each triangle twice, once reversed.
bench::LoadedMesh two_sided_bumps(std::uint64_t seed) {
  constexpr std::uint32_t kSide = 16;
  bench::LoadedMesh mesh;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const double height = 0.5 * double{tests::hash_noise(seed, i)};
    mesh.positions.push_back(
        {double(i % kSide), double(i / kSide), double(static_cast<float>(height))});
  }
  for (std::uint32_t i = 0; i + kSide + 1 < kSide * kSide; ++i) {
    if (i % kSide == kSide - 1)
      continue;
    for (const bench::MeshTriangle& t :
         {bench::MeshTriangle{i, i + 1, i + kSide + 1}, {i, i + kSide + 1, i + kSide}}) {
      mesh.triangles.push_back(t);
      mesh.triangles.push_back({t[0], t[2], t[1]});
    }
  }
  return mesh;
}

/// Returns whether a tile with a map has a neighbour of its level without.
bool has_mixed_neighbours(const storage::HierarchyReader& reader) {
  return std::ranges::any_of(reader.records(), [&](const TileRecord& record) {
    const std::vector<GhostRef> ghosts = reader.read_tile(record.node).mesh.ghosts;
    return record.has_normal_map && std::ranges::any_of(ghosts, [&](const GhostRef& ghost) {
             return !reader.record({record.node.level, ghost.tile}).has_normal_map;
           });
  });
}

TEST_F(NormalMapsTest, TilesWithAMapAndThoseBesideThemWithoutAgree) {
  config::Config job = config(rough_torus(), Normals::map_or_none);
  job.partition.vertices = 4;
  job.simplify.vertices.reset();
  job.normal_map.texels = 64;
  int mixed = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    std::filesystem::remove(job.input.front());
    bench::write_ply(*files_, {job.input.front()}, *bench::as_generated(two_sided_bumps(seed)));
    build(job);
    EXPECT_THAT(problems(job), testing::IsEmpty()) << seed;
    mixed += has_mixed_neighbours(storage::HierarchyReader(*files_, job.output)) ? 1 : 0;
  }
  EXPECT_GE(mixed, 3);
}

TEST_F(NormalMapsTest, PointsAndFewTrianglesHaveNone) {
  config::Config job = config(rough_torus(), Normals::map);
  std::ofstream(directory_.path() / "mesh.ply")
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n5 5 5\n3 0 1 2\n";
  build(job);
  EXPECT_FALSE(storage::HierarchyReader(*files_, job.output).manifest().normal_maps);
  EXPECT_THAT(problems(job), testing::IsEmpty());
}

TEST_F(NormalMapsTest, SLOW_ThreadsAndBudgetDecideNothing) {
  config::Config job = config(rough_torus(), Normals::map_or_none);
  build(job);
  const auto expected = files_of(job.output);
  for (const std::uint32_t threads : {1U, 3U}) {
    job.threads = threads;
    job.memory_budget = threads == 1 ? 80 * kMiB : 2048 * kMiB;
    build(job);
    EXPECT_EQ(files_of(job.output), expected) << threads;
  }
}

TEST_F(NormalMapsTest, SLOW_AStoppedBuildGoesOnToTheSameBytes) {
  const config::Config job = config(rough_torus(), Normals::map);
  build(job);
  const auto expected = files_of(job.output);
  std::set<std::string> stages;
  for (std::uint64_t after = 10; after < 200; after += 9) {
    std::filesystem::remove_all(job.output);
    execution::CancelToken cancel;
    tests::StoppedStage progress(cancel, after);
    try {
      build_hierarchy(job, {}, {*files_, progress, cancel});
      break;  // all steps were counted
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::interrupted) << error.what();
      stages.insert(progress.stage_name);
    }
    build(job);
    ASSERT_EQ(files_of(job.output), expected) << progress.stage_name << " " << after;
  }
  EXPECT_THAT(stages, testing::Contains("normal maps"));
}

}  // namespace
}  // namespace meshhier::pipeline

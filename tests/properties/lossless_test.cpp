// Promises 1 and 2 on built hierarchies: equal sizes, and the partitions are exactly the input.
#include "config/config.h"
#include "export/export.h"
#include "inspection/inspect.h"
#include "pipeline/build.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "verify/verify.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

class LosslessTest : public testing::Test {
 protected:
  /// Builds and expects what every hierarchy must keep.
  void expect_promises(const fs::path& input, const config::PartitionConfig& partition,
                       std::uint32_t tile_vertices) {
    config::Config config = tests::quick_config();
    config.input = input;
    config.output = directory_.path() / "mesh.hier";
    config.partition = partition;
    config.simplify.vertices = tile_vertices;
    execution::NoProgress progress;
    const execution::CancelToken cancel;
    pipeline::build_hierarchy(config, {.force = true}, {*files_, progress, cancel});

    verifying::VerifyOptions options;
    options.input = input;
    options.cuts = 5;
    EXPECT_THAT(
        verifying::verify_hierarchy(*files_, config.output, options, progress, cancel).problems,
        IsEmpty());
    const auto told = inspection::inspect_json(*files_, config.output, {});
    const auto& partitions = told["partitions"];
    EXPECT_LE(partitions["vertices_max"].get<int>() - partitions["vertices_min"].get<int>(), 1);
    if (partition.count) {
      EXPECT_EQ(partitions["count"], *partition.count);
    } else {
      EXPECT_LE(partitions["vertices_max"].get<std::uint32_t>(), partition.vertices);
    }
    EXPECT_LE(told["outline"]["bytes"].get<std::uint64_t>(), 32768U);
    EXPECT_EQ(told["levels"].back()["triangles_total"], told["source"]["triangles"]);
  }

  void expect_promises(const std::string& name, const tests::TestMesh& mesh,
                       const config::PartitionConfig& partition, std::uint32_t tile_vertices) {
    SCOPED_TRACE(name);
    const fs::path path = directory_.path() / (name + ".ply");
    tests::write_ply(mesh, path);
    expect_promises(path, partition, tile_vertices);
  }

  /// The last level as a mesh is the input again, and so makes a hierarchy of the same partitions.
  fs::path export_last_level(Level level) {
    execution::NoProgress progress;
    const fs::path output = directory_.path() / "last.ply";
    exporting::export_mesh(*files_, directory_.path() / "mesh.hier", {level, output}, progress,
                           execution::CancelToken());
    return output;
  }

  static config::PartitionConfig vertices(std::uint32_t most) {
    return {.vertices = most, .count = {}};
  }
  static config::PartitionConfig count(std::uint32_t partitions) {
    return {.vertices = 8192, .count = partitions};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(LosslessTest, MeshesOfAllKinds) {
  for (const config::PartitionConfig& partition :
       {vertices(100), vertices(4), count(1), count(7), count(64)}) {
    expect_promises("sphere", tests::sphere(3000, 0.02F), partition, 60);
    expect_promises("grid", tests::open_grid(40, 30, 0.2F), partition, 60);
    expect_promises("moebius", tests::moebius(2000), partition, 60);
    expect_promises("non-manifold", tests::non_manifold(2000), partition, 60);
    expect_promises("soup", tests::soup(300), partition, 60);
    expect_promises("points", tests::points(700), partition, 60);
    expect_promises("duplicates", tests::duplicates(2000), partition, 60);
  }
}

TEST_F(LosslessTest, AsManyPartitionsAsVertices) {
  const tests::TestMesh mesh = tests::sphere(200);
  expect_promises("sphere", mesh, count(static_cast<std::uint32_t>(mesh.positions.size())), 4);
}

TEST_F(LosslessTest, TheExportedLastLevelIsTheInputAgain) {
  const tests::TestMesh mesh = tests::duplicates(5000);
  expect_promises("duplicates", mesh, count(16), 100);
  const fs::path last = export_last_level(static_cast<Level>(4));
  expect_promises(last, count(16), 100);
}

/// Real models with attributes, open and non-manifold ones.
class LosslessModels : public LosslessTest, public testing::WithParamInterface<const char*> {};

TEST_P(LosslessModels, KeepTheirPromises) {
  const fs::path model = fs::path(MESHHIER_MODELS_DIR) / GetParam();
  if (!fs::exists(model))
    GTEST_SKIP() << "no model " << model;
  expect_promises(model, vertices(500), 500);
  expect_promises(model, count(100), 500);
}

INSTANTIATE_TEST_SUITE_P(Models, LosslessModels,
                         testing::Values("laurana_50k.ply", "horse.ply", "snowden.ply",
                                         "dragon_vrip_res4.ply", "osgb_tile.ply"),
                         [](const auto& model) {
                           const std::string name = model.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace meshhier::pipeline

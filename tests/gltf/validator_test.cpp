// The Khronos glTF validator on every kind of file the published form knows. MESHHIER_GLTF_DIR is
// the directory of validate.mjs; skipped where node or the validator is not installed.
#include "gltf/sample_hierarchy.h"
#include "storage/outline_glb.h"
#include "storage/tile_glb.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <span>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

namespace meshhier::tests {
namespace {

namespace fs = std::filesystem;

constexpr int kNotInstalled = 77;  // what validate.mjs exits with
constexpr int kNoCommand = 127;    // what the shell exits with

class GltfValidator : public testing::Test {
 protected:
  void SetUp() override {
    directory_ =
        fs::path(testing::TempDir()) / fmt::format("meshhier_gltf_{}", std::random_device{}());
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  void write(const std::string& name, std::span<const std::byte> bytes) {
    std::ofstream file(directory_ / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(file.good());
  }

  void write_tiles(const std::string& name, const SampleHierarchy& sample) {
    for (const PublishedTile& tile : sample.tiles) {
      write(fmt::format("{}_{}_{}.glb", name, raw(tile.node.level), tile.node.index),
            storage::encode_tile(tile, sample.tree, sample.format));
    }
  }

  int validate() const {
    const std::string command =
        fmt::format("node '{}/validate.mjs' '{}'", MESHHIER_GLTF_DIR, directory_.string());
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  void expect_clean() const {
    const int code = validate();
    if (code == kNoCommand)
      GTEST_SKIP() << "node is not installed";
    if (code == kNotInstalled)
      GTEST_SKIP() << "gltf-validator is not installed: npm ci in " << MESHHIER_GLTF_DIR;
    EXPECT_EQ(code, 0);
  }

 private:
  fs::path directory_;
};

TEST_F(GltfValidator, AcceptsTilesOfEveryLayout) {
  int number = 0;
  for (const AttributeLayout& layout : sample_layouts()) {
    const storage::TileFormat format{layout, {}};
    write_tiles(fmt::format("layout{}", number++), make_sample(torus(300, 0.05F), 5, format));
  }
  expect_clean();
}

TEST_F(GltfValidator, AcceptsOriginsOpenMeshesAndTilesWithoutTriangles) {
  const storage::TileFormat far{{}, {691234.56789012345, -5.4e6, 1e-300}};
  write_tiles("origin", make_sample(sphere(200), 4, far));
  write_tiles("open", make_sample(open_grid(9, 7), 3));
  write_tiles("points", make_sample(points(50), 2, {{.normals = true}, {}}));
  write_tiles("one", make_sample(points(1), 1));
  expect_clean();
}

TEST_F(GltfValidator, AcceptsAttributesThatGltfCannotSay) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const storage::TileFormat format{
      {.normals = true, .colour = ColourType::f32, .alpha = true, .texcoords = true}, {}};
  SampleHierarchy sample = make_sample(torus(200), 3, format);
  for (PublishedTile& tile : sample.tiles) {
    auto& attributes = tile.mesh.vertices.attributes;
    for (std::size_t i = 0; i < attributes.size(); i += 5) {
      attributes[i] = std::array{nan, inf, -inf, -7.0F, 1e-40F, 3e38F}[i % 6];
    }
    std::fill_n(attributes.begin(), 3, 0.0F);
  }
  write_tiles("awkward", sample);
  expect_clean();
}

TEST_F(GltfValidator, AcceptsOutlines) {
  const double low = -std::numeric_limits<double>::max();
  write("empty.glb", storage::encode_outline({}, {}));
  write("lines.glb", storage::encode_outline(
                         {{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {3, 3, 3}, {4, 4, 4}}, {0, 3, 5}}, {}));
  write("far.glb", storage::encode_outline({{{0, 0, 0}, {1, 0, 0}}, {0, 2}}, {low, 1, 2}));
  Outline large;
  large.vertices.assign(70000, Vec3f{1, 2, 3});
  large.starts = {0, 70000};
  write("large.glb", storage::encode_outline(large, {}));
  expect_clean();
}

TEST_F(GltfValidator, RefusesABrokenFile) {
  const SampleHierarchy sample = make_sample(torus(200), 2);
  std::vector<std::byte> bytes = storage::encode_tile(sample.tiles[0], sample.tree, sample.format);
  std::fill(bytes.end() - 64, bytes.end(), std::byte{0xFF});
  write("broken.glb", bytes);
  const int code = validate();
  if (code == kNoCommand || code == kNotInstalled)
    GTEST_SKIP() << "the validator is not installed";
  EXPECT_EQ(code, 1);
}

}  // namespace
}  // namespace meshhier::tests

// The Khronos glTF validator on every kind of file the published form knows, and meshoptimizer's
// decoder on compressed ones. MESHHIER_GLTF_DIR is the directory of their scripts; skipped where
// node or the package is not installed.
#include "export/export.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tile_glb.h"
#include "support/sample_copies.h"
#include "support/sample_hierarchy.h"
#include "support/sample_shading.h"
#include "support/sample_texture.h"

#include <array>
#include <cmath>
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

constexpr int kNotInstalled = 77;  // the exit status of validate.mjs
constexpr int kNoCommand = 127;    // the exit status of the shell

/// A directory of files for the scripts.
class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ =
        fs::path(testing::TempDir()) / fmt::format("meshhier_gltf_{}", std::random_device{}());
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  void write(const std::string& name, std::span<const std::byte> bytes) {
    fs::create_directories((directory_ / name).parent_path());
    std::ofstream file(directory_ / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(file.good());
  }

  void write_tiles(const std::string& folder, const std::string& name,
                   const SampleHierarchy& sample) {
    for (const PublishedTile& tile : sample.tiles) {
      write(fmt::format("{}/{}_{}_{}.glb", folder, name, raw(tile.node.level), tile.node.index),
            storage::encode_tile(tile, sample.tree, sample.format));
    }
  }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  /// The exit code of a script. `quoted`: its name and arguments, but for the outer quotes.
  static int run(const std::string& quoted) {
    const int status = std::system(fmt::format("node '{}/{}'", MESHHIER_GLTF_DIR, quoted).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  static void expect_code(int code, int expected) {
    if (code == kNoCommand)
      GTEST_SKIP() << "node is not installed";
    if (code == kNotInstalled)
      GTEST_SKIP() << "a package is not installed: npm ci in " << MESHHIER_GLTF_DIR;
    EXPECT_EQ(code, expected);
  }

 private:
  fs::path directory_;
};

class GltfValidator : public GltfFiles {
 protected:
  void write_tiles(const std::string& name, const SampleHierarchy& sample) {
    GltfFiles::write_tiles(".", name, sample);
  }
  int validate() const { return run(fmt::format("validate.mjs' '{}", path("."))); }
  void expect_clean() const { expect_code(validate(), 0); }
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

TEST_F(GltfValidator, AcceptsComputedNormalsAndSplits) {
  int number = 0;
  for (const AttributeLayout& layout : sample_layouts_without_normals()) {
    for (const auto compression : {storage::Compression::none, storage::Compression::meshopt}) {
      for (const int bits : {0, 12, 20}) {
        SampleHierarchy sample = with_copies(make_sample(torus(150, 0.05F), 3, {layout, {}}));
        if (bits > 0)
          sample = quantized(sample, bits);
        sample = shaded(sample);
        sample.format.compression = compression;
        write_tiles(fmt::format("shaded{}", number++), sample);
      }
    }
  }
  write_tiles("points", shaded(make_sample(points(50), 2)));
  expect_clean();
}

TEST_F(GltfValidator, AcceptsTexturedTiles) {
  int number = 0;
  for (const AttributeLayout& layout : sample_layouts_without_texcoords()) {
    for (const auto compression : {storage::Compression::none, storage::Compression::meshopt}) {
      SampleHierarchy sample = with_copies(make_sample(torus(150, 0.05F), 3, {layout, {}}));
      sample = textured(layout.normals ? sample : shaded(sample));
      sample.format.compression = compression;
      write_tiles(fmt::format("textured{}", number++), sample);
    }
  }
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp}) {
    for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
      for (const bool unlit : {false, true}) {
        write_tiles(
            fmt::format("picture{}", number++),
            textured(quantized(make_sample(torus(100, 0.05F), 2), 12), {format, 90, unlit}, alpha));
      }
    }
  }
  write_tiles("points", textured(make_sample(points(50), 2)));
  expect_clean();
}

TEST_F(GltfValidator, AcceptsTilesWithPicturesAndNormalMaps) {
  int number = 0;
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp}) {
    for (const auto compression : {storage::Compression::none, storage::Compression::meshopt}) {
      SampleHierarchy sample = with_relief(shaded(make_sample(torus(150, 0.05F), 3)),
                                           ImageFormat::webp, format, AlphaMode::mask);
      sample.format.compression = compression;
      write_tiles(fmt::format("relief{}", number++), sample);
    }
  }
  expect_clean();
}

TEST_F(GltfValidator, AcceptsTilesWithTablesOfObjects) {
  const AttributeLayout layout{.values = {{"object", ValueType::u32, true, true}}};
  int number = 0;
  for (const auto compression : {storage::Compression::none, storage::Compression::meshopt}) {
    SampleHierarchy sample =
        with_objects(with_copies(make_sample(torus(150, 0.05F), 3, {layout, {}})),
                     {{"height", ObjectPropertyType::number}, {"owner", ObjectPropertyType::text}});
    sample.format.compression = compression;
    write_tiles(fmt::format("objects{}", number++), sample);
  }
  expect_clean();
}

TEST_F(GltfValidator, AcceptsCompressedAndQuantizedTilesOfEveryLayout) {
  int number = 0;
  for (const AttributeLayout& layout : sample_layouts()) {
    for (const auto compression : {storage::Compression::zlib, storage::Compression::meshopt,
                                   storage::Compression::meshopt_zlib}) {
      for (const int bits : {0, 12, 20}) {
        SampleHierarchy sample = make_sample(torus(150, 0.05F), 3, {layout, {}});
        if (bits > 0)
          sample = quantized(sample, bits);
        sample.format.compression = compression;
        write_tiles(fmt::format("packed{}", number++), sample);
      }
    }
  }
  for (SampleHierarchy sample :
       {make_sample(points(50), 2), quantized(make_sample(points(1), 1), 8)}) {
    sample.format.compression = storage::Compression::meshopt;
    write_tiles(fmt::format("points{}", number++), sample);
  }
  expect_clean();
}

TEST_F(GltfValidator, AcceptsTilesWithCopies) {
  int number = 0;
  for (const AttributeLayout& layout : sample_layouts()) {
    const SampleHierarchy sample = with_copies(make_sample(open_grid(11, 13), 3, {layout, {}}));
    for (const auto compression : {storage::Compression::none, storage::Compression::meshopt}) {
      for (const int bits : {0, 12}) {
        SampleHierarchy stored = bits > 0 ? quantized(sample, bits) : sample;
        stored.format.compression = compression;
        write_tiles(fmt::format("copies{}", number++), stored);
      }
    }
  }
  write_tiles("points", with_copies(make_sample(points(50), 2)));
  expect_clean();
}

/// meshoptimizer's own decoder on compressed tiles, against their plain twins.
class MeshoptDecoder : public GltfFiles {
 protected:
  void write_twins(const std::string& name, SampleHierarchy sample, storage::Compression packed) {
    write_tiles("plain", name, sample);
    sample.format.compression = packed;
    write_tiles("packed", name, sample);
  }
  int compare() const {
    return run(fmt::format("compare.mjs' '{}' '{}", path("packed"), path("plain")));
  }
};

TEST_F(MeshoptDecoder, GivesThePlainTilesBitForBit) {
  int number = 0;
  for (const auto packed : {storage::Compression::meshopt, storage::Compression::meshopt_zlib}) {
    for (const AttributeLayout& layout : sample_layouts()) {
      const SampleHierarchy sample = make_sample(torus(300, 0.05F), 5, {layout, {}});
      write_twins(fmt::format("exact{}", number++), sample, packed);
      for (const int bits : {8, 16, 17, 23})
        write_twins(fmt::format("lattice{}", number++), quantized(sample, bits), packed);
    }
  }
  write_twins("soup", make_sample(soup(60), 3), storage::Compression::meshopt);
  write_twins("copies", with_copies(make_sample(torus(300), 3)), storage::Compression::meshopt);
  write_twins("points", make_sample(points(50), 2), storage::Compression::meshopt);
  expect_code(compare(), 0);
}

TEST_F(MeshoptDecoder, SeesOneChangedPosition) {
  SampleHierarchy sample = make_sample(torus(300), 2);
  write_tiles("plain", "a", sample);
  float& x = sample.tiles.back().mesh.vertices.positions[7].x;
  x = std::nextafter(x, 10.0F);
  sample.format.compression = storage::Compression::meshopt;
  write_tiles("packed", "a", sample);
  expect_code(compare(), 1);
}

TEST_F(GltfValidator, AcceptsExportedCuts) {
  const auto files = storage::make_posix_file_system();
  execution::NoProgress progress;
  int number = 0;
  const auto export_levels = [&](Sample& sample) {
    const fs::path hierarchy = path(fmt::format("{}.hier", number));
    write_sample(*files, hierarchy, sample);
    for (const int level : {0, 1, 2}) {
      exporting::export_mesh(*files, hierarchy,
                             {static_cast<Level>(level), path(fmt::format("cut{}.glb", number++))},
                             progress, {});
    }
    fs::remove_all(hierarchy);
  };
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp}) {
    for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
      Sample sample = make_sample(torus(300), SampleOptions{4, 40, false, true, {1, 2, 3}});
      add_copies(sample);
      add_shading(sample);
      add_textures(sample, {format, 90, alpha != AlphaMode::blend}, alpha);
      export_levels(sample);
    }
  }
  Sample plain = make_sample(torus(300), SampleOptions{4, 40, false, true, {}});
  add_copies(plain);
  export_levels(plain);
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
  expect_code(validate(), 1);
}

}  // namespace
}  // namespace meshhier::tests

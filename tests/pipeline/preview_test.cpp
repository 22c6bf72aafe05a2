// The picture that a build makes of its hierarchy.
#include "base/error.h"
#include "images/image_codec.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/index.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "storage/format/outline_glb.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tileset.h"
#include "storage/io/hash.h"
#include "tests/support/meshes.h"
#include "tests/support/quick_config.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"
#include "verify/verify.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class PreviewTest : public testing::Test {
 protected:
  fs::path hierarchy() const { return directory_.path() / "mesh.hier"; }
  fs::path preview() const { return storage::preview_path(hierarchy()); }

  config::Config config() const {
    config::Config config = tests::smooth_config();
    config.input = directory_.path() / "mesh.ply";
    config.output = hierarchy();
    config.partition.vertices = 200;
    return config;
  }

  void build(const tests::TestMesh& mesh, const config::Config& config) {
    tests::write_ply(mesh, directory_.path() / "mesh.ply");
    execution::NoProgress progress;
    build_hierarchy(config, {.force = true}, {*files_, progress, execution::CancelToken()});
  }

  std::vector<std::byte> bytes() { return storage::read_file(*files_, preview(), 1 << 20); }

  std::vector<std::string> problems() {
    execution::NoProgress progress;
    verifying::VerifyOptions options;
    options.cuts = 1;
    return verifying::verify_hierarchy(*files_, hierarchy(), options, progress,
                                       execution::CancelToken())
        .problems;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

/// The part of a picture that something covers.
double coverage(const images::Image& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.texels.size(); i += 4)
    covered += picture.texels[i] > 127 ? 1 : 0;
  return static_cast<double>(covered) / (static_cast<double>(picture.width) * picture.height);
}

TEST_F(PreviewTest, ShowsTheModelOnATransparentGround) {
  build(tests::sphere(3000), config());
  const storage::HierarchyReader reader(*files_, hierarchy());
  ASSERT_TRUE(reader.manifest().preview);
  EXPECT_EQ(reader.manifest().preview->bytes, fs::file_size(preview()));
  EXPECT_LE(fs::file_size(preview()), storage::kMostPreviewBytes);
  const images::Image picture = images::decode_image(reader.read_preview(), "preview", 1 << 20);
  EXPECT_EQ(picture.width, 512U);
  EXPECT_EQ(picture.height, 512U);
  ASSERT_EQ(picture.channels, 4U);
  EXPECT_NEAR(coverage(picture), 0.92 * 0.92 * 3.1416 / 4, 0.02);
  EXPECT_EQ(picture.at(3, 3)[3], 0);
  EXPECT_GT(picture.at(160, 160)[0], picture.at(350, 370)[0] + 40) << "lit from the upper left";
}

TEST_F(PreviewTest, SLOW_IsTheSameForAnyThreadsAndBudget) {
  config::Config one = config();
  one.threads = 1;
  one.memory_budget = 64 * tests::kMiB;
  build(tests::torus(20000, 0.1F), one);
  const auto expected = bytes();
  config::Config other = config();
  other.threads = 4;
  other.memory_budget = 4096 * tests::kMiB;
  build(tests::torus(20000, 0.1F), other);
  EXPECT_EQ(bytes(), expected);
}

TEST_F(PreviewTest, SLOW_EqualTrianglesAreDrawnOnce) {
  tests::TestMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.assign(200'000, {0, 1, 2});
  build(mesh, config());  // a minute and more if each covers the picture again
  const images::Image picture = images::decode_image(bytes(), "preview", 1 << 20);
  EXPECT_EQ(std::max(picture.width, picture.height), 512U);
}

TEST_F(PreviewTest, SLOW_LargeTrianglesWithoutNumberMakeItSmaller) {
  tests::TestMesh mesh;
  constexpr std::uint32_t kCorners = 60;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const float angle = 0.1F * static_cast<float>(i);
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0.01F * static_cast<float>(i)});
  }
  for (std::uint32_t a = 0; a < kCorners; ++a)
    for (std::uint32_t b = 0; b < a; ++b)
      for (std::uint32_t c = 0; c < b; ++c)
        mesh.triangles.push_back({a, b, c});
  build(mesh, config());
  const images::Image picture = images::decode_image(bytes(), "preview", 1 << 20);
  EXPECT_LT(picture.width, 512U);
  EXPECT_GE(picture.width, 16U);
  EXPECT_GT(coverage(picture), 0.3);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(PreviewTest, APreviewIsLeftOutIfNobodyWantsIt) {
  config::Config without = config();
  without.preview = false;
  build(tests::sphere(300), without);
  EXPECT_FALSE(fs::exists(preview()));
  EXPECT_EQ(storage::HierarchyReader(*files_, hierarchy()).manifest().preview, std::nullopt);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(PreviewTest, PointsAloneAreShown) {
  for (const std::size_t count : {1U, 50U, 3000U}) {
    build(tests::points(count), config());
    const images::Image picture = images::decode_image(bytes(), "preview", 1 << 20);
    EXPECT_GT(coverage(picture), 0) << count;
    EXPECT_THAT(problems(), IsEmpty());
  }
}

TEST_F(PreviewTest, ManifestRootAndOutlineHaveOneFirstView) {
  for (const bool with_preview : {true, false}) {
    config::Config wished = config();
    wished.preview = with_preview;
    build(tests::torus(3000, 0.1F), wished);
    const storage::HierarchyReader reader(*files_, hierarchy());
    const auto& view = reader.manifest().first_view;
    ASSERT_TRUE(view);
    EXPECT_GT(view->elevation, 0);
    EXPECT_EQ(reader.read_tile({}).first_view, view);
    EXPECT_EQ(reader.read_outline().first_view, view);
    EXPECT_EQ(reader.read_tile({Level{1}, 0}).first_view, std::nullopt);
  }
}

TEST_F(PreviewTest, TheConfigMaySayTheFirstView) {
  config::Config wished = config();
  wished.first_view = {.azimuth = -30.5, .elevation = 12};
  build(tests::torus(3000, 0.1F), wished);
  const auto from_the_left = bytes();
  const storage::HierarchyReader reader(*files_, hierarchy());
  EXPECT_EQ(reader.manifest().first_view, (Standpoint{-30.5, 12}));
  EXPECT_EQ(reader.read_tile({}).first_view, (Standpoint{-30.5, 12}));
  EXPECT_THAT(problems(), IsEmpty());
  wished.first_view = {.azimuth = 0, .elevation = 80};
  build(tests::torus(3000, 0.1F), wished);
  EXPECT_NE(bytes(), from_the_left);
}

/// As format version 6 had it.
TEST_F(PreviewTest, AHierarchyWithoutAFirstViewIsReadAsBefore) {
  build(tests::torus(3000, 0.1F), config());
  const storage::HierarchyReader reader(*files_, hierarchy());
  storage::Manifest manifest = reader.manifest();
  std::vector<TileRecord> records = reader.records();
  Outline outline = reader.read_outline();
  outline.first_view = manifest.first_view = std::nullopt;
  manifest.screen_colours = true;
  manifest.tileset_pixels.reset();
  manifest.config.erase("tileset");
  storage::TileFormat format = reader.tile_format();
  format.screen_colours = true;
  const auto rewrite = [&](NodeId node, TileRecord& record) {
    PublishedTile tile = reader.read_tile(node);
    tile.first_view.reset();
    const auto bytes = storage::encode_tile(tile, reader.tree(), format);
    manifest.total_bytes += bytes.size() - record.file_bytes;
    record.file_bytes = bytes.size();
    record.checksum = storage::checksum(bytes);
    storage::write_file(*files_, storage::tile_path(hierarchy(), node), bytes);
  };
  std::size_t i = 0;
  for (int level = 0; level <= raw(reader.tree().depth()); ++level) {
    for (std::uint32_t n = 0; n < reader.tree().node_count(static_cast<Level>(level)); ++n) {
      const NodeId node{static_cast<Level>(level), n};
      if (!reader.tree().is_early(node))
        rewrite(node, records[i++]);
    }
  }
  const auto index = storage::encode_index(records);
  manifest.index_checksum = storage::checksum(index);
  const auto lines = storage::encode_outline(outline, manifest.tile_frame());
  manifest.outline_checksum = storage::checksum(lines);
  manifest.levels = nlohmann::ordered_json::array();
  for (const auto& level : storage::summarize_levels(reader.tree(), records))
    manifest.levels.push_back(storage::to_json(level));
  manifest.total_bytes -= std::exchange(manifest.tileset_bytes, 0);
  manifest.tileset_files = 0;
  storage::write_tilesets(*files_, hierarchy(), reader.tree(), records, manifest);
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(*files_, storage::index_path(hierarchy()), index);
  storage::write_file(*files_, storage::outline_path(hierarchy()), lines);
  storage::write_file(*files_, storage::manifest_path(hierarchy()), std::as_bytes(std::span(text)));
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(PreviewTest, VerifyFindsAnotherFirstViewInTheManifest) {
  config::Config wished = config();
  wished.first_view = {.azimuth = 10, .elevation = 20};
  build(tests::sphere(1000), wished);
  storage::Manifest manifest = storage::HierarchyReader(*files_, hierarchy()).manifest();
  manifest.first_view = Standpoint{10, 21};
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(*files_, storage::manifest_path(hierarchy()), std::as_bytes(std::span(text)));
  const std::vector<std::string> found = problems();
  EXPECT_THAT(found, Contains(HasSubstr("its first view is not that of the manifest")));
  EXPECT_THAT(found, Contains(HasSubstr("\"first_view\" is not that of \"config\"")));
}

TEST_F(PreviewTest, VerifyNamesAPreviewThatIsMissingCutOrAnother) {
  build(tests::sphere(1000), config());
  ASSERT_THAT(problems(), IsEmpty());
  const auto whole = bytes();
  fs::remove(preview());
  EXPECT_THAT(problems(), Contains(HasSubstr(preview().string())));
  storage::write_file(*files_, preview(), std::span(whole).first(whole.size() - 1));
  EXPECT_THAT(problems(), Contains(HasSubstr(preview().string())));
  auto changed = whole;
  changed[whole.size() / 2] ^= std::byte{1};
  storage::write_file(*files_, preview(), changed);
  EXPECT_THAT(problems(), Contains(HasSubstr(preview().string())));
}

/// A file that the manifest seals, but no picture or one of another size, is a problem too.
TEST_F(PreviewTest, VerifyDecodesIt) {
  build(tests::sphere(1000), config());
  const auto with_preview = [&](std::vector<std::byte> file, std::uint32_t width) {
    const auto path = storage::manifest_path(hierarchy());
    storage::Manifest manifest = storage::HierarchyReader(*files_, hierarchy()).manifest();
    manifest.total_bytes += file.size() - manifest.preview->bytes;
    manifest.preview = storage::Preview{width, 512, file.size(), storage::checksum(file)};
    const std::string text = storage::to_json_text(manifest);
    storage::write_file(*files_, preview(), file);
    storage::write_file(*files_, path, std::as_bytes(std::span(text)));
    return problems();
  };
  const auto good = bytes();
  EXPECT_THAT(with_preview(good, 512), IsEmpty());
  EXPECT_THAT(with_preview(good, 511), Contains(HasSubstr("the manifest says 511 x 512")));
  EXPECT_THAT(with_preview(std::vector<std::byte>(100), 512),
              Contains(HasSubstr(preview().string())));
  EXPECT_THAT(with_preview({}, 512), Contains(HasSubstr(preview().string())));
}

TEST_F(PreviewTest, VerifyMissesOneThatTheConfigAskedFor) {
  build(tests::sphere(1000), config());
  storage::Manifest manifest = storage::HierarchyReader(*files_, hierarchy()).manifest();
  manifest.total_bytes -= manifest.preview->bytes;
  manifest.preview.reset();
  const std::string text = storage::to_json_text(manifest);
  storage::write_file(*files_, storage::manifest_path(hierarchy()), std::as_bytes(std::span(text)));
  const std::vector<std::string> found = problems();
  EXPECT_THAT(found, Contains(HasSubstr("preview\" is false, expected true")));
  EXPECT_THAT(found, Contains(HasSubstr("not a file of this hierarchy")));
}

}  // namespace
}  // namespace meshhier::pipeline

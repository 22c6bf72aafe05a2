// Pictures of textured levels against those of their input.
#include "bench/texture_comparison.h"

#include "base/error.h"
#include "bench/textured_files.h"
#include "images/image_codec.h"
#include "render/camera.h"
#include "render/directions.h"
#include "render/shade.h"
#include "tests/support/error_message.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sample_texture.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

namespace meshhier::bench {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

images::Image grey(std::uint32_t side, std::uint8_t value, std::uint32_t channels = 3) {
  images::Image image(side, side, channels);
  std::fill(image.texels.begin(), image.texels.end(), value);
  return image;
}

// ---- ratios --------------------------------------------------------------------------------

TEST(PeakRatioTest, IsThatOfPixelsThatBothCover) {
  images::Image a = grey(4, 100, 4), b = grey(4, 110, 4);
  EXPECT_EQ(peak_ratio(a, b), std::nullopt);
  for (std::size_t i = 3; i < a.texels.size(); i += 4)
    a.texels[i] = b.texels[i] = 255;
  EXPECT_NEAR(peak_ratio(a, b).value(), 20 * std::log10(255.0 / 10), 1e-9);
  EXPECT_TRUE(std::isinf(peak_ratio(a, a).value()));
  a.at(0, 0)[3] = 254;  // not whole, and so left out
  a.at(0, 0)[0] = 0;
  EXPECT_NEAR(peak_ratio(a, b).value(), 20 * std::log10(255.0 / 10), 1e-9);
}

// ---- levels --------------------------------------------------------------------------------

/// All tiles show one colour, exactly.
class TextureComparisonTest : public testing::Test {
 protected:
  TextureComparisonTest() : sample_(tests::make_sample(tests::torus(2000))) {
    tests::add_textures(sample_, {ImageFormat::png});
    for (PublishedTile& tile : sample_.tiles) {
      if (!tile.image.empty())
        tile.image.bytes = images::encode_image(shown(), ImageFormat::png, 100);
    }
    for (TileRecord& record : sample_.records)
      record.error = 0.02F * static_cast<float>(raw(sample_.tree.depth()) - raw(record.node.level));
    tests::write_sample(*files_, directory_.path() / "a.hier", sample_);
    reader_.emplace(*files_, directory_.path() / "a.hier");
  }

  images::Image shown() const {
    images::Image image(16, 8, 3);
    for (std::size_t i = 0; i < image.texels.size(); ++i)
      image.texels[i] = 120;
    return image;
  }

  /// The sample's input in one grey.
  TexturedMesh input(std::uint8_t value) const {
    TexturedMesh mesh;
    mesh.positions = sample_.ranked.positions;
    mesh.triangles = sample_.ranked.triangles;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      mesh.texcoords.push_back({static_cast<float>(v % 3) / 8, static_cast<float>(v % 5) / 8});
    mesh.material_of.resize(mesh.positions.size());
    mesh.materials = {{std::make_shared<render::MipTexture>(grey(8, value)), {}}};
    return mesh;
  }

  static TextureOptions small_pictures() { return {.size = 48, .views = 2}; }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  tests::TemporaryDirectory directory_;
  tests::Sample sample_;
  std::optional<storage::HierarchyReader> reader_;
};

TEST_F(TextureComparisonTest, EqualColoursAreEqualAtEachLevel) {
  const TextureComparison result = compare_textures(*reader_, input(120), small_pictures());
  ASSERT_THAT(result.rows, SizeIs(raw(sample_.tree.depth()) + 1U));
  for (const TextureRow& row : result.rows) {
    ASSERT_TRUE(row.least) << raw(row.level);
    EXPECT_TRUE(std::isinf(*row.least)) << raw(row.level);
  }
}

TEST_F(TextureComparisonTest, ARatioIsThatOfTheColours) {
  const TextureComparison result = compare_textures(*reader_, input(125), small_pictures());
  for (const TextureRow& row : result.rows) {
    EXPECT_NEAR(row.least.value(), 20 * std::log10(255.0 / 5), 1e-9);
    EXPECT_NEAR(row.mean.value(), *row.least, 1e-9);
  }
}

TEST_F(TextureComparisonTest, APixelIsTheLevelsErrorOrATexel) {
  const TexturedMesh mesh = input(120);
  const TextureComparison result = compare_textures(*reader_, mesh, small_pictures());
  EXPECT_EQ(result.input_texel, mesh.texel());
  for (const TextureRow& row : result.rows) {
    EXPECT_EQ(row.pixel, std::max<double>(row.error, mesh.texel()));
    EXPECT_LE(row.width, 48U);
    EXPECT_EQ(row.texel, 0.25);
  }
  EXPECT_FLOAT_EQ(static_cast<float>(result.rows[0].error),
                  0.02F * static_cast<float>(raw(sample_.tree.depth())));
}

TEST_F(TextureComparisonTest, PicturesAndFiguresAreEqualForAnyNumberOfThreads) {
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<std::pair<std::string, std::vector<std::byte>>> pictures;
    const TextureComparison result = compare_textures(
        *reader_, input(125), small_pictures(),
        [&](const NamedPicture& picture) { pictures.emplace_back(picture.name, picture.png); });
    return std::pair(json_text("a", result), pictures);
  };
  const auto alone = run(1);
  EXPECT_EQ(alone, run(4));
  ASSERT_THAT(alone.second, SizeIs(2 * (raw(sample_.tree.depth()) + 1U)));
  EXPECT_EQ(alone.second[0].first, "view1_level0.png");
}

TEST_F(TextureComparisonTest, RefusesALevelThatIsNotThere) {
  EXPECT_THROW(compare_textures(*reader_, input(1), {.level = Level{200}}), Error);
}

TEST(TextureComparisonTextTest, IsTold) {
  const TextureComparison result{{.size = 64, .views = 3},
                                 0.125,
                                 {{Level{1}, 0.5, 0.25, 0.5, 40, 30, 31.25, 32.5}, {Level{2}}}};
  EXPECT_EQ(markdown("a.hier", result),
            "### a.hier: 3 views, a texel of the input is 0.125\n\n"
            "| level | error | texel | a pixel | picture | dB, least | mean |\n"
            "|---:|---:|---:|---:|---:|---:|---:|\n"
            "| 1 | 0.5 | 0.25 | 0.5 | 40 x 30 | 31.25 | 32.50 |\n"
            "| 2 | 0 | 0 | 0 | 0 x 0 | none | none |\n");
  const auto json = nlohmann::json::parse(json_text("a.hier", result));
  EXPECT_EQ(json["levels"][0]["least_db"], 31.25);
  EXPECT_EQ(json["levels"][0]["width"], 40);
  EXPECT_TRUE(json["levels"][1]["mean_db"].is_null());
}

// ---- inputs --------------------------------------------------------------------------------

class TexturedMeshTest : public testing::Test {
 protected:
  /// Written to files and read again. Another seed, other places in the pictures.
  TexturedMesh loaded(MeshFileFormat format, std::uint64_t atlas_seed) {
    const std::string name = format == MeshFileFormat::obj ? "a.obj" : "a.ply";
    const TexturedScan surface(
        {.surface = {.triangles = 5000},
         .atlas = {.images = 2, .side = 512, .charts = 40, .seed = atlas_seed}});
    write_textured(*files_, {directory_.path() / name, true, {}}, surface,
                   {.mesh = format, .image = ImageFormat::png});
    return load_textured_mesh(*files_, directory_.path() / name, directory_.path(), {});
  }

  static images::Image picture_of(const TexturedMesh& mesh) {
    const render::View view = render::views_around(6, {0, 0, 1})[2];
    render::Raster raster(render::Camera(view, BoundsD{{-1.3, -1.3, -1.3}, {1.3, 1.3, 1.3}},
                                         render::Framing{.width = 256, .height = 256}));
    mesh.draw(raster);
    return render::shade(raster, {.kind = render::Light::none});
  }

  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  tests::TemporaryDirectory directory_;
};

TEST_F(TexturedMeshTest, ObjAndPlyShowTheSame) {
  const TexturedMesh obj = loaded(MeshFileFormat::obj, 1), ply = loaded(MeshFileFormat::ply, 1);
  EXPECT_EQ(obj.triangles.size(), ply.triangles.size());
  EXPECT_NEAR(obj.texel(), ply.texel(), 1e-6 * obj.texel());
  EXPECT_GT(peak_ratio(picture_of(obj), picture_of(ply)).value(), 60);
}

TEST_F(TexturedMeshTest, WhereChartsLieMakesNoDifference) {
  const TexturedMesh one = loaded(MeshFileFormat::obj, 1), other = loaded(MeshFileFormat::obj, 2);
  EXPECT_GT(peak_ratio(picture_of(one), picture_of(other)).value(), 34);
}

TEST_F(TexturedMeshTest, WithoutTexturesThereIsNothingToCompare) {
  write_ply(*files_, {directory_.path() / "plain.ply"}, *make_surface({.triangles = 100}));
  EXPECT_THAT(tests::usage_error([&] {
                load_textured_mesh(*files_, directory_.path() / "plain.ply", directory_.path(), {});
              }),
              HasSubstr("has no textures"));
}

}  // namespace
}  // namespace meshhier::bench

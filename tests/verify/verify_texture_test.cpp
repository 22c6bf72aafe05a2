// verify, inspect and progressive streams, where tiles have pictures.
#include "inspection/inspect.h"
#include "progressive/stream.h"
#include "tests/support/error_message.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_copies.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sample_shading.h"
#include "tests/support/sample_texture.h"
#include "verify/verify.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::verifying {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::node;

class VerifyTextureTest : public testing::Test {
 protected:
  /// Makes a sample of a mesh with colours and copies, with computed normals or without.
  tests::Sample make(const TextureFormat& format = {}, AlphaMode alpha = AlphaMode::opaque,
                     bool normals = true, std::uint32_t partitions = 4) {
    tests::Sample sample =
        tests::make_sample(tests::sphere(1500), {partitions, 20, false, true, {}});
    if (partitions == 4)
      tests::write_input(tests::add_copies(sample), sample, input());
    if (normals)
      tests::add_shading(sample);
    tests::add_textures(sample, format, alpha);
    return sample;
  }

  std::vector<std::string> problems(tests::Sample& sample, bool with_input = false) {
    fs::remove_all(hierarchy());
    tests::write_sample(*files_, hierarchy(), sample);
    VerifyOptions options;
    options.cuts = 5;
    if (with_input)
      options.input = input();
    execution::NoProgress progress;
    return verify_hierarchy(*files_, hierarchy(), options, progress, execution::CancelToken())
        .problems;
  }

  /// Problems after the tile 2/1 was changed; its files are sealed again.
  std::vector<std::string> problems_after(const std::function<void(PublishedTile&)>& change) {
    tests::Sample sample = make();
    PublishedTile& tile = sample.tile(node(2, 1));
    change(tile);
    TileRecord& record = sample.record(tile.node);
    record.split_count = static_cast<std::uint32_t>(tile.shading.split_of.size());
    record.image_width = tile.image.width;
    record.image_height = tile.image.height;
    return problems(sample);
  }

  fs::path input() const { return directory_.path() / "mesh.ply"; }
  fs::path hierarchy() const { return directory_.path() / "mesh.hier"; }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(VerifyTextureTest, FindsNothingWrongWithSoundTextures) {
  for (const ImageFormat format : {ImageFormat::jpeg, ImageFormat::png, ImageFormat::webp}) {
    for (const AlphaMode alpha : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
      tests::Sample sample = make({format, 80, true}, alpha, alpha != AlphaMode::mask);
      EXPECT_THAT(problems(sample), IsEmpty());
    }
  }
  tests::Sample early = make({}, AlphaMode::opaque, true, 5);
  EXPECT_THAT(problems(early), IsEmpty());
}

TEST_F(VerifyTextureTest, TilesWithoutTrianglesNeedNone) {
  tests::Sample sample = tests::make_sample(tests::points(100), {4, 20, false, false, {}});
  tests::add_textures(sample);
  EXPECT_THAT(problems(sample), IsEmpty());
}

TEST_F(VerifyTextureTest, NormalsOfBorderTrianglesAreStillCompared) {
  const auto found = problems_after([](PublishedTile& tile) {
    for (NormalCode& code : tile.shading.normals)
      code = code == NormalCode{127, 0, 0, 0} ? NormalCode{0, 127, 0, 0} : NormalCode{127, 0, 0, 0};
  });
  EXPECT_THAT(found, testing::Contains(AllOf(HasSubstr("tile 2/1: some of its"),
                                             HasSubstr("have other normals there"))));
}

TEST_F(VerifyTextureTest, NeighboursNeedNotHaveTheSameTexcoords) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) {
                for (Vec2f& texcoord : tile.shading.texcoords)
                  texcoord.u = 1 - texcoord.u;
              }),
              IsEmpty());
}

TEST_F(VerifyTextureTest, ASplitOfNoTriangleIsTold) {
  const auto found = problems_after([](PublishedTile& tile) {
    Shading& shading = tile.shading;
    const auto split = static_cast<std::uint32_t>(shading.texcoords.size());
    shading.split_of.push_back(shading.split_of.back());
    shading.texcoords.push_back({0.123F, 0.456F});
    shading.normals.push_back(shading.normals.back());
    ASSERT_GT(split, 0U);
  });
  EXPECT_THAT(found, testing::Contains(HasSubstr("a split is the corner of no triangle")));
}

TEST_F(VerifyTextureTest, ASplitLikeItsVertexIsTold) {
  const auto found = problems_after([](PublishedTile& tile) {
    Shading& shading = tile.shading;
    const std::size_t split = shading.texcoords.size() - shading.split_of.size();
    shading.texcoords[split] = shading.texcoords[shading.split_of[0]];
    shading.normals[split] = shading.normals[shading.split_of[0]];
  });
  EXPECT_THAT(found, testing::Contains(AllOf(HasSubstr("tiles/02/000001.glb"),
                                             HasSubstr("a split is like its vertex"))));
}

TEST_F(VerifyTextureTest, PicturesAreDecoded) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) {
                tile.image.bytes.resize(tile.image.bytes.size() / 2);
              }),
              ElementsAre(HasSubstr("tiles/02/000001.glb: the picture")));
  EXPECT_THAT(problems_after([](PublishedTile& tile) { tile.image.bytes.assign(100, {}); }),
              ElementsAre(HasSubstr("tiles/02/000001.glb: the picture")));
}

TEST_F(VerifyTextureTest, PicturesHaveTheSizeAndFormatThatIsTold) {
  EXPECT_THAT(problems_after([](PublishedTile& tile) { tile.image.width = 32; }),
              ElementsAre(HasSubstr("is a jpeg of 16 x 8 texels, expected a jpeg of 32 x 8")));
  EXPECT_THAT(problems_after(
                  [](PublishedTile& tile) { tile.image.bytes = tests::sample_png(16, 8, false); }),
              ElementsAre(HasSubstr("is a png of 16 x 8 texels, expected a jpeg of 16 x 8")));
}

TEST_F(VerifyTextureTest, AnOpaquePictureHasNoAlpha) {
  tests::Sample sample = make({ImageFormat::png});
  sample.tile(node(1, 0)).image.bytes = tests::sample_png(16, 8, true);
  EXPECT_THAT(problems(sample),
              ElementsAre(HasSubstr("the picture has alpha, but the material is opaque")));
}

TEST_F(VerifyTextureTest, TheRecordOfAPictureIsChecked) {
  tests::Sample sample = make();
  sample.record(node(1, 1)).image_height = 9;
  EXPECT_THAT(problems(sample),
              testing::Contains(HasSubstr("its picture's sides are not those of the index")));
}

TEST_F(VerifyTextureTest, InspectTellsOfTextures) {
  tests::Sample sample = make({ImageFormat::webp, 75, true});
  sample.manifest.source.textures = SourceTextures{12, 5, 1, 123456789};
  ASSERT_THAT(problems(sample), IsEmpty());
  const std::string text = inspection::inspect_text(*files_, hierarchy(), {});
  EXPECT_THAT(text, HasSubstr("textures     12 materials, 5 pictures (1 missing), 123,456,789 "
                              "texels\n"));
  EXPECT_THAT(text, HasSubstr("pictures     webp of quality 75, unlit: 7 of 16 x 8 texels on "
                              "average, 682 B of graphics memory each\n"));
  EXPECT_THAT(inspection::inspect_text(*files_, hierarchy(), {.level = {}, .node = node(2, 1)}),
              HasSubstr("; a picture of 16 x 8 texels of 0.25; "));
  const auto json = inspection::inspect_json(*files_, hierarchy(), {});
  EXPECT_EQ(json["source"]["textures"]["missing_images"], 1);
  EXPECT_EQ(json["storage"]["texture"]["format"], "webp");
  EXPECT_DOUBLE_EQ(json["storage"]["texture"]["gpu_bytes_a_texel"], 16.0 / 3);
  EXPECT_EQ(json["pictures"]["tiles"], 7);
  EXPECT_EQ(json["pictures"]["texels"], 7 * 128);
  EXPECT_EQ(json["pictures"]["texel_mean"], 0.25);
  EXPECT_EQ(json["levels"][1]["pictures"]["texels_mean"], 128);
}

TEST_F(VerifyTextureTest, InspectTellsHowEvenTilesAre) {
  tests::Sample sample = make();
  problems(sample);
  double mean = 0, squares = 0;
  for (const TileRecord& record : sample.records)
    mean += static_cast<double>(record.file_bytes) / 7;
  for (const TileRecord& record : sample.records)
    squares += (static_cast<double>(record.file_bytes) - mean) *
               (static_cast<double>(record.file_bytes) - mean);
  const auto json = inspection::inspect_json(*files_, hierarchy(), {});
  EXPECT_NEAR(json["sizes"]["all"]["bytes_mean"].get<double>(), mean, 1e-6);
  EXPECT_NEAR(json["sizes"]["all"]["bytes_deviation"].get<double>(), std::sqrt(squares / 7), 1e-6);
  EXPECT_THAT(inspection::inspect_text(*files_, hierarchy(), {}),
              HasSubstr(fmt::format("standard deviation {:.2f} of the mean\n",
                                    std::sqrt(squares / 7) / mean)));
}

TEST_F(VerifyTextureTest, InspectTellsNothingOfTexturesThatAreNotThere) {
  tests::Sample sample = tests::make_sample(tests::sphere(300), {});
  ASSERT_THAT(problems(sample), IsEmpty());
  EXPECT_THAT(inspection::inspect_text(*files_, hierarchy(), {}),
              AllOf(Not(HasSubstr("textures  ")), Not(HasSubstr("pictures  "))));
  const auto json = inspection::inspect_json(*files_, hierarchy(), {});
  EXPECT_TRUE(json["source"]["textures"].is_null());
  EXPECT_FALSE(json["levels"][0].contains("pictures"));
}

TEST_F(VerifyTextureTest, AProgressiveStreamCannotBeMade) {
  tests::Sample sample = make();
  problems(sample);
  execution::NoProgress progress;
  EXPECT_THAT(tests::usage_error([&] {
                progressive::write_progressive(
                    *files_, hierarchy(), {{}, {}, directory_.path() / "a.prog"}, progress, {});
              }),
              HasSubstr("has textures, which a progressive stream cannot show"));
  EXPECT_FALSE(fs::exists(directory_.path() / "a.prog"));
}

}  // namespace
}  // namespace meshhier::verifying

// Textured hierarchies: partitions show the input's texels, coarser tiles their means.
#include "base/error.h"
#include "config/config.h"
#include "hierarchy/shown_corners.h"
#include "images/image_codec.h"
#include "pipeline/build.h"
#include "storage/format/hierarchy_reader.h"
#include "tests/support/files_of.h"
#include "tests/support/interrupter.h"
#include "tests/support/sample_hierarchy.h"
#include "tests/support/sizes.h"
#include "tests/support/stopped_stage.h"
#include "tests/support/textured_torus.h"
#include "tests/support/warnings.h"
#include "verify/verify.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using images::Image;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::AtStage;
using tests::files_of;
using tests::kMiB;
using tests::StoppedStage;
using tests::TexturedTorus;
using tests::TexturedTriangle;
using tests::Warnings;

/// A triangle as a tile shows it.
struct ShownTriangle {
  std::array<Vec3f, 3> positions;
  std::array<Vec2f, 3> texcoords;
};

std::vector<ShownTriangle> shown_triangles(const PublishedTile& tile) {
  std::vector<ShownTriangle> all;
  const std::uint32_t place_count = static_cast<std::uint32_t>(tile.mesh.vertices.size());
  const std::size_t vertices = place_count + tile.mesh.copies.size();
  const auto position = [&](std::uint32_t v) {
    if (v >= vertices)
      v = tile.shading.split_of[v - vertices];
    return v < place_count ? tile.mesh.vertices.positions[v]
                           : tile.mesh.vertices.positions[tile.mesh.copies.places[v - place_count]];
  };
  const auto add = [&](const std::vector<TileTriangle>& triangles) {
    for (const TileTriangle& t : triangles) {
      ShownTriangle shown;
      for (std::size_t k = 0; k < 3; ++k) {
        shown.positions[k] = position(raw(t[k]));
        shown.texcoords[k] = tile.shading.texcoords.at(raw(t[k]));
      }
      all.push_back(shown);
    }
  };
  add(shown_interior(tile));
  add(shown_border(tile));
  return all;
}

struct BuiltTile {
  TileRecord record;
  PublishedTile tile;
  Image image;
};

class TexturesTest : public testing::Test {
 protected:
  std::filesystem::path write(const TexturedTorus& torus) const {
    return tests::write_obj(torus, directory_.path());
  }

  config::Config config(const std::filesystem::path& mesh) const {
    config::Config config;
    config.input = mesh;
    config.output = directory_.path() / "torus.hier";
    config.partition.count = 7;
    config.simplify.vertices = 300;
    config.texture.texels = 128;
    config.texture.format.format = ImageFormat::png;
    return config;
  }

  /// Returns the report.
  std::string build(const config::Config& config) {
    execution::NoProgress progress;
    BuildOptions options;
    options.force = true;
    return build_hierarchy(config, options, {*files_, progress, execution::CancelToken()}).text;
  }

  /// Builds with one thread and little memory, and with more of both.
  void expect_equal_builds(const config::Config& job) {
    build(job);
    const auto expected = files_of(job.output);
    for (const std::uint32_t threads : {1U, 3U}) {
      config::Config other = job;
      other.threads = threads;
      other.memory_budget = threads == 1 ? 136 * kMiB : 2048 * kMiB;
      build(other);
      EXPECT_EQ(files_of(job.output), expected) << threads;
    }
  }

  void stop(const config::Config& config, const std::string& stage) {
    execution::CancelToken cancel;
    tests::StageInterrupter progress(cancel, stage);
    EXPECT_THROW(build_hierarchy(config, {}, {*files_, progress, cancel}), Error);
  }
  /// Returns the config of a torus whose pictures have at least so many bytes.
  config::Config stopped(const std::string& stage, std::uintmax_t bytes) {
    const config::Config job = config(write(tests::make_textured_torus(6, 3)));
    for (const char* name : {"picture_0.png", "picture_1.png"}) {
      const std::filesystem::path path = directory_.path() / name;
      std::filesystem::resize_file(path, std::max(bytes, std::filesystem::file_size(path)));
    }
    stop(job, stage);
    return job;
  }

  std::vector<BuiltTile> tiles(const config::Config& config) const {
    const storage::HierarchyReader reader(*files_, config.output);
    std::vector<BuiltTile> all;
    for (const TileRecord& record : reader.records()) {
      BuiltTile built{record, reader.read_tile(record.node), {}};
      built.image = images::decode_image(built.tile.image.bytes, "tile", 1 << 26);
      all.push_back(std::move(built));
    }
    return all;
  }

  std::vector<std::string> problems(const config::Config& config) const {
    execution::NoProgress progress;
    return verifying::verify_hierarchy(*files_, config.output, {.input = config.input, .cuts = 3},
                                       progress, execution::CancelToken())
        .problems;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

using CornerKey = std::array<std::array<float, 3>, 3>;

/// Corners in the turn that begins with the least; `first` is where it was.
CornerKey key_of(std::array<Vec3f, 3> corners, std::size_t& first) {
  const auto flat = [](Vec3f p) { return std::array{p.x, p.y, p.z}; };
  first = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (flat(corners[k]) < flat(corners[first]))
      first = k;
  }
  return {flat(corners[first]), flat(corners[(first + 1) % 3]), flat(corners[(first + 2) % 3])};
}

/// Calls visit(x, y) for each texel whose centre lies in the triangle, away from its edges.
template <class Visit>
void for_each_texel(const std::array<Vec2f, 3>& texcoords, const Image& image, const Visit& visit) {
  std::array<std::array<double, 2>, 3> p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = {texcoords[k].u * static_cast<double>(image.width),
            texcoords[k].v * static_cast<double>(image.height)};
  const auto side = [&](std::size_t k, double x, double y) {
    const auto& a = p[k];
    const auto& b = p[(k + 1) % 3];
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
  };
  const auto [left, right] = std::minmax({p[0][0], p[1][0], p[2][0]});
  const auto [top, bottom] = std::minmax({p[0][1], p[1][1], p[2][1]});
  for (double y = std::floor(top) + 0.5; y < bottom; ++y) {
    for (double x = std::floor(left) + 0.5; x < right; ++x) {
      const double a = side(0, x, y), b = side(1, x, y), c = side(2, x, y);
      if (std::min({a, b, c}) > 1e-3 || std::max({a, b, c}) < -1e-3)
        visit(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    }
  }
}

TEST_F(TexturesTest, PartitionsShowTheInputsTexels) {
  const TexturedTorus torus = tests::make_textured_torus(6, 3);
  const config::Config job = config(write(torus));
  build(job);
  std::map<CornerKey, std::pair<const TexturedTriangle*, std::size_t>> input;
  for (const TexturedTriangle& t : torus.triangles) {
    std::size_t first = 0;
    const CornerKey key =
        key_of({t.corners[0].position, t.corners[1].position, t.corners[2].position}, first);
    input[key] = {&t, first};
  }
  std::size_t texels = 0;
  for (const BuiltTile& built : tiles(job)) {
    if (built.record.error > 0)
      continue;  // simplified
    for (const ShownTriangle& shown : shown_triangles(built.tile)) {
      std::size_t first = 0;
      const auto found = input.find(key_of(shown.positions, first));
      ASSERT_NE(found, input.end());
      const TexturedTriangle& source = *found->second.first;
      const Image& picture = torus.pictures[source.picture];
      const Vec2f there = source.corners[found->second.second].texcoord;
      const Vec2f here = shown.texcoords[first];
      const double dx = there.u * static_cast<double>(picture.width) -
                        here.u * static_cast<double>(built.image.width);
      const double dy = there.v * static_cast<double>(picture.height) -
                        here.v * static_cast<double>(built.image.height);
      EXPECT_NEAR(dx, std::round(dx), 0.01);
      EXPECT_NEAR(dy, std::round(dy), 0.01);
      for_each_texel(shown.texcoords, built.image, [&](std::uint32_t x, std::uint32_t y) {
        const std::uint8_t* a = built.image.at(x, y);
        const std::uint8_t* b = picture.at(x + static_cast<std::uint32_t>(std::lround(dx)),
                                           y + static_cast<std::uint32_t>(std::lround(dy)));
        ASSERT_TRUE(std::equal(a, a + 3, b)) << x << " " << y;
        ++texels;
      });
    }
  }
  EXPECT_GT(texels, torus.triangles.size() * 10);
  EXPECT_THAT(problems(job), IsEmpty());
}

/// Half as large, as viewers make it.
Image halved(const Image& image) {
  Image half((image.width + 1) / 2, (image.height + 1) / 2, image.channels);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    for (std::uint32_t x = 0; x < half.width; ++x) {
      const std::uint32_t right = std::min(2 * x + 1, image.width - 1);
      const std::uint32_t below = std::min(2 * y + 1, image.height - 1);
      for (std::uint32_t c = 0; c < image.channels; ++c) {
        const unsigned sum = image.at(2 * x, 2 * y)[c] + image.at(right, 2 * y)[c] +
                             image.at(2 * x, below)[c] + image.at(right, below)[c];
        half.at(x, y)[c] = static_cast<std::uint8_t>(sum / 4);
      }
    }
  }
  return half;
}

/// A square that shows a picture of noise `repeats` times along u.
struct NoiseCase {
  std::uint32_t width, height;
  int repeats;
  bool is_exact;
};

TEST_F(TexturesTest, PicturesOfAnyShapeAreExactOrTheirLossIsTold) {
  for (const auto& [width, height, repeats, is_exact] :
       {NoiseCase{4096, 1, 1, true}, NoiseCase{1, 4096, 1, true}, NoiseCase{4096, 3, 1, true},
        NoiseCase{2, 2, 1, true}, NoiseCase{7, 5, 585, true}, NoiseCase{16, 16, 250, true},
        NoiseCase{4105, 2, 1, false}, NoiseCase{1, 65500, 1, false},
        NoiseCase{64, 64, 100, false}}) {
    Image noise(width, height, 3);
    std::uint32_t state = 1;
    for (std::uint8_t& channel : noise.texels)
      channel = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
    const std::vector<std::byte> png = images::encode_image(noise, ImageFormat::png, 100);
    std::ofstream(directory_.path() / "noise.png", std::ios::binary)
        .write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
    std::ofstream(directory_.path() / "noise.mtl") << "newmtl a\nmap_Kd noise.png\n";
    std::ofstream(directory_.path() / "noise.obj")
        << "mtllib noise.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt " << repeats
        << " 0\nvt " << repeats << " 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
    config::Config job = config(directory_.path() / "noise.obj");
    job.partition.count = 1;
    Warnings progress;
    BuildOptions options;
    options.force = true;
    build_hierarchy(job, options, {*files_, progress, execution::CancelToken()});
    const auto report = verifying::verify_hierarchy(*files_, job.output, {.input = job.input},
                                                    progress, execution::CancelToken());
    EXPECT_THAT(report.problems, IsEmpty());
    const std::string name = fmt::format("{} x {}, {} times", width, height, repeats);
    if (is_exact) {
      EXPECT_THAT(progress.all, IsEmpty()) << name;
      EXPECT_THAT(report.checks, Contains(HasSubstr("partitions, all equal"))) << name;
    } else {
      EXPECT_THAT(progress.all, ElementsAre(HasSubstr("times fewer texels a side"))) << name;
      EXPECT_THAT(report.checks, Contains(HasSubstr("2 triangles shown by fewer texels"))) << name;
    }
  }
}

// Black between charts would darken their borders there.
TEST_F(TexturesTest, SmallVersionsOfPicturesAreNoDarkerThanTheInput) {
  constexpr std::uint8_t kDarkest = 28;  // that torus_colour() has
  TexturedTorus torus = tests::make_textured_torus(7, 3);
  for (Image& picture : torus.pictures)  // between its charts there is black
    std::ranges::replace_if(
        picture.texels, [](auto value) { return value < kDarkest; }, kDarkest);
  const config::Config job = config(write(torus));
  build(job);
  for (const BuiltTile& built : tiles(job)) {
    if (built.record.error > 0)
      continue;  // simplified
    for (Image small = built.image; small.width > 1 || small.height > 1; small = halved(small)) {
      ASSERT_GE(*std::ranges::min_element(small.texels), kDarkest)
          << built.record.node.index << ": " << small.width << " x " << small.height;
    }
  }
}

double mean_square_error(const BuiltTile& built) {
  double sum = 0;
  std::size_t count = 0;
  for (const ShownTriangle& t : shown_triangles(built.tile)) {
    for_each_texel(t.texcoords, built.image, [&](std::uint32_t x, std::uint32_t y) {
      // The point of the surface at the texel's centre.
      const auto at = [&](std::size_t k) {
        return std::array<double, 2>{t.texcoords[k].u * static_cast<double>(built.image.width),
                                     t.texcoords[k].v * static_cast<double>(built.image.height)};
      };
      const auto a = at(0), b = at(1), c = at(2);
      const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      const double px = x + 0.5 - a[0], py = y + 0.5 - a[1];
      const double wb = (px * (c[1] - a[1]) - py * (c[0] - a[0])) / area;
      const double wc = ((b[0] - a[0]) * py - (b[1] - a[1]) * px) / area;
      const Vec3d point = to_double(t.positions[0]) * (1 - wb - wc) +
                          to_double(t.positions[1]) * wb + to_double(t.positions[2]) * wc;
      const std::array<double, 3> expected = tests::torus_colour(point);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const double off = built.image.at(x, y)[channel] - expected[channel];
        sum += off * off;
        ++count;
      }
    });
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

TEST_F(TexturesTest, CoarserTilesShowTheSurfacesColours) {
  const TexturedTorus torus = tests::make_textured_torus(6, 3);
  const config::Config job = config(write(torus));
  build(job);
  for (const BuiltTile& built : tiles(job)) {
    const double psnr = 10 * std::log10(255 * 255 / mean_square_error(built));
    EXPECT_GT(psnr, 30) << raw(built.record.node.level) << "/" << built.record.node.index;
    EXPECT_EQ(built.record.image_width, built.image.width);
    EXPECT_GT(built.record.texel, 0);
  }
}

TEST_F(TexturesTest, ErrorsAreNoSmallerThanTexels) {
  const TexturedTorus torus = tests::make_textured_torus(6, 3, 12);
  config::Config job = config(write(torus));
  job.texture.texels = 64;
  build(job);
  std::size_t coarse = 0;
  float finest = 1e9f;
  for (const BuiltTile& built : tiles(job)) {
    if (built.record.error == 0)
      finest = std::min(finest, built.record.texel);
  }
  for (const BuiltTile& built : tiles(job)) {
    if (built.record.error > 0 && built.record.texel > 1.5f * finest) {
      EXPECT_GE(built.record.error, built.record.texel);
      ++coarse;
    }
  }
  EXPECT_GT(coarse, 0U);
}

TEST_F(TexturesTest, SLOW_ThreadsAndBudgetDecideNothing) {
  config::Config job = config(write(tests::make_textured_torus(6, 3)));
  for (const ImageFormat format : {ImageFormat::png, ImageFormat::jpeg}) {
    job.texture.format.format = format;
    expect_equal_builds(job);
  }
}

TEST_F(TexturesTest, Ktx2IsTheSameWhateverBuildsIt) {
  config::Config job = config(write(tests::make_textured_torus(6, 3)));
  job.texture.format = {ImageFormat::ktx2, 100, true};
  build(job);
  const auto expected = files_of(job.output);
  for (const BuiltTile& built : tiles(job)) {
    EXPECT_EQ(built.tile.image.format, ImageFormat::ktx2);
    EXPECT_EQ(built.tile.image.width % 4 + built.tile.image.height % 4, 0U);
  }
  EXPECT_THAT(problems(job), testing::IsEmpty());
  job.threads = 3;
  job.memory_budget = 4096 * kMiB;
  build(job);
  EXPECT_EQ(files_of(job.output), expected);
  job.texture.texels = 4096;
  EXPECT_THROW(build(job), Error);
}

// Their pictures are painted, reduced and encoded in several bands.
TEST_F(TexturesTest, SLOW_ThreadsAndBudgetDecideNothingOfLargePictures) {
  config::Config job = config(write(tests::make_textured_torus(6, 3, 30)));
  job.partition.count = 1;
  job.texture.format.format = ImageFormat::jpeg;
  build(job);
  const auto expected = files_of(job.output);
  const Image image = tiles(job).front().image;
  ASSERT_GT(std::uint64_t{image.width} * image.height, kMiB);
  for (const std::uint32_t threads : {1U, 3U}) {
    job.threads = threads;
    job.memory_budget = threads == 1 ? 96 * kMiB : 2048 * kMiB;
    build(job);
    EXPECT_EQ(files_of(job.output), expected) << threads;
  }
}

TEST_F(TexturesTest, SLOW_AStoppedBuildGoesOnToTheSameBytes) {
  const config::Config job = config(write(tests::make_textured_torus(6, 3)));
  build(job);
  const auto expected = files_of(job.output);
  std::set<std::string> stages;
  for (std::uint64_t after = 0; after < 60; after += 2) {
    std::filesystem::remove_all(job.output);
    execution::CancelToken cancel;
    StoppedStage progress(cancel, after);
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
  EXPECT_THAT(stages,
              testing::IsSupersetOf({"images", "leaves", "simplify", "texture", "publish"}));
}

// ---- normal maps under pictures

/// Returns the config of a torus whose coarse tiles get maps.
config::Config with_relief(config::Config job) {
  job.storage.normals = config::Normals::map;
  return job;
}

TEST_F(TexturesTest, WithNormalMapsSimplifiedTilesHaveBothAndAreLit) {
  const config::Config job = with_relief(config(write(tests::make_textured_torus(6, 3))));
  build(job);
  const storage::HierarchyReader reader(*files_, job.output);
  EXPECT_EQ(reader.manifest().format_version(), 13);
  EXPECT_EQ(reader.manifest().normal_maps, job.normal_map.format);
  EXPECT_TRUE(reader.manifest().computed_normals);
  EXPECT_FALSE(reader.manifest().textures->unlit);
  for (const TileRecord& record : reader.records()) {
    const bool is_partition = reader.tree().is_partition(record.node);
    ASSERT_NE(record.has_normal_map, is_partition);
    const PublishedTile tile = reader.read_tile(record.node);
    EXPECT_FALSE(tile.image.empty());
    ASSERT_EQ(tile.normal_map.empty(), is_partition);
    EXPECT_EQ(tile.shading.tangents.size(), is_partition ? 0 : tile.shading.texcoords.size());
    if (is_partition)
      continue;
    const Image map = images::decode_image(tile.normal_map.bytes, "map", 1 << 20);
    EXPECT_EQ(map.width, tile.image.width);
    EXPECT_EQ(map.height, tile.image.height);
  }
  EXPECT_THAT(problems(job), IsEmpty());
}

TEST_F(TexturesTest, PicturesAndMeshAreWhatTheyAreWithoutMaps) {
  config::Config job = config(write(tests::make_textured_torus(6, 3)));
  job.texture.format.unlit = false;
  build(job);
  const std::vector<BuiltTile> without = tiles(job);
  build(with_relief(job));
  const std::vector<BuiltTile> with = tiles(job);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_EQ(with[i].tile.mesh.vertices.positions, without[i].tile.mesh.vertices.positions);
    ASSERT_EQ(with[i].tile.mesh.interior, without[i].tile.mesh.interior);
    EXPECT_GE(with[i].tile.image.width, without[i].tile.image.width);
    if (with[i].tile.normal_map.empty()) {
      EXPECT_EQ(with[i].tile.image, without[i].tile.image);
    }
  }
}

TEST_F(TexturesTest, AutoMakesNoMapsUnderPictures) {
  config::Config job = config(write(tests::make_textured_torus(6, 3)));
  build(job);
  const std::vector<BuiltTile> without = tiles(job);
  job.storage.normals = config::Normals::map_or_none;
  build(job);
  const std::vector<BuiltTile> with = tiles(job);
  for (std::size_t i = 0; i < with.size(); ++i)
    EXPECT_EQ(with[i].record.checksum, without[i].record.checksum);
}

TEST_F(TexturesTest, SLOW_ThreadsAndBudgetDecideNothingOfRelief) {
  expect_equal_builds(with_relief(config(write(tests::make_textured_torus(6, 3)))));
}

TEST_F(TexturesTest, ABuildWithReliefThatIsStoppedGoesOnToTheSameBytes) {
  const config::Config job = with_relief(config(write(tests::make_textured_torus(6, 3))));
  build(job);
  const auto expected = files_of(job.output);
  std::filesystem::remove_all(job.output);
  for (const char* stage : {"texture", "publish"}) {
    stop(job, stage);
    build(job);
    ASSERT_EQ(files_of(job.output), expected) << stage;
    std::filesystem::remove_all(job.output);
  }
}

/// Writes pictures that are all grey, of at least so many bytes.
void write_grey(const std::filesystem::path& directory, std::uintmax_t bytes) {
  TexturedTorus grey = tests::make_textured_torus(6, 3);
  for (Image& picture : grey.pictures)
    std::ranges::fill(picture.texels, std::uint8_t{200});
  tests::write_obj(grey, directory);
  for (const char* name : {"picture_0.png", "picture_1.png"}) {
    const std::filesystem::path path = directory / name;
    std::filesystem::resize_file(path, std::max(bytes, std::filesystem::file_size(path)));
  }
}

TEST_F(TexturesTest, AChangedPictureIsNotGoneOnWith) {
  const config::Config job = stopped("texture", 100'000);
  write_grey(directory_.path(), 100'000);
  EXPECT_THAT(build(job), HasSubstr("the input was changed since an earlier build was stopped"));
  for (const BuiltTile& built : tiles(job))
    ASSERT_EQ(built.image.at(0, 0)[0], 200);
  EXPECT_THAT(problems(job), IsEmpty());
}

TEST_F(TexturesTest, APictureOfAnotherSizeIsRefusedAsAnotherMeshIs) {
  const config::Config job = stopped("texture", 100'000);
  write_grey(directory_.path(), 100'001);
  try {
    build(job);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::other_work);
    EXPECT_THAT(error.what(), HasSubstr("input_bytes was "));
  }
}

TEST_F(TexturesTest, APictureThatAppearedIsAnotherInput) {
  const std::filesystem::path mesh = write(tests::make_textured_torus(6, 3));
  const std::filesystem::path picture = directory_.path() / "picture_1.png";
  std::filesystem::rename(picture, directory_.path() / "away.png");
  stop(config(mesh), "texture");
  std::filesystem::rename(directory_.path() / "away.png", picture);
  EXPECT_THROW(build(config(mesh)), Error);
}

TEST_F(TexturesTest, FilesThatWereOnlyTouchedAreGoneOnWith) {
  const config::Config job = stopped("texture", 0);
  for (const char* name : {"picture_0.png", "torus.mtl", "torus.obj"}) {
    const std::filesystem::path path = directory_.path() / name;
    std::filesystem::last_write_time(
        path, std::filesystem::last_write_time(path) + std::chrono::hours(1));
  }
  EXPECT_THAT(build(job), HasSubstr("went on where an earlier build was stopped"));
  EXPECT_THAT(problems(job), IsEmpty());
}

TEST_F(TexturesTest, APictureThatChangesBeforeItIsDecodedIsRefused) {
  const config::Config job = config(write(tests::make_textured_torus(6, 3)));
  AtStage progress("images", [&] {
    std::filesystem::resize_file(directory_.path() / "picture_1.png", 100'000);
  });
  try {
    build_hierarchy(job, {}, {*files_, progress, execution::CancelToken()});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_THAT(error.what(), HasSubstr("picture_1.png was changed while it was read"));
  }
}

TEST_F(TexturesTest, VerifyNamesTheFilesThatChanged) {
  const config::Config job = config(write(tests::make_textured_torus(6, 3)));
  build(job);
  std::ofstream(directory_.path() / "picture_1.png", std::ios::app) << "more";
  EXPECT_THAT(problems(job), Contains(HasSubstr("picture_0.png and 1 more (picture): not what the "
                                                "hierarchy was made of")));
  EXPECT_THAT(problems(job), Not(Contains(HasSubstr("torus.mtl"))));
  std::ofstream(directory_.path() / "torus.mtl", std::ios::app) << "# more\n";
  EXPECT_THAT(problems(job), Contains(HasSubstr("torus.mtl (material library): not what")));
}

TEST_F(TexturesTest, LibrariesWithoutPicturesAreVerifiedToo) {
  const std::filesystem::path mesh = write(tests::make_textured_torus(4, 2));
  std::ofstream(directory_.path() / "torus.mtl") << "newmtl material_0\nKd 1 0 0\n";
  const config::Config job = config(mesh);
  build(job);
  EXPECT_FALSE(storage::HierarchyReader(*files_, job.output).manifest().source.textures);
  EXPECT_THAT(problems(job), IsEmpty());
  std::ofstream(directory_.path() / "torus.mtl", std::ios::app) << "# more\n";
  EXPECT_THAT(problems(job), Contains(HasSubstr("torus.mtl (material library): not what")));
}

TEST_F(TexturesTest, TheReportNamesAllThatWasReadAndWhatWasMissing) {
  const std::filesystem::path mesh = write(tests::make_textured_torus(6, 3));
  std::filesystem::remove(directory_.path() / "picture_1.png");
  const config::Config job = config(mesh);
  execution::NoProgress progress;
  const storage::InputNote note =
      build_hierarchy(job, {}, {*files_, progress, execution::CancelToken()}).input;
  std::vector<std::string> names;
  for (const storage::NotedFile& file : note.files) {
    names.push_back(file.path.string());
    EXPECT_EQ(file.identity, files_->identity(directory_.path() / file.path));
  }
  EXPECT_THAT(names, ElementsAre("torus.obj", "torus.mtl", "picture_0.png"));
  EXPECT_THAT(note.awaited, ElementsAre("picture_1.png"));
  EXPECT_EQ(note.content, storage::HierarchyReader(*files_, job.output).manifest().source.checksum);
}

TEST_F(TexturesTest, ABrokenPictureIsRefusedWithWhatCanBeDone) {
  const config::Config job = config(write(tests::make_textured_torus(4, 2)));
  for (const std::uintmax_t bytes : {200U, 10U}) {  // no end, no head
    std::filesystem::resize_file(directory_.path() / "picture_1.png", bytes);
    try {
      build(job);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_THAT(error.what(), HasSubstr("picture_1.png"));
      EXPECT_THAT(error.what(), HasSubstr("\"missing_images\": \"ignore\""));
    }
  }
}

TEST_F(TexturesTest, BrokenPicturesThatAreToBeIgnoredGiveOneWarning) {
  config::Config job = config(write(tests::make_textured_torus(6, 3)));
  std::filesystem::resize_file(directory_.path() / "picture_0.png", 10);   // no head
  std::filesystem::resize_file(directory_.path() / "picture_1.png", 200);  // no end
  job.missing_images = config::MissingImages::ignore;
  Warnings progress;
  build_hierarchy(job, {}, {*files_, progress, execution::CancelToken()});
  ASSERT_EQ(progress.all.size(), 1U);
  EXPECT_THAT(progress.all[0], HasSubstr("2 pictures of the mesh are broken (the first: "));
  EXPECT_THAT(progress.all[0], HasSubstr("picture_0.png"));
  const SourceTextures textures =
      storage::HierarchyReader(*files_, job.output).manifest().source.textures.value();
  EXPECT_EQ(textures.images, 2U);
  EXPECT_EQ(textures.missing_images, 2U);
  EXPECT_THAT(problems(job), IsEmpty());
}

/// A picture with an alpha channel.
std::vector<std::byte> png_of_alpha(std::uint8_t one_texel) {
  Image image(64, 64, 4);
  std::ranges::fill(image.texels, std::uint8_t{255});
  image.at(40, 50)[3] = one_texel;
  return images::encode_image(image, ImageFormat::png, 90);
}

TEST_F(TexturesTest, AlphaThatNobodySpeaksOfGivesOneWarning) {
  const config::Config job = config(write(tests::make_textured_torus(6, 3)));
  const auto put_picture = [&](const char* name, std::uint8_t one_texel) {
    const auto bytes = png_of_alpha(one_texel);
    std::ofstream(directory_.path() / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  };
  const auto warnings = [&] {
    Warnings progress;
    build_hierarchy(job, {.force = true}, {*files_, progress, execution::CancelToken()});
    return progress.all;
  };
  put_picture("picture_0.png", 255);
  EXPECT_THAT(warnings(), IsEmpty()) << "a channel that says nothing";
  put_picture("picture_0.png", 254);
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("1 picture of the mesh has transparent"),
                                            HasSubstr("'map_d picture_0.png'"))));
  put_picture("picture_1.png", 0);
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("2 pictures of the mesh have transparent texels, "
                                                "which are shown opaque (the first: ")));
  const std::filesystem::path library = directory_.path() / "torus.mtl";
  std::string text{std::istreambuf_iterator(std::ifstream(library).rdbuf()), {}};
  for (const char* name : {"picture_0.png", "picture_1.png"}) {
    const std::string line = fmt::format("map_Kd {}\n", name);
    const std::size_t at = text.find(line);
    ASSERT_NE(at, std::string::npos) << text;
    text.insert(at, fmt::format("map_d {}\n", name));
  }
  std::ofstream(library) << text;
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(TexturesTest, AListMayMixTexturedAndUntexturedFiles) {
  const std::filesystem::path torus = write(tests::make_textured_torus(6, 3));
  const std::filesystem::path plain = directory_.path() / "plain.obj";
  std::ofstream(plain) << "v 9 0 0\nv 10 0 0\nv 9 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 3/1 2/1 1/1\n";
  for (const auto& inputs : {std::vector{plain, torus}, std::vector{torus, plain}}) {
    config::Config job = config(torus);
    job.input = mesh_io::InputPaths();
    job.input.assign(inputs.begin(), inputs.end());
    build(job);
    EXPECT_THAT(problems(job), IsEmpty());
    const SourceSummary source = storage::HierarchyReader(*files_, job.output).manifest().source;
    EXPECT_EQ(source.textures->materials, 3U);
  }
}

TEST_F(TexturesTest, ABuildMayLeaveThemOut) {
  config::Config job = config(write(tests::make_textured_torus(4, 2)));
  job.texture.use = false;
  build(job);
  const storage::HierarchyReader reader(*files_, job.output);
  EXPECT_FALSE(reader.manifest().source.textures);
  EXPECT_TRUE(reader.manifest().source.attributes.texcoords);
  EXPECT_TRUE(reader.read_tile({}).image.empty());
  EXPECT_THAT(problems(job), IsEmpty());
}

}  // namespace
}  // namespace meshhier::pipeline

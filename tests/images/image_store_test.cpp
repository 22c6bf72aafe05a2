#include "images/image_store.h"

#include "base/error.h"
#include "base/srgb.h"
#include "images/material_texels.h"
#include "images/pyramid.h"
#include "storage/io/file.h"
#include "support/memory_files.h"
#include "tests/images/samples.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

/// Hands out a picture that is there already; may break.
class FakeReader final : public ImageReader {
 public:
  explicit FakeReader(const Image& image, std::uint32_t rows = UINT32_MAX)
      : image_(image),
        rows_(rows),
        info_{ImageFormat::png, image.width, image.height, image.channels, 0} {}
  const ImageInfo& info() const override { return info_; }
  void read_rows(std::uint8_t* rows, std::uint32_t count) override {
    if (next_ + count > rows_)
      throw Error(ErrorCode::input, "fake: broken");
    std::copy_n(image_.at(0, next_), std::size_t{count} * image_.width * image_.channels, rows);
    next_ += count;
  }

 private:
  const Image& image_;
  std::uint32_t rows_;
  ImageInfo info_;
  std::uint32_t next_ = 0;
};

const auto kNoStep = [](std::uint64_t) {};

class ImageStoreTest : public testing::Test {
 protected:
  explicit ImageStoreTest(std::uint64_t cache_bytes = 1 << 20) : store(scratch, cache_bytes) {}

  void add(const Image& image) {
    FakeReader reader(image);
    store.add(reader, kNoStep);
  }
  Image read(const TexelRect& rect, std::uint32_t channels) const {
    Image image(rect.width, rect.height, channels);
    store.read(rect, image, 0, 0);
    return image;
  }
  Image level(std::uint32_t image, std::uint32_t number) const {
    const ImageInfo& info = store.info(image);
    const TexelSize size = level_size({info.width, info.height}, number);
    return read({.image = image, .level = number, .width = size.width, .height = size.height},
                info.channels);
  }

  tests::MemoryFiles files;
  storage::MemoryPool pool{0};
  storage::ScratchFile scratch{files, "/models/scratch", pool};
  ImageStore store;
};

std::int64_t wrapped(std::int64_t x, std::int64_t side, Wrap wrap) {
  if (wrap == Wrap::clamp)
    return std::clamp<std::int64_t>(x, 0, side - 1);
  const std::int64_t period = wrap == Wrap::repeat ? side : 2 * side;
  const std::int64_t place = ((x % period) + period) % period;
  return place < side ? place : period - 1 - place;
}

/// Returns the part of a picture that a rectangle shows, texel by texel.
Image shown(const Image& image, const TexelRect& rect, std::uint32_t channels) {
  Image into(rect.width, rect.height, channels);
  for (std::uint32_t y = 0; y < rect.height; ++y) {
    for (std::uint32_t x = 0; x < rect.width; ++x) {
      const auto* from =
          image.at(static_cast<std::uint32_t>(wrapped(rect.x + x, image.width, rect.wrap_u)),
                   static_cast<std::uint32_t>(wrapped(rect.y + y, image.height, rect.wrap_v)));
      for (std::uint32_t c = 0; c < channels; ++c)
        into.at(x, y)[c] = c < image.channels ? from[c] : 255;
    }
  }
  return into;
}

Image halved(const Image& image) {
  const TexelSize size = level_size({image.width, image.height}, 1);
  Image half(size.width, size.height, image.channels);
  for (std::uint32_t y = 0; y < size.height; ++y)
    halve_rows(image.at(0, 2 * y), image.at(0, std::min(2 * y + 1, image.height - 1)), image.width,
               image.channels, half.at(0, y));
  return half;
}

TEST_F(ImageStoreTest, AllLevelsAreThoseOfThePicture) {
  std::uint32_t number = 0;
  for (const auto& [width, height] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {1, 1}, {1, 70}, {65, 1}, {64, 64}, {63, 65}, {128, 129}, {200, 131}, {257, 3}}) {
    for (const std::uint32_t channels : {3U, 4U}) {
      Image expected = noise(width, height, channels, number);
      add(expected);
      ASSERT_EQ(store.levels(number), level_count({width, height}));
      for (std::uint32_t i = 0; i < store.levels(number); ++i) {
        ASSERT_EQ(level(number, i), expected) << width << " x " << height << ", level " << i;
        expected = halved(expected);
      }
      ++number;
    }
  }
  EXPECT_EQ(store.size(), number);
}

TEST_F(ImageStoreTest, RectanglesFollowTheirWraps) {
  const Image opaque = noise(150, 90), clear = noise(70, 65, 4);
  add(opaque);
  add(clear);
  std::uint32_t turn = 0;
  for (const Wrap wrap_u : {Wrap::repeat, Wrap::mirrored, Wrap::clamp}) {
    for (const Wrap wrap_v : {Wrap::repeat, Wrap::mirrored, Wrap::clamp}) {
      for (std::int64_t at = -330; at < 330; at += 13) {
        const TexelRect rect{.image = turn % 2,
                             .x = at,
                             .y = 100 - at,
                             .width = 1 + turn % 211,
                             .height = 1 + turn % 97,
                             .wrap_u = wrap_u,
                             .wrap_v = wrap_v};
        const std::uint32_t channels = 3 + turn / 2 % 2;
        ASSERT_EQ(read(rect, channels), shown(turn % 2 == 0 ? opaque : clear, rect, channels))
            << at;
        ++turn;
      }
    }
  }
}

TEST_F(ImageStoreTest, CoordinatesMayBeAsFarAwayAsNumbersGo) {
  const Image image = noise(100, 100);
  add(image);
  constexpr auto kFar = std::numeric_limits<std::int64_t>::max();
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored, Wrap::clamp}) {
    for (const std::int64_t x : {kFar, -kFar - 1, kFar - 3}) {
      const Image texels =
          read({.x = x, .y = x, .width = 9, .height = 9, .wrap_u = wrap, .wrap_v = wrap}, 3);
      const auto first = static_cast<std::uint32_t>(wrapped(x, 100, wrap));
      ASSERT_TRUE(std::equal(texels.at(0, 0), texels.at(0, 0) + 3, image.at(first, first)));
    }
  }
}

TEST_F(ImageStoreTest, WritesTheRectangleAndNothingElse) {
  const Image image = noise(80, 80);
  add(image);
  Image into(50, 40, 4);
  std::fill(into.texels.begin(), into.texels.end(), std::uint8_t{17});
  store.read({.x = 60, .y = 3, .width = 11, .height = 7}, into, 5, 9);
  for (std::uint32_t y = 0; y < 40; ++y) {
    for (std::uint32_t x = 0; x < 50; ++x) {
      const bool inside = x >= 5 && x < 16 && y >= 9 && y < 16;
      ASSERT_EQ(into.at(x, y)[0], inside ? image.at(x + 55, y - 6)[0] : 17);
      ASSERT_EQ(into.at(x, y)[3], inside ? 255 : 17);
    }
  }
  store.read({.width = 0, .height = 0}, into, 0, 0);
}

TEST_F(ImageStoreTest, EachRowOfBlocksIsTold) {
  const Image image = noise(30, 130);
  FakeReader reader(image);
  std::vector<std::uint64_t> told;
  store.add(reader, [&](std::uint64_t texels) { told.push_back(texels); });
  EXPECT_EQ(told, (std::vector<std::uint64_t>{30 * 64, 30 * 64, 30 * 2}));
}

TEST_F(ImageStoreTest, TakesTheScratchSpaceThatItSays) {
  std::uint64_t bytes = 0;
  for (const auto& [width, height] :
       std::vector<std::pair<std::uint32_t, std::uint32_t>>{{1, 1}, {100, 300}, {64, 65}}) {
    add(noise(width, height));
    add(noise(width, height, 4));
    bytes +=
        ImageStore::stored_bytes(width, height, 3) + ImageStore::stored_bytes(width, height, 4);
  }
  EXPECT_EQ(scratch.size(), bytes);
}

/// The next picture takes the space of one that could not be added.
TEST_F(ImageStoreTest, ABrokenPictureLeavesNothing) {
  const Image image = noise(200, 200);
  for (const bool cancelled : {false, true}) {
    FakeReader broken(image, cancelled ? 200 : 199);
    EXPECT_THROW(store.add(broken,
                           [&](std::uint64_t texels) {
                             if (cancelled && texels < 200 * 64)
                               throw Error(ErrorCode::interrupted, "enough");
                           }),
                 Error);
    EXPECT_EQ(store.size(), 0U);
  }
  add(image);
  EXPECT_EQ(level(0, 0), image);
  EXPECT_EQ(scratch.size(), ImageStore::stored_bytes(200, 200, 3));
}

TEST_F(ImageStoreTest, RealPicturesAreWhatTheyAreInMemory) {
  for (const NamedFile& file : small_files()) {
    const auto reader = open_image(source_of(file.bytes, 100), file.name);
    store.add(*reader, kNoStep);
    const auto last = static_cast<std::uint32_t>(store.size() - 1);
    EXPECT_EQ(store.info(last), reader->info());
    EXPECT_EQ(level(last, 0), decoded(file.bytes)) << file.name;
  }
}

/// Reads many rectangles.
std::vector<Image> read_many(const ImageStore& store) {
  std::vector<Image> images;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const std::uint32_t picture = i % 3;
    Image image(1 + i * 7 % 150, 1 + i * 13 % 90, 4);
    store.read({.image = picture,
                .level = i % store.levels(picture),
                .x = std::int64_t{i} * 37 - 4000,
                .y = 3000 - std::int64_t{i} * 29,
                .width = image.width,
                .height = image.height,
                .wrap_u = static_cast<Wrap>(i % 3),
                .wrap_v = static_cast<Wrap>(i / 3 % 3)},
               image, 0, 0);
    images.push_back(std::move(image));
  }
  return images;
}

TEST_F(ImageStoreTest, TheCacheAndThreadsChangeNothing) {
  std::optional<std::vector<Image>> first;
  for (const std::uint64_t cache_bytes : {0, 20'000, 100'000, 100 << 20}) {
    ImageStore other(scratch, cache_bytes);
    for (const Image& image : {noise(300, 200), noise(65, 129, 4), noise(1, 1)}) {
      FakeReader reader(image);
      other.add(reader, kNoStep);
    }
    std::vector<std::vector<Image>> found(4);
    std::vector<std::thread> threads;
    for (std::vector<Image>& images : found)
      threads.emplace_back([&] { images = read_many(other); });
    for (std::thread& thread : threads)
      thread.join();
    if (!first)
      first = found[0];
    for (const std::vector<Image>& images : found)
      EXPECT_TRUE(images == *first) << cache_bytes;
  }
}

TEST_F(ImageStoreTest, MemoryOfAddingIsOfTheWidth) {
  for (const std::uint32_t height : {1U, 70U, 65535U})
    EXPECT_LE(ImageStore::adding_bytes(16384, height, 3), 2 * 67 * 16384 * 3);
  EXPECT_GE(ImageStore::adding_bytes(16384, 64, 3), 64 * 16384 * 3);
}

/// A store whose process ends, and one that goes on with what it left.
class RestoredStoreTest : public testing::Test {
 protected:
  RestoredStoreTest() {
    storage::ScratchFile scratch(files, kPath, pool, storage::ScratchFile::Stays::yes);
    ImageStore store(scratch, 0);
    for (const Image& image : {first, second}) {
      FakeReader reader(image);
      store.add(reader, kNoStep);
    }
    stored = {store.stored(0), store.stored(1)};
  }

  bool can_restore() {
    storage::ScratchFile scratch(files, kPath, pool, storage::ScratchFile::Stays::yes);
    ImageStore store(scratch, 0);
    const bool restored = store.restore(stored);
    EXPECT_EQ(store.size(), restored ? 2U : 0U);
    return restored;
  }

  static constexpr const char* kPath = "/models/images";
  tests::MemoryFiles files;
  storage::MemoryPool pool{0};
  const Image first = noise(100, 150), second = noise(70, 7, 4);
  std::vector<StoredImage> stored;
};

TEST_F(RestoredStoreTest, GoesOnWithThePictures) {
  storage::ScratchFile scratch(files, kPath, pool, storage::ScratchFile::Stays::yes);
  ImageStore store(scratch, 0);
  ASSERT_TRUE(store.restore(stored));
  FakeReader reader(first);
  store.add(reader, kNoStep);
  for (const std::uint32_t number : {0U, 2U}) {
    Image read(100, 150, 3);
    store.read({.image = number, .width = 100, .height = 150}, read, 0, 0);
    EXPECT_EQ(read, first);
  }
  EXPECT_EQ(store.stored(1), stored[1]);
}

TEST_F(RestoredStoreTest, AnyChangedByteIsFound) {
  auto& bytes = files.bytes(kPath);
  for (std::size_t i = 0; i < bytes.size(); i += 997) {
    bytes[i] ^= std::byte{4};
    EXPECT_FALSE(can_restore()) << i;
    bytes[i] ^= std::byte{4};
  }
  EXPECT_TRUE(can_restore());
  bytes.pop_back();
  EXPECT_FALSE(can_restore());
}

TEST_F(RestoredStoreTest, WhatContradictsItselfIsNotTaken) {
  const std::vector<StoredImage> good = stored;
  const auto refused = [&](const auto& change) {
    stored = good;
    change(stored[0]);
    return !can_restore();
  };
  EXPECT_TRUE(refused([](StoredImage& image) { image.info.width = 0; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.info.width = UINT32_MAX; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.info.height = 65536; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.info.channels = 5; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.info.channels = 4; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.strips.pop_back(); }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.strips.emplace_back(); }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.strips[1].offset = UINT64_MAX; }));
  EXPECT_TRUE(refused([](StoredImage& image) { image.strips[1].checksum ^= 1; }));
}

TEST_F(ImageStoreTest, AMaterialMultipliesLightAndAlpha) {
  const Image picture = noise(70, 70, 4);
  add(picture);
  Material material;
  material.image = 0;
  material.factor = {0.25F, 1, 0, 0.5F};
  material.alpha = AlphaMode::blend;
  Image shown(8, 8, 4);
  MaterialTexels(material, store).read(0, 60, 60, 8, 8, shown, 0, 0);
  for (std::uint32_t y = 0; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) {
      const std::uint8_t* from = picture.at(60 + x, 60 + y);
      const std::uint8_t* to = shown.at(x, y);
      EXPECT_EQ(to[0], screen_value(0.25 * light_of(from[0] / 255.0)));
      EXPECT_EQ(to[1], from[1]);
      EXPECT_EQ(to[2], 0);
      EXPECT_NEAR(to[3], from[3] / 2.0, 0.5);
    }
  }
}

TEST_F(ImageStoreTest, AMaterialAddsItsLightAndCutsAtWhite) {
  const Image picture = noise(30, 1);
  add(picture);
  Material material;
  material.image = 0;
  material.factor = {0.5F, 4, 1, 1};
  material.light = {0.25F, 0, 1};
  Image shown(30, 1, 3);
  MaterialTexels(material, store).read(0, 0, 0, 30, 1, shown, 0, 0);
  for (std::uint32_t x = 0; x < 30; ++x) {
    const std::uint8_t* from = picture.at(x, 0);
    EXPECT_EQ(shown.at(x, 0)[0], screen_value(0.5 * light_of(from[0] / 255.0) + 0.25));
    EXPECT_EQ(shown.at(x, 0)[1], screen_value(4 * light_of(from[1] / 255.0)));
    EXPECT_EQ(shown.at(x, 0)[2], 255);
  }
}

TEST_F(ImageStoreTest, AnOpaqueMaterialHasNoUseForAlpha) {
  const Image picture = noise(20, 30, 4);
  add(picture);
  Material material;
  material.image = 0;
  material.factor[3] = 0.5F;
  Image shown(20, 1, 4);
  MaterialTexels(material, store).read(0, 0, 0, 20, 1, shown, 0, 0);
  for (std::uint32_t x = 0; x < 20; ++x) {
    EXPECT_EQ(shown.at(x, 0)[0], picture.at(x, 0)[0]);
    EXPECT_EQ(shown.at(x, 0)[3], 255);
  }
}

TEST_F(ImageStoreTest, TheCutoffOfAMaskBecomesHalf) {
  const Image picture = noise(64, 64, 4);
  add(picture);
  for (const float cutoff : {0.0F, 0.1F, 0.5F, 0.9F, 1.0F}) {
    Material material;
    material.image = 0;
    material.alpha = AlphaMode::mask;
    material.alpha_cutoff = cutoff;
    Image shown(64, 64, 4);
    MaterialTexels(material, store).read(0, 0, 0, 64, 64, shown, 0, 0);
    for (std::size_t i = 3; i < shown.texels.size(); i += 4) {
      const double alpha = picture.texels[i] / 255.0;
      ASSERT_EQ(shown.texels[i] / 255.0 >= 0.5, alpha >= cutoff) << cutoff << " " << alpha;
      if (cutoff == 0.5F) {
        ASSERT_EQ(shown.texels[i], picture.texels[i]);
      }
    }
  }
}

TEST_F(ImageStoreTest, AMaterialWithoutFactorShowsThePictureWithItsWraps) {
  const Image picture = noise(20, 30);
  add(picture);
  Material material;
  material.image = 0;
  material.wrap_u = Wrap::mirrored;
  Image shown(40, 1, 3);
  MaterialTexels(material, store).read(0, 0, 30, 40, 1, shown, 0, 0);
  for (std::uint32_t x = 0; x < 40; ++x)
    EXPECT_EQ(*shown.at(x, 0), *picture.at(x < 20 ? x : 39 - x, 0));
}

}  // namespace
}  // namespace meshhier::images

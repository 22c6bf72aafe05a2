#include "pipeline/tiles/texture_store.h"

#include "base/error.h"
#include "tests/support/sample_hierarchy.h"

#include <memory>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

TileTexture texture_of(std::uint32_t seed) {
  TileTexture texture;
  texture.image = {ImageFormat::webp, AlphaMode::mask, seed + 1, 9, {}};
  for (std::uint32_t i = 0; i < seed * 5; ++i)
    texture.image.bytes.push_back(static_cast<std::byte>(i));
  const float u = static_cast<float>(seed) / 10;
  texture.corners = {{Vec2f{u, 0}, Vec2f{0, u}, Vec2f{u, u}}};
  return texture;
}

BakeSource source_of(std::uint32_t seed) {
  BakeSource source;
  source.positions = {{0, 0, 0}, {static_cast<float>(seed), 0, 0}, {0, 1, 0}};
  source.triangles = {{TileVertex{0}, TileVertex{1}, TileVertex{2}}};
  source.corners = texture_of(seed).corners;
  source.image = images::Image(4, 3, 4);
  source.image.texels[seed] = 200;
  source.alpha = AlphaMode::blend;
  return source;
}

void expect_equal(const BakeSource& a, const BakeSource& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.image, b.image);
  EXPECT_EQ(a.alpha, b.alpha);
}

class TextureStoreTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kTiles = 4;
  NodeId leaf(std::uint32_t i) const { return {tree_.depth(), i}; }
  void put_all(TextureStore& store) const {
    for (std::uint32_t i = 0; i < kTiles; ++i)
      store.put(leaf(i), texture_of(i), source_of(i), {1.5f, 0.5f, 2.5f});
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  Tree tree_{100, kTiles};
};

TEST_F(TextureStoreTest, AllComesBackWhateverTheCache) {
  for (const std::uint64_t bytes : {0, 300, 1000000}) {
    storage::ScratchFile scratch(*files_, directory_.path() / "scratch", pool_);
    TextureStore store(tree_, scratch);
    store.set_cache_bytes(bytes);
    put_all(store);
    for (const std::uint32_t i : {0U, 1U, 0U, 3U, 2U, 0U}) {
      const TileTexture texture = store.texture(leaf(i));
      EXPECT_EQ(texture.image, texture_of(i).image);
      EXPECT_EQ(texture.corners, texture_of(i).corners);
      expect_equal(*store.source(leaf(i)), source_of(i));
      EXPECT_EQ(store.texels(leaf(i)).own, 1.5f);
      EXPECT_EQ(store.texels(leaf(i)).finest, 0.5f);
    }
    EXPECT_EQ(store.image_bytes(), 5U * (0 + 1 + 2 + 3));
  }
}

TEST_F(TextureStoreTest, AnotherProcessRestoresIt) {
  nlohmann::json stored;
  {
    storage::ScratchFile scratch(*files_, directory_.path() / "scratch", pool_,
                                 storage::ScratchFile::Stays::yes);
    TextureStore store(tree_, scratch);
    put_all(store);
    stored = store.stored(leaf(2));
  }
  storage::ScratchFile scratch(*files_, directory_.path() / "scratch", pool_,
                               storage::ScratchFile::Stays::yes);
  TextureStore store(tree_, scratch);
  ASSERT_TRUE(store.restore(leaf(2), stored));
  EXPECT_EQ(store.texture(leaf(2)).image, texture_of(2).image);
  expect_equal(*store.source(leaf(2)), source_of(2));
  EXPECT_EQ(store.texels(leaf(2)).finest, 0.5f);
  EXPECT_EQ(store.texels(leaf(2)).lost, 2.5f);
  stored["source"][2] = 1;  // its checksum
  EXPECT_FALSE(store.restore(leaf(1), stored));
}

}  // namespace
}  // namespace meshhier::pipeline

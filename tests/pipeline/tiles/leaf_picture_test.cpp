#include "pipeline/tiles/leaf_picture.h"

#include "images/image_codec.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::pipeline {
namespace {

using images::Image;
using Colour = std::array<std::uint8_t, 3>;

constexpr Colour kRed{200, 10, 20}, kGreen{30, 180, 40}, kBlue{0, 0, 255};

Image picture(std::uint32_t width, std::uint32_t height,
              const std::function<Colour(std::uint32_t x, std::uint32_t y)>& colour) {
  Image image(width, height, 3);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x)
      std::ranges::copy(colour(x, y), image.at(x, y));
  }
  return image;
}

Colour colour_at(const Image& image, std::uint32_t x, std::uint32_t y) {
  return {image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]};
}

texture::CornerTexcoords triangle(const texture::LeafAtlas& atlas,
                                  const std::array<std::array<std::uint32_t, 2>, 3>& texels) {
  texture::CornerTexcoords corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = {static_cast<float>(texels[k][0]) / static_cast<float>(atlas.width),
                  static_cast<float>(texels[k][1]) / static_cast<float>(atlas.height)};
  }
  return corners;
}

/// All of the piece but the gutter.
void add_triangles(const texture::AtlasPiece& piece, texture::LeafAtlas& atlas) {
  const std::uint32_t left = piece.atlas_x + texture::kLeafGutter;
  const std::uint32_t top = piece.atlas_y + texture::kLeafGutter;
  const std::uint32_t right = piece.atlas_x + piece.width - texture::kLeafGutter;
  const std::uint32_t bottom = piece.atlas_y + piece.height - texture::kLeafGutter;
  atlas.corners.push_back(triangle(atlas, {{{left, top}, {right, top}, {right, bottom}}}));
  atlas.corners.push_back(triangle(atlas, {{{left, top}, {right, bottom}, {left, bottom}}}));
}

class LeafPictureTest : public testing::Test {
 protected:
  /// A material that shows it.
  std::uint32_t add(const Image& image) {
    const std::vector<std::byte> png = images::encode_image(image, ImageFormat::png, 100);
    const auto reader = images::open_image(
        [&](std::uint64_t offset, std::span<std::byte> into) {
          const std::size_t count = std::min<std::size_t>(into.size(), png.size() - offset);
          std::copy_n(png.begin() + static_cast<std::ptrdiff_t>(offset), count, into.begin());
          return count;
        },
        "a picture");
    store_.add(*reader, [](std::uint64_t) {});
    images::Material material;
    material.image = static_cast<std::uint32_t>(store_.size() - 1);
    return add(material);
  }
  std::uint32_t add(const images::Material& material) {
    materials_.materials.push_back(material);
    return static_cast<std::uint32_t>(materials_.materials.size() - 1);
  }
  Image painted(texture::LeafAtlas atlas) const {
    for (const texture::AtlasPiece& piece : atlas.pieces)
      add_triangles(piece, atlas);
    return painted_for(atlas);
  }
  Image painted_for(const texture::LeafAtlas& atlas) const {
    const TexturedInput input{materials_, store_};
    const LeafPicture leaf(atlas, atlas.corners, input);
    Image whole(atlas.width, atlas.height, leaf.channels());
    bands_ = 0;
    for (std::uint32_t top = 0; top < atlas.height; ++bands_) {
      const Image band = leaf.band(top);
      EXPECT_EQ(band.height % texture::kLeafAlignment, 0U);
      std::ranges::copy(band.texels, whole.at(0, top));
      top += band.height;
    }
    return whole;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*files_, directory_.path() / "scratch", pool_};
  images::ImageStore store_{scratch_, 1 << 20};
  images::MaterialList materials_;
  mutable int bands_ = 0;
};

// Smaller pictures that viewers make of it would have black in them.
TEST_F(LeafPictureTest, BetweenPiecesAreTheColoursOfTheNearest) {
  const std::uint32_t red = add(picture(64, 64, [](auto, auto) { return kRed; }));
  const std::uint32_t green = add(picture(8, 8, [](auto, auto) { return kGreen; }));
  images::Material plain;
  plain.colour = {0, 0, 1, 1};
  texture::LeafAtlas atlas{64, 40, {}, {}, 3, 0};
  atlas.pieces = {{red, 0, 3, 5, 0, 0, 24, 16},
                  {green, 0, -4, 0, 40, 24, 24, 16},
                  {add(plain), 0, 0, 0, 0, 32, 8, 8}};
  const Image image = painted(atlas);
  ASSERT_EQ(image.channels, 3U);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const Colour at = colour_at(image, x, y);
      ASSERT_TRUE(at == kRed || at == kGreen || at == kBlue) << x << ", " << y;
    }
  }
  EXPECT_EQ(colour_at(image, 24, 3), kRed);
  EXPECT_EQ(colour_at(image, 39, 39), kGreen);
  EXPECT_EQ(colour_at(image, 63, 20), kGreen);
  EXPECT_EQ(colour_at(image, 9, 35), kBlue);
}

TEST_F(LeafPictureTest, BandsHaveEachTexelOfThePieces) {
  const Image input = picture(300, 700, [](std::uint32_t x, std::uint32_t y) {
    return Colour{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                  static_cast<std::uint8_t>(x * y)};
  });
  const std::uint32_t material = add(input);
  texture::LeafAtlas atlas{4096, 600, {}, {}, 2, 0};
  atlas.pieces = {{material, 0, 20, 40, 8, 16, 240, 560}, {material, 0, 30, 0, 3000, 248, 200, 16}};
  const Image image = painted(atlas);
  EXPECT_GT(bands_, 2);
  for (const texture::AtlasPiece& piece : atlas.pieces) {
    for (std::uint32_t y = 0; y < piece.height; ++y) {
      for (std::uint32_t x = 0; x < piece.width; ++x)
        ASSERT_EQ(colour_at(image, piece.atlas_x + x, piece.atlas_y + y),
                  colour_at(input, static_cast<std::uint32_t>(piece.x) + x,
                            static_cast<std::uint32_t>(piece.y) + y));
    }
  }
}

// Charts are no rectangles: what is beside them in the input may be black, or another chart.
TEST_F(LeafPictureTest, OfAPieceWhatItsTrianglesShowIsKept) {
  const auto is_beside = [](std::uint32_t x, std::uint32_t y) { return x > y + 12; };
  const Image input = picture(128, 128, [&](std::uint32_t x, std::uint32_t y) {
    return is_beside(x, y) ? Colour{} : kRed;
  });
  texture::LeafAtlas atlas{128, 128, {}, {}, 1, 0};
  atlas.pieces = {{add(input), 0, 0, 0, 0, 0, 128, 128}};
  atlas.corners = {triangle(atlas, {{{4, 4}, {124, 124}, {4, 124}}})};
  const Image image = painted_for(atlas);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (x <= y + 4) {
        ASSERT_EQ(colour_at(image, x, y), kRed) << x << ", " << y;
      } else if (x > y + 24) {
        ASSERT_GT(colour_at(image, x, y)[0], 100) << x << ", " << y;
      }
    }
  }
}

// It has no texel's middle, and still a bilinear lookup sees texels beside it.
TEST_F(LeafPictureTest, ThinTrianglesKeepTheirGutter) {
  const Image input = picture(128, 64, [](std::uint32_t x, std::uint32_t y) {
    return Colour{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 99};
  });
  texture::LeafAtlas atlas{128, 64, {}, {}, 1, 0};
  atlas.pieces = {{add(input), 0, 0, 0, 0, 0, 128, 64}};
  atlas.corners = {triangle(atlas, {{{4, 4}, {124, 60}, {64, 32}}})};
  const Image image = painted_for(atlas);
  for (std::uint32_t x = 4; x < 124; ++x) {
    const std::uint32_t middle = 4 + (x - 4) * 56 / 120;
    for (std::uint32_t y = middle - 4; y < middle + 4; ++y)
      ASSERT_EQ(colour_at(image, x, y), colour_at(input, x, y)) << x << ", " << y;
  }
}

// Pictures of opaque materials may have alpha, which nobody sees.
TEST_F(LeafPictureTest, OpaqueMaterialsHaveNoHolesBesideOthers) {
  Image clear(16, 16, 4);  // all alpha is 0
  const std::uint32_t opaque = add(clear);
  images::Material colour, blend, mask;
  colour.colour[3] = 0.25F;
  blend.alpha = AlphaMode::blend;
  blend.colour[3] = 0.5F;
  mask.alpha = AlphaMode::mask;
  mask.alpha_cutoff = 0.1F;
  mask.colour[3] = 0.25F;
  texture::LeafAtlas atlas{64, 16, {}, {}, 4, 0};
  atlas.pieces = {{opaque, 0, 0, 0, 0, 0, 16, 16},
                  {add(colour), 0, 0, 0, 16, 0, 16, 16},
                  {add(blend), 0, 0, 0, 32, 0, 16, 16},
                  {add(mask), 0, 0, 0, 48, 0, 16, 16}};
  const Image image = painted(atlas);
  ASSERT_EQ(image.channels, 4U);
  EXPECT_EQ(image.at(8, 8)[3], 255);
  EXPECT_EQ(image.at(24, 8)[3], 255);
  EXPECT_EQ(image.at(40, 8)[3], 128);
  EXPECT_EQ(image.at(56, 8)[3], 255);
}

TEST_F(LeafPictureTest, AlphaIsThatOfTheStrongestMaterialShown) {
  images::Material blend;
  blend.alpha = AlphaMode::blend;
  blend.colour = {1, 1, 1, 0.5f};
  add(images::Material{});
  add(blend);
  texture::LeafAtlas atlas{16, 8, {}, {}, 1, 0};
  atlas.pieces = {{0, 0, 0, 0, 0, 0, 8, 8}};
  EXPECT_EQ(painted(atlas).channels, 3U);
  atlas.pieces[0].material = 1;
  const Image clear = painted(atlas);
  ASSERT_EQ(clear.channels, 4U);
  EXPECT_EQ(clear.at(15, 7)[3], 128);
}

}  // namespace
}  // namespace meshhier::pipeline

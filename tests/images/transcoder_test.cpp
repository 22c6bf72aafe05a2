// KTX2 of UASTC, judged by what browsers have for it: the transcoder of Basis Universal, and
// ktx-parse.
#include "base/error.h"
#include "images/image_codec.h"
#include "images/ktx2_writer.h"
#include "images/pyramid.h"
#include "images/uastc_block.h"
#include "images/uastc_picture.h"
#include "storage/io/child_process.h"
#include "storage/io/worker_pool.h"
#include "tests/images/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::HasSubstr;

enum Format : std::uint32_t {
  kEtc1 = 0,
  kEtc2 = 1,
  kBc1 = 2,
  kBc3 = 3,
  kBc7 = 6,
  kAstc = 10,
  kRgba = 13,
  kParsed = 0x1000  ///< of ktx-parse
};

const std::string kFolder = MESHHIER_SOURCE_DIR "/images/ktx2";

class TranscoderTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!storage::find_program("node"))
      GTEST_SKIP() << "skipped: Node.js, which runs the transcoder of browsers, is not in PATH";
    if (!std::filesystem::exists(kFolder + "/node_modules/ktx2-encoder"))
      GTEST_SKIP() << "skipped: the transcoder of browsers is not there: npm ci --prefix "
                   << kFolder;
  }

  Bytes ask(Format format, const Bytes& file, std::uint32_t level = 0) {
    const std::array numbers{std::uint32_t{format}, level, static_cast<std::uint32_t>(file.size())};
    const auto answer = pool_.ask(numbers, file);
    if (!answer || !answer->is_good)
      throw Error(ErrorCode::internal,
                  answer ? std::string(reinterpret_cast<const char*>(answer->bytes.data()),
                                       answer->bytes.size())
                         : "it is ended");
    return answer->bytes;
  }
  Image rgba(const Bytes& file, TexelSize size, std::uint32_t level = 0) {
    Image image(size.width, size.height, 4);
    const Bytes bytes = ask(kRgba, file, level);
    EXPECT_EQ(bytes.size(), image.texels.size());
    std::ranges::transform(bytes, image.texels.begin(),
                           [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    return image;
  }

 private:
  storage::WorkerPool pool_{"the transcoder", 1, [] {
                              return std::vector<std::string>{
                                  *storage::find_program("node"),
                                  MESHHIER_SOURCE_DIR "/tests/images/transcoder.mjs", kFolder};
                            }};
};

/// Returns one with edges and noise besides.
Image painted(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image = smooth(width, height, channels);
  const Image grain = noise(width, height, channels);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = width / 4; x < width; ++x) {
      for (std::uint32_t c = 0; c < channels; ++c) {
        std::uint8_t& value = image.at(x, y)[c];
        if (x >= width / 2 && (x / 7 + y / 5) % 2 == 0)
          value = static_cast<std::uint8_t>(c == 0 ? 220 : 30);
        if (x < width / 2 || x >= 3 * width / 4)
          value = static_cast<std::uint8_t>(std::clamp(value + grain.at(x, y)[c] / 16 - 8, 0, 255));
      }
    }
  }
  return image;
}

/// Returns the peak signal-to-noise ratio of the first three channels, in dB.
double psnr(const Image& a, const Image& b) {
  double sum = 0;
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(double{1} * a.at(x, y)[c] - b.at(x, y)[c], 2);
    }
  }
  return 10 * std::log10(255.0 * 255 * 3 * a.width * a.height / sum);
}

std::uint32_t byte_of(const std::byte* bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]);
}

/// Decodes a picture of blocks of 8 bytes by `decode(block, x, y, texel)`.
template <class Decode>
Image of_blocks(const Bytes& blocks, const Image& shape, const Decode& decode) {
  Image image(shape.width, shape.height, 3);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x)
      decode(blocks.data() + 8 * (std::size_t{y / 4} * (image.width / 4) + x / 4), x % 4, y % 4,
             image.at(x, y));
  }
  return image;
}

void decode_etc1(const std::byte* b, std::uint32_t x, std::uint32_t y, std::uint8_t* texel) {
  constexpr std::array<std::array<int, 2>, 8> kSteps{
      {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}}};
  const std::uint32_t flags = byte_of(b, 3), half = (flags & 1) != 0 ? y / 2 : x / 2,
                      bit = 4 * x + y;
  const auto& [small, large] = kSteps[half == 0 ? flags >> 5 : flags >> 2 & 7];
  const std::uint32_t high = (byte_of(b, 4) << 8 | byte_of(b, 5)) >> bit & 1,
                      low = (byte_of(b, 6) << 8 | byte_of(b, 7)) >> bit & 1;
  const int step = (high != 0 ? -1 : 1) * (low != 0 ? large : small);
  for (std::size_t c = 0; c < 3; ++c) {
    const int value = static_cast<int>(byte_of(b, c));
    int colour = half == 0 ? (value >> 4) * 17 : (value & 15) * 17;
    if ((flags & 2) != 0) {
      const int change = (value & 7) > 3 ? (value & 7) - 8 : value & 7;
      const int five = (value >> 3) + (half == 0 ? 0 : change);
      colour = five << 3 | five >> 2;
    }
    texel[c] = static_cast<std::uint8_t>(std::clamp(colour + step, 0, 255));
  }
}

void decode_bc1(const std::byte* b, std::uint32_t x, std::uint32_t y, std::uint8_t* texel) {
  std::array<std::uint32_t, 2> ends{byte_of(b, 0) | byte_of(b, 1) << 8,
                                    byte_of(b, 2) | byte_of(b, 3) << 8};
  const auto channel = [&](std::size_t end, std::size_t c) {
    const std::uint32_t bits = c == 1 ? ends[end] >> 5 & 63 : ends[end] >> (c == 0 ? 11 : 0) & 31;
    return c == 1 ? bits << 2 | bits >> 4 : bits << 3 | bits >> 2;
  };
  const std::uint32_t place = byte_of(b, 4 + y) >> (2 * x) & 3;
  const std::array<std::uint32_t, 4> thirds{3, 0, 2, 1};
  for (std::size_t c = 0; c < 3; ++c)
    texel[c] = static_cast<std::uint8_t>(
        (channel(0, c) * thirds[place] + channel(1, c) * (3 - thirds[place])) / 3);
}

/// Random bits of a mode, without patterns that there are not.
std::vector<UastcBytes> random_blocks(std::uint8_t number, std::size_t count) {
  const UastcMode& mode = uastc_mode(number);
  std::mt19937 random(number);
  std::vector<UastcBytes> blocks;
  while (blocks.size() < count) {
    UastcBytes bytes;
    for (std::byte& byte : bytes)
      byte = static_cast<std::byte>(random());
    const auto kept = static_cast<std::byte>(0xffU << mode.code_bits);
    bytes[0] = (bytes[0] & kept) | static_cast<std::byte>(mode.code);
    if (unpack_block(bytes))
      blocks.push_back(bytes);
  }
  return blocks;
}

TEST_F(TranscoderTest, ABlockOfAnyBitsIsReadAlike) {
  constexpr std::uint32_t kSide = 1024;
  for (std::uint8_t mode = 0; mode < kUastcModes; ++mode) {
    const std::vector<std::vector<UastcBytes>> levels{
        random_blocks(mode, kSide * kSide / kBlockTexels)};
    const Bytes file = ktx2_file({{kSide, kSide}, true, Ktx2Meaning::colours}, levels);
    EXPECT_TRUE(rgba(file, {kSide, kSide}) == decoded(file)) << "mode " << int{mode};
  }
}

TEST_F(TranscoderTest, EncodedPicturesAreReadAlikeAndAreGoodBlocksOfAllKinds) {
  struct Least {
    Image image;
    double uastc, etc1, bc1;
  };
  for (const auto& [image, uastc, etc1, bc1] :
       {Least{smooth(256, 192, 3), 42, 34, 36}, {painted(256, 192, 3), 34, 20, 27}}) {
    const Bytes file = encode_uastc(image, Ktx2Meaning::colours);
    const Image own = decoded(file);
    ASSERT_EQ(own.channels, 3U);
    EXPECT_EQ(psnr(rgba(file, {256, 192}), image), psnr(own, image));
    EXPECT_GE(psnr(own, image), uastc);
    EXPECT_GE(psnr(of_blocks(ask(kEtc1, file), image, decode_etc1), image), etc1);
    EXPECT_GE(psnr(of_blocks(ask(kBc1, file), image, decode_bc1), image), bc1);
    for (const Format format : {kEtc2, kBc3, kBc7, kAstc})
      EXPECT_EQ(ask(format, file).size(), 256U * 192);
  }
}

TEST_F(TranscoderTest, AlphaIsKept) {
  Image image = painted(64, 64, 4);
  for (std::uint32_t i = 0; i < 64 * 64; ++i)
    image.texels[4 * i + 3] = static_cast<std::uint8_t>(i % 64 < 30   ? 255
                                                        : i % 64 < 40 ? 4 * (i % 64)
                                                                      : 0);
  const Bytes file = encode_uastc(image, Ktx2Meaning::colours);
  const Image own = decoded(file);
  EXPECT_TRUE(rgba(file, {64, 64}) == own);
  for (std::uint32_t i = 0; i < 64 * 64; ++i)
    ASSERT_NEAR(own.texels[4 * i + 3], image.texels[4 * i + 3], 24) << i;
  // EAC's alpha stands before each block of ETC2.
  EXPECT_EQ(ask(kEtc2, file).size(), 64U * 64);
}

TEST_F(TranscoderTest, EachLevelIsHalfOfTheLargerOne) {
  for (const TexelSize size : {TexelSize{128, 128}, TexelSize{108, 36}, TexelSize{4, 64}}) {
    const Image image = smooth(size.width, size.height, 3);
    const Bytes file = encode_uastc(image, Ktx2Meaning::colours);
    Image larger = rgba(file, size);
    std::uint32_t level = 0;
    while (larger.width > 1 || larger.height > 1) {
      const TexelSize half{std::max(larger.width / 2, 1U), std::max(larger.height / 2, 1U)};
      const Image smaller = rgba(file, half, ++level);
      std::vector<std::uint8_t> means(std::size_t{half.width} * 4);
      double sum = 0;
      for (std::uint32_t y = 0; y < half.height; ++y) {
        halve_rows(larger.at(0, std::min(2 * y, larger.height - 1)),
                   larger.at(0, std::min(2 * y + 1, larger.height - 1)),
                   std::max(larger.width / 2 * 2, 1U), 4, means.data());
        for (std::size_t i = 0; i < means.size(); ++i)
          sum += std::pow(double{1} * means[i] - smaller.at(0, y)[i], 2);
      }
      EXPECT_LE(std::sqrt(sum / (4.0 * half.width * half.height)), 20)
          << size.width << " level " << level;
      larger = smaller;
    }
  }
}

TEST_F(TranscoderTest, DirectionsAreUnitVectorsAtEachLevel) {
  Image image(64, 64, 3);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const double u = 0.5 * std::sin(0.4 * x), v = 0.4 * std::cos(0.5 * y);
      const std::array normal{u, v, std::sqrt(1 - u * u - v * v)};
      for (std::size_t k = 0; k < 3; ++k)
        image.at(x, y)[k] = static_cast<std::uint8_t>(std::lround(127.5 * (normal[k] + 1)));
    }
  }
  const Bytes file = encode_uastc(image, Ktx2Meaning::directions);
  for (std::uint32_t level = 0; level < 7; ++level) {
    const std::uint32_t side = 64U >> level;
    const Image read = rgba(file, {side, side}, level);
    for (std::uint32_t i = 0; i < side * side; ++i) {
      double square = 0;
      for (std::size_t c = 0; c < 3; ++c)
        square += std::pow(read.texels[4 * i + c] / 127.5 - 1, 2);
      ASSERT_NEAR(std::sqrt(square), 1, 0.12) << level;
    }
  }
}

TEST_F(TranscoderTest, TheContainerIsAsTheSpecificationHasIt) {
  const Bytes file = encode_uastc(painted(36, 20, 4), Ktx2Meaning::colours);
  const Bytes answer = ask(kParsed, file);
  const std::string json(reinterpret_cast<const char*>(answer.data()), answer.size());
  for (
      const char* part :
      {R"("vkFormat":0,"typeSize":1,"pixelWidth":36,"pixelHeight":20,"pixelDepth":0,"layerCount":0,"faceCount":1,"levelCount":6,"supercompressionScheme":2)",
       R"("levels":[720,240,96,16,16,16])",
       R"("colorModel":166,"colorPrimaries":1,"transferFunction":2,"flags":0,"texelBlockDimension":[3,3,0,0],"bytesPlane":[16,0,0,0,0,0,0,0])",
       R"("samples":[{"bitOffset":0,"bitLength":127,"channelType":3,)",
       R"("sampleLower":0,"sampleUpper":4294967295)", R"("keyValue":{"KTXwriter":"meshhier"})"})
    EXPECT_THAT(json, HasSubstr(part));
  const Bytes directions = ask(kParsed, encode_uastc(painted(36, 20, 3), Ktx2Meaning::directions));
  const std::string other(reinterpret_cast<const char*>(directions.data()), directions.size());
  EXPECT_THAT(other, HasSubstr(R"("transferFunction":1)"));
  EXPECT_THAT(other, HasSubstr(R"("channelType":0,)"));
}

TEST_F(TranscoderTest, WhatIsBrokenIsRefusedByBoth) {
  std::vector<std::vector<UastcBytes>> levels{random_blocks(0, 4)};
  levels[0][2][0] = std::byte{0x45};
  const Bytes file = ktx2_file({{8, 8}, false, Ktx2Meaning::colours}, levels);
  EXPECT_THAT(refusal([&] { decoded(file); }), HasSubstr("a mode or a pattern that there is not"));
  EXPECT_THROW(ask(kRgba, file), Error);
}

}  // namespace
}  // namespace meshhier::images

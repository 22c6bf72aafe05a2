#include "base/error.h"
#include "images/image_codec.h"
#include "images/ktx2_coder.h"
#include "images/row_writer.h"
#include "storage/io/little_endian.h"
#include "storage/io/own_program.h"
#include "storage/io/process.h"
#include "tests/images/samples.h"
#include "tests/support/error_message.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::HasSubstr;

/// Returns the root mean square over all channels of all texels.
double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    sum += std::pow(double{1} * a.texels[i] - b.texels[i], 2);
  return std::sqrt(sum / static_cast<double>(a.texels.size()));
}

/// ETC1S, which Node.js codes.
class Ktx2Test : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_for_ktx2(); !missing.empty())
      GTEST_SKIP() << "skipped: " << missing;
  }
  void TearDown() override { end_ktx2_coders(); }
};

void expect_near(int quality, double most) {
  for (const std::uint32_t channels : {3U, 4U}) {
    const Image image = smooth(96, 60, channels);
    const Bytes file = encode_image(image, ImageFormat::ktx2, quality);
    const ImageInfo info = open_image(source_of(file), "sample")->info();
    EXPECT_EQ(info.format, ImageFormat::ktx2);
    EXPECT_EQ(info.channels, channels);
    const Image read = decoded(file);
    ASSERT_EQ(read.channels, channels);
    EXPECT_LE(rms(read, image), most) << channels << " channels, quality " << quality;
  }
}

TEST_F(Ktx2Test, PicturesComeBackNearly) {
  expect_near(90, 8);
}

TEST(UastcFileTest, PicturesComeBackMoreNearly) {
  expect_near(100, 2.5);
}

TEST_F(Ktx2Test, MoreQualityIsNearerAndLarger) {
  const Image image = smooth(128, 128, 3);
  const Bytes low = encode_image(image, ImageFormat::ktx2, 5),
              high = encode_image(image, ImageFormat::ktx2, 99);
  EXPECT_LT(low.size(), high.size());
  EXPECT_GT(rms(decoded(low), image), rms(decoded(high), image));
}

TEST(UastcFileTest, DirectionsStayWithinADegree) {
  Image image(64, 64, 3);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const double u = 0.5 * std::sin(0.1 * x), v = 0.4 * std::cos(0.13 * y);
      const std::array normal{u, v, std::sqrt(1 - u * u - v * v)};
      for (std::size_t k = 0; k < 3; ++k)
        image.at(x, y)[k] = static_cast<std::uint8_t>(std::lround(127.5 * (normal[k] + 1)));
    }
  }
  const Bytes file = encode_normal_map(image, {ImageFormat::ktx2, 50});
  EXPECT_LE(rms(decoded(file), image), 2.2);  // 127.5 times the sine of a degree
  EXPECT_EQ(file, encode_normal_map(image, {ImageFormat::ktx2, 100}));
}

TEST_F(Ktx2Test, AllThreadsWriteTheSameBytes) {
  const Image image = smooth(64, 64, 3);
  const Bytes first = encode_image(image, ImageFormat::ktx2, 90);
  std::vector<Bytes> files(6);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < files.size(); ++i)
    threads.emplace_back([&, i] {
      if (i % 2 == 0)  // the pictures that a coder had before decide nothing
        encode_image(smooth(32, 64, 4), ImageFormat::ktx2, 30);
      files[i] = encode_image(image, ImageFormat::ktx2, 90);
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_THAT(files, testing::Each(first));
}

TEST_F(Ktx2Test, RowsMakeTheSameFile) {
  const Image image = smooth(32, 48, 4);
  const WrittenImage written{ImageFormat::ktx2, 90, 32, 48, 4};
  Bytes bytes;
  const auto writer = open_picture_writer(written, [&](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  });
  for (std::uint32_t y = 0; y < 48; ++y)
    writer->write_row(image.at(0, y));
  writer->finish();
  EXPECT_EQ(bytes, encode_image(image, ImageFormat::ktx2, 90));
  EXPECT_GT(held_bytes(written), ktx2_coder_bytes(32 * 48));
}

/// Nearly all bits make blocks of UASTC: `least` of twelve changes are refused.
void expect_broken_ones_refused(int quality, int least) {
  const Image image = smooth(64, 64, 3);
  const Bytes file = encode_image(image, ImageFormat::ktx2, quality);
  for (std::size_t length = 12; length < file.size(); length += 1 + file.size() / 40) {
    const Bytes part(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_THAT(refusal([&] { decoded(part); }), HasSubstr("ends early")) << length;
  }
  int refused = 0;
  for (std::size_t at = 12; at < file.size(); at += 1 + file.size() / 12) {
    Bytes other = file;
    other[at] ^= std::byte{0x55};
    refused += refusal([&] { decoded(other); }).empty() ? 0 : 1;
  }
  EXPECT_GE(refused, least);
  EXPECT_EQ(encode_image(image, ImageFormat::ktx2, quality), file);
}

/// Whatever is wrong, the next picture is coded.
TEST_F(Ktx2Test, BrokenOnesAreRefused) {
  expect_broken_ones_refused(90, 3);
}

TEST(UastcFileTest, BrokenOnesAreRefused) {
  expect_broken_ones_refused(100, 1);
}

TEST(UastcFileTest, NothingOfItNeedsAnotherProgram) {
  const Image image = smooth(64, 64, 3);
  ASSERT_EQ(::setenv("MESHHIER_KTX2", "/nowhere", 1), 0);
  const Bytes file = encode_image(image, ImageFormat::ktx2, 100);
  EXPECT_EQ(open_image(source_of(file), "sample")->missing(), "");
  EXPECT_LE(rms(decoded(file), image), 2.5);
  ASSERT_EQ(::unsetenv("MESHHIER_KTX2"), 0);
}

TEST(UastcFileTest, LevelsThatAreNotOfTheirSizeAreRefused) {
  const Bytes file = encode_image(smooth(64, 64, 3), ImageFormat::ktx2, 100);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Bytes other = file;
    other[at] = std::byte{value};
    return refusal([&] { decoded(other); });
  };
  EXPECT_THAT(with(80 + 17, 17), HasSubstr("its blocks are not those of its size"));
  EXPECT_THAT(with(44, 0), HasSubstr("its blocks are not those of its size"));
  EXPECT_THAT(with(44, 1), HasSubstr("(ETC1S, UASTC)"));
  const std::size_t level = storage::load_little<std::uint32_t>(file.data() + 80);
  EXPECT_THAT(with(level, 0), HasSubstr("no Zstandard data"));
}

TEST(UastcFileTest, SizesThatCannotBeAreRefusedBeforeAnythingIsMade) {
  Bytes file = encode_image(smooth(64, 64, 3), ImageFormat::ktx2, 100);
  const auto with = [&](std::size_t at, std::uint8_t value) {
    Bytes other = file;
    other[at] = std::byte{value};
    return refusal([&] { open_image(source_of(other), "tile"); });
  };
  EXPECT_THAT(with(23, 1), HasSubstr("tile: the picture is broken: a side has no texels"));
  EXPECT_THAT(with(28, 2), HasSubstr("single pictures"));
  EXPECT_THAT(with(40, 99), HasSubstr("single pictures"));
  EXPECT_THAT(with(80 + 15, 9), HasSubstr("larger than any picture of its size"));
  EXPECT_THAT(with(55, 200), HasSubstr("impossible size"));
}

/// Nothing of this needs Node.js.
TEST(Ktx2MissingTest, WhatIsMissingIsSaid) {
  const char* const path = std::getenv("PATH");
  const std::string before = path == nullptr ? "" : path;
  ASSERT_EQ(::setenv("PATH", "/nowhere", 1), 0);
  EXPECT_THAT(missing_for_ktx2(), HasSubstr("Node.js 18 or later, which is not in PATH"));
  try {
    encode_image(smooth(4, 4, 3), ImageFormat::ktx2, 90);
    ADD_FAILURE() << "a picture was coded by nobody";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_EQ(error.what(), missing_for_ktx2());
  }
  ASSERT_EQ(::setenv("PATH", before.c_str(), 1), 0);
}

TEST(Ktx2MissingTest, AnotherPlaceOfTheCoderIsTaken) {
  if (missing_for_ktx2().find("Node.js 18 or later, which") != std::string::npos)
    GTEST_SKIP() << missing_for_ktx2();
  ASSERT_EQ(::setenv("MESHHIER_KTX2", "/nowhere", 1), 0);
  EXPECT_THAT(missing_for_ktx2(), HasSubstr("is not in /nowhere"));
  ASSERT_EQ(::unsetenv("MESHHIER_KTX2"), 0);
}

/// A folder with a coder of the test's own.
class OwnCoder {
 public:
  explicit OwnCoder(const std::string& script) {
    const std::filesystem::path library = directory_ / "node_modules/ktx2-encoder/dist/basis";
    std::filesystem::create_directories(library);
    std::ofstream(library / "basis_encoder.js") << "";
    std::ofstream(directory_ / "package.json") << R"({"type": "module"})";
    std::ofstream(directory_ / "coder.mjs") << script;
    ::setenv("MESHHIER_KTX2", directory_.c_str(), 1);
  }
  OwnCoder(const OwnCoder&) = delete;
  OwnCoder& operator=(const OwnCoder&) = delete;
  ~OwnCoder() {
    ::unsetenv("MESHHIER_KTX2");
    end_ktx2_coders();
    std::filesystem::remove_all(directory_);
  }
  const std::filesystem::path& path() const { return directory_; }

 private:
  const std::filesystem::path directory_ = storage::make_temporary_directory();
};

std::string coding_failure() {
  return tests::error_message(ErrorCode::io,
                              [&] { encode_image(smooth(4, 4, 3), ImageFormat::ktx2, 90); });
}

TEST_F(Ktx2Test, ACoderThatIsKilledIsReplaced) {
  // The first one ends when it has a picture, the next one is the real one.
  const OwnCoder coder(R"(
    import { existsSync, readSync, writeFileSync, writeSync } from 'node:fs';
    const mark = new URL('mark', import.meta.url);
    if (existsSync(mark)) {
      await import(process.env.MESHHIER_REAL_CODER);
    } else {
      writeFileSync(mark, '');
      writeSync(1, Buffer.from([2, 0, 0, 0]));
      readSync(0, Buffer.alloc(20));
    }
  )");
  const std::filesystem::path real =
      (std::filesystem::path(storage::own_directory()) / "../../images/ktx2/coder.mjs")
          .lexically_normal();
  ::setenv("MESHHIER_REAL_CODER", real.c_str(), 1);
  const Bytes file = encode_image(smooth(16, 16, 3), ImageFormat::ktx2, 90);
  EXPECT_TRUE(std::filesystem::exists(coder.path() / "mark"));
  ::unsetenv("MESHHIER_REAL_CODER");
  EXPECT_EQ(open_image(source_of(file), "sample")->info().width, 16U);
}

TEST_F(Ktx2Test, CodersThatAlwaysEndAreGivenUp) {
  const OwnCoder coder("process.stdout.write(Buffer.from([2, 0, 0, 0]));");
  EXPECT_THAT(coding_failure(), HasSubstr("are ended while they have a picture"));
}

TEST_F(Ktx2Test, ACoderOfAnotherKindIsNotSpokenWith) {
  for (const char* script : {"process.exit(3);", "process.stdout.write('hello');"}) {
    const OwnCoder coder(script);
    EXPECT_THAT(coding_failure(), HasSubstr("does not start"));
  }
}

TEST_F(Ktx2Test, WhatTheCoderSaysIsWrongIsTold) {
  const OwnCoder coder(R"(
    process.stdout.write(Buffer.from([2, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0]));
    process.stdout.write('why');
    process.stdin.resume();
  )");
  try {
    encode_image(smooth(4, 4, 3), ImageFormat::ktx2, 90);
    ADD_FAILURE() << "a picture was coded";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
    EXPECT_STREQ(error.what(), "ktx2-encoder: why");
  }
}

}  // namespace
}  // namespace meshhier::images

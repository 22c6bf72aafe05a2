#include "images/tiff_file.h"

#include "support/memory_files.h"
#include "support/tiff_writer.h"
#include "tests/support/error_message.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kMostTiffBytes = 1 << 20;
constexpr std::uint32_t kTiffWidth = 40, kTiffHeight = 6, kRowsAStrip = 3;
constexpr const char* kTiffPath = "/models/a.tif";

std::vector<std::uint16_t> strip(std::uint16_t first) {
  std::vector<std::uint16_t> samples(kTiffWidth * kRowsAStrip);
  for (std::uint16_t& sample : samples)
    sample = first++;
  return samples;
}

/// A file of two strips, with some geo tags.
void write_sample(tests::MemoryFiles& files, tests::TiffWriter::Form form) {
  const auto file = files.create(kTiffPath);
  tests::TiffWriter tiff(*file, form);
  TIFF* handle = tiff.handle();
  TIFFSetField(handle, TIFFTAG_IMAGEWIDTH, kTiffWidth);
  TIFFSetField(handle, TIFFTAG_IMAGELENGTH, kTiffHeight);
  TIFFSetField(handle, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(handle, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(handle, TIFFTAG_ROWSPERSTRIP, kRowsAStrip);
  TIFFSetField(handle, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(handle, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  const std::array scale{0.5, 0.25, 0.0};
  TIFFSetField(handle, static_cast<std::uint32_t>(GeoTag::pixel_scale), 3, scale.data());
  const std::array<std::uint16_t, 4> keys{1, 1, 0, 0};
  TIFFSetField(handle, static_cast<std::uint32_t>(GeoTag::key_directory), 4, keys.data());
  TIFFSetField(handle, static_cast<std::uint32_t>(GeoTag::gdal_nodata), "-9999");
  for (std::uint32_t i = 0; i < 2; ++i) {
    auto samples = strip(static_cast<std::uint16_t>(1000 * i));
    tiff.check(TIFFWriteEncodedStrip(handle, i, samples.data(),
                                     static_cast<tmsize_t>(samples.size() * 2)) >= 0);
  }
  tiff.check(TIFFFlush(handle) == 1);
}

template <class Work>
std::string tiff_message(const Work& work, ErrorCode code = ErrorCode::input) {
  return tests::error_message(code, work);
}

class TiffForms : public testing::TestWithParam<tests::TiffWriter::Form> {};

TEST_P(TiffForms, SANITIZED_WrittenBlocksAndTagsAreReadAgain) {
  tests::MemoryFiles files;
  write_sample(files, GetParam());
  const auto file = files.open(kTiffPath);
  TiffFile tiff(*file, kMostTiffBytes);
  EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_IMAGEWIDTH), kTiffWidth);
  EXPECT_EQ(tiff.number<std::uint32_t>(TIFFTAG_TILEWIDTH), std::nullopt);
  EXPECT_THAT(tiff.doubles(GeoTag::pixel_scale), ElementsAre(0.5, 0.25, 0));
  EXPECT_THAT(tiff.shorts(GeoTag::key_directory), ElementsAre(1, 1, 0, 0));
  EXPECT_EQ(tiff.text(GeoTag::gdal_nodata), "-9999");
  EXPECT_THAT(tiff.doubles(GeoTag::tie_points), IsEmpty());
  EXPECT_THAT(tiff.doubles(GeoTag::key_directory), IsEmpty());  // of another type
  std::vector<std::uint16_t> samples(kTiffWidth * kRowsAStrip);
  tiff.read_block(1, std::as_writable_bytes(std::span(samples)));
  EXPECT_EQ(samples, strip(1000));
}

INSTANTIATE_TEST_SUITE_P(Both, TiffForms,
                         testing::Values(tests::TiffWriter::Form::classic,
                                         tests::TiffWriter::Form::big));

TEST(TiffFile, SANITIZED_TellsWhatIsNone) {
  tests::MemoryFiles files;
  files.put(kTiffPath, "II*");
  const auto file = files.open(kTiffPath);
  EXPECT_THAT(tiff_message([&] { TiffFile(*file, kMostTiffBytes); }),
              HasSubstr("/models/a.tif: libtiff says: "));
}

TEST(TiffFile, SANITIZED_EachCutFileIsToldOfOrReadAsItWas) {
  tests::MemoryFiles files;
  write_sample(files, tests::TiffWriter::Form::classic);
  const std::string whole = files.content(kTiffPath);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    files.put(kTiffPath, whole.substr(0, bytes));
    const auto file = files.open(kTiffPath);
    std::vector<std::uint16_t> samples(kTiffWidth * kRowsAStrip);
    const std::string message = tiff_message([&] {
      TiffFile tiff(*file, kMostTiffBytes);
      tiff.read_block(0, std::as_writable_bytes(std::span(samples)));
    });
    EXPECT_TRUE(!message.empty() || samples == strip(0)) << bytes;
  }
}

TEST(TiffFile, SANITIZED_FlippedBytesDoNoHarm) {
  tests::MemoryFiles files;
  write_sample(files, tests::TiffWriter::Form::big);
  const std::string whole = files.content(kTiffPath);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(~flipped[i]);
    files.put(kTiffPath, flipped);
    const auto file = files.open(kTiffPath);
    std::vector<std::uint16_t> samples(kTiffWidth * kRowsAStrip);
    tiff_message([&] {
      TiffFile tiff(*file, kMostTiffBytes);
      tiff.doubles(GeoTag::pixel_scale);
      tiff.shorts(GeoTag::key_directory);
      tiff.text(GeoTag::gdal_nodata);
      tiff.read_block(1, std::as_writable_bytes(std::span(samples)));
    });
  }
}

}  // namespace
}  // namespace meshhier::images

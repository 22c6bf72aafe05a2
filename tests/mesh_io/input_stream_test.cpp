// Packed and plain files as streams.
#include "mesh_io/input_stream.h"

#include "storage/io/file_checksum.h"
#include "streams.h"
#include "support/gzip.h"

#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::mesh_io::tests {
namespace {

using meshhier::tests::gzip;
using ::testing::HasSubstr;

/// Digits without a short period, `bytes` of them.
std::string content_of(std::size_t bytes) {
  std::string text;
  for (std::uint64_t i = 1; text.size() < bytes;
       i = i * 6364136223846793005U + 1442695040888963407U)
    text += std::to_string(i);
  text.resize(bytes);
  return text;
}

std::string unpacked(const std::string& file, std::size_t step = 1000) {
  return Streamed(file).read_all(step);
}

std::string refusal(const std::string& file) {
  return input_error_of([&] { unpacked(file); });
}

TEST(InputStream, GivesAPlainFileAsItIs) {
  const std::string content = content_of(700'001);  // several blocks
  for (const std::size_t step : {std::size_t{7}, std::size_t{1} << 18, content.size() + 5})
    EXPECT_EQ(unpacked(content, step), content) << step;
  EXPECT_EQ(unpacked(""), "");
}

TEST(InputStream, UnpacksGzipInPiecesOfAnySize) {
  const std::string content = content_of(1'200'001);
  const std::string packed = gzip(content);
  ASSERT_GT(packed.size(), storage::FileChecksum::kBlockBytes) << "more than a block is to be read";
  for (const std::size_t step : {std::size_t{333}, std::size_t{1} << 20, content.size()})
    EXPECT_EQ(unpacked(packed, step), content) << step;
}

TEST(InputStream, UnpacksMembersOneBehindTheOther) {
  EXPECT_EQ(unpacked(gzip("one, ") + gzip("") + gzip("two")), "one, two");
}

TEST(InputStream, TakesZerosBehindGzipForPadding) {
  EXPECT_EQ(unpacked(gzip("one") + std::string(1000, '\0')), "one");
}

TEST(InputStream, RefusesOtherBytesBehindGzip) {
  const std::string packed = gzip("one");
  EXPECT_EQ(refusal(packed + "more"),
            "mesh: byte " + std::to_string(packed.size()) +
                ": expected the end of the file behind the gzip data, found other bytes");
  EXPECT_THAT(refusal(packed + std::string(1, '\0') + gzip("two")), HasSubstr("found other bytes"));
}

TEST(InputStream, RefusesGzipThatIsCutAnywhere) {
  const std::string packed = gzip(content_of(500));
  for (std::size_t size = 2; size < packed.size(); ++size) {
    EXPECT_EQ(refusal(packed.substr(0, size)),
              "mesh: byte " + std::to_string(size) +
                  ": expected more gzip data, found the end of the file (truncated)");
  }
}

TEST(InputStream, RefusesDamagedGzip) {
  const std::string packed = gzip(content_of(500));
  for (std::size_t i = 10; i < packed.size(); ++i) {  // behind the header, of which not all counts
    std::string damaged = packed;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_NE(refusal(damaged), "") << "byte " << i;
  }
}

TEST(InputStream, ReadsAllOfAPackedFileIntoItsChecksum) {
  meshhier::tests::MemoryFiles files;
  files.put("mesh", gzip(content_of(900'000)) + std::string(5000, '\0'));
  const auto file = files.open("mesh");
  storage::FileChecksum checksum(file->size());
  std::uint64_t watched = 0;
  const auto stream =
      open_stream({*file, file->size(), &checksum}, [&](std::uint64_t bytes) { watched += bytes; });
  std::string all(1'000'000, '\0');
  EXPECT_EQ(stream->read(std::as_writable_bytes(std::span(all))), 900'000U);
  EXPECT_EQ(checksum.missing(), 0U);
  EXPECT_EQ(watched, file->size());
}

}  // namespace
}  // namespace meshhier::mesh_io::tests

#include "mesh_io/byte_window.h"

#include "base/error.h"
#include "ply_samples.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace meshhier::mesh_io {
namespace {

/// Byte i of the file is a function of i.
char byte_at(std::uint64_t i) {
  return static_cast<char>((i * 131) ^ (i >> 8));
}

std::string content(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = byte_at(i);
  return bytes;
}

TEST(ByteWindow, HandsOutEveryByteInStepsOfAnySize) {
  constexpr std::size_t kSize = 3 * ByteWindow::kCapacity + 17;
  tests::MemoryFiles files;
  files.put("f", content(kSize));
  const auto file = files.open("f");
  ByteWindow window({*file, kSize});
  std::size_t step = 1;
  while (window.remaining() > step) {
    ASSERT_TRUE(window.ensure(step));
    for (std::size_t i = 0; i < step; i += 1 + step / 100) {
      ASSERT_EQ(static_cast<char>(window.begin()[i]), byte_at(window.offset() + i));
    }
    window.advance(step);
    step = (step * 7 + 3) % 99991;
  }
  EXPECT_FALSE(window.ensure(window.remaining() + 1));
  EXPECT_EQ(window.available(), window.remaining());
}

TEST(ByteWindow, SeeksWithinAndBeyondTheBuffer) {
  constexpr std::size_t kSize = 4 * ByteWindow::kCapacity;
  tests::MemoryFiles files;
  files.put("f", content(kSize));
  const auto file = files.open("f");
  ByteWindow window({*file, kSize});
  for (const std::uint64_t offset : {std::uint64_t{5}, std::uint64_t{kSize - 1}, std::uint64_t{0},
                                     std::uint64_t{ByteWindow::kCapacity}, std::uint64_t{700}}) {
    window.seek(offset);
    EXPECT_EQ(window.offset(), offset);
    EXPECT_EQ(window.remaining(), kSize - offset);
    ASSERT_TRUE(window.ensure(1));
    EXPECT_EQ(static_cast<char>(*window.begin()), byte_at(offset));
  }
  window.skip(3 * ByteWindow::kCapacity);
  ASSERT_TRUE(window.ensure(1));
  EXPECT_EQ(static_cast<char>(*window.begin()), byte_at(700 + 3 * ByteWindow::kCapacity));
}

TEST(ByteWindow, ReadingForwardsGathersTheChecksum) {
  constexpr std::size_t kSize = 5 * ByteWindow::kCapacity + 17;
  tests::MemoryFiles files;
  files.put("f", content(kSize));
  const auto file = files.open("f");
  for (const std::uint64_t start : {0U, 1000U}) {
    storage::FileChecksum checksum(kSize);
    ByteWindow window({*file, kSize, &checksum});
    window.seek(start);
    while (window.remaining() > 0) {
      ASSERT_TRUE(window.ensure(std::min<std::uint64_t>(4099, window.remaining())));
      window.advance(window.available() - window.available() / 3);
    }
    EXPECT_EQ(checksum.missing(), start == 0 ? 0U : 1U);
  }
}

TEST(ByteWindow, NothingIsReadBeyondTheSizeGiven) {
  tests::MemoryFiles files;
  files.put("f", content(100));
  const auto file = files.open("f");
  ByteWindow window({*file, 60});
  EXPECT_FALSE(window.ensure(61));
  EXPECT_EQ(window.available(), 60U);
}

TEST(ByteWindow, AFileThatShrinksMeanwhileIsAnIoError) {
  tests::MemoryFiles files;
  files.put("f", content(100));
  const auto file = files.open("f");
  ByteWindow window({*file, 200});
  try {
    window.ensure(150);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
  }
}

}  // namespace
}  // namespace meshhier::mesh_io

// The pictures of the textured models, made by many programs.
#include "images/image_codec.h"
#include "tests/images/samples.h"
#include "tests/support/share.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::images {
namespace {

namespace fs = std::filesystem;

Bytes bytes_of_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

bool is_picture(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png" || extension == ".webp";
}

TEST(RealPicturesTest, AllAreRead) {
  const fs::path folder = fs::path(MESHHIER_MODELS_DIR) / "textured";
  if (!fs::exists(folder))
    GTEST_SKIP() << "no textured models at " << folder;
  std::size_t pictures = 0, read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!is_picture(entry.path()) || !tests::share().has(pictures++))
      continue;
    const Bytes bytes = bytes_of_file(entry.path());
    EXPECT_NO_THROW(decode_image(bytes, entry.path().string(), std::uint64_t{1} << 28));
    ++read;
  }
  EXPECT_EQ(read, tests::share().part_of(pictures));
}

}  // namespace
}  // namespace meshhier::images

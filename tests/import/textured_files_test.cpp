// Files that other programs have made, where they are: each is imported or refused with a reason,
// and what becomes of it is told for people to look at.
#include "base/error.h"
#include "import/imported.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> meshes_below(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".obj" || extension == ".ply"))
      found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

std::string facts_of(const tests::Imported& mesh) {
  const SourceTextures textures = mesh.summary.textures.value_or(SourceTextures{});
  return fmt::format("{} triangles, {}: {} materials, {} pictures, {} missing {}",
                     mesh.triangles.size(), mesh.layout.material ? "textured" : "not textured",
                     textures.materials, textures.images, mesh.count("missing_images"),
                     fmt::join(mesh.warnings, "; "));
}

/// Checks the mesh's facts about itself.
void check(const tests::Imported& mesh) {
  EXPECT_EQ(mesh.layout.material, !mesh.materials.empty());
  EXPECT_EQ(mesh.layout.material, mesh.summary.textures.has_value());
  const std::uint64_t undefined = mesh.count("undefined_materials");
  EXPECT_EQ(mesh.warnings.size(),
            (mesh.count("missing_images") > 0 ? 1U : 0U) + (undefined > 0 ? 1U : 0U));
  if (!mesh.layout.material)
    return;
  std::vector<bool> is_used(mesh.materials.materials.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    is_used.at(mesh.material_of(t)) = true;
  EXPECT_EQ(std::ranges::count(is_used, false), 0);
  for (const images::ImageSource& image : mesh.materials.images)
    EXPECT_TRUE(fs::is_regular_file(image.file)) << image.file;
}

class TexturedFilesTest : public testing::TestWithParam<std::string> {
 protected:
  TexturedFilesTest() { fs::create_directories(folder_); }
  ~TexturedFilesTest() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::temp_directory_path() / fmt::format("textured-files-{}", getpid());
};

TEST_P(TexturedFilesTest, IsImportedOrRefusedWithAReason) {
  const fs::path folder = GetParam();
  if (!fs::is_directory(folder))
    GTEST_SKIP() << folder << " is not there";
  const auto files = storage::make_posix_file_system();
  for (const fs::path& path : meshes_below(folder)) {
    SCOPED_TRACE(path);
    std::string facts;
    try {
      const tests::Imported mesh = tests::import_files(*files, path, {.folder = folder_});
      check(mesh);
      facts = facts_of(mesh);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      facts = std::string("refused: ") + error.what();
    }
    std::cout << path.lexically_relative(folder).string() << " | " << facts << '\n';
  }
}

TEST(LargeTexturedFilesTest, TemporaryDiskIsPredicted) {
  const fs::path models = fs::path(MESHHIER_MODELS_DIR) / "textured";
  const auto files = storage::make_posix_file_system();
  // Memory for sorts that is less than what they sort, and enough for one merge.
  const std::pair<const char*, std::uint64_t> cases[] = {{"rooms/rooms.ply", 2 << 20},
                                                         {"door_rabbit/door_rabbit.obj", 1 << 20}};
  for (const auto& [name, sort_bytes] : cases) {
    if (!fs::exists(models / name))
      GTEST_SKIP() << models / name << " is not there";
    const tests::Imported mesh = tests::import_files(
        *files, models / name, {.memory = {0, sort_bytes}, .folder = fs::temp_directory_path()});
    EXPECT_TRUE(mesh.layout.material);
    EXPECT_LE(mesh.disk_bytes, mesh.predicted_bytes) << name;
    EXPECT_GT(mesh.disk_bytes, mesh.predicted_bytes / 4) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, TexturedFilesTest,
                         testing::Values(MESHHIER_MODELS_DIR "/textured",
                                         "/usr/share/assimp/models"));

}  // namespace
}  // namespace meshhier::importing

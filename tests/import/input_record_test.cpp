#include "import/input_record.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

struct Files {
  std::vector<ReadFile> files;
  std::vector<std::string> formats;
};

/// `meshes` OBJ files and two pictures.
Files some_files(std::size_t meshes) {
  Files made;
  for (std::size_t i = 0; i < meshes + 2; ++i) {
    ReadFile file;
    file.path = "folder/f" + std::to_string(i);
    file.part = i < meshes ? InputPart::mesh : InputPart::picture;
    file.identity.bytes = 100 + i;
    file.checksum = 7 * i;
    made.files.push_back(file);
  }
  made.formats.assign(meshes, "OBJ");
  return made;
}

std::uint64_t bytes_of(const std::vector<SourceFile>& files) {
  std::uint64_t bytes = 0;
  for (const SourceFile& file : files)
    bytes += file.bytes;
  return bytes;
}

TEST(SourceFilesTest, ListEachMeshWhereThereAreFew) {
  for (const std::size_t meshes : {std::size_t{1}, std::size_t{2}, kMostListedMeshes}) {
    const Files read = some_files(meshes);
    const std::vector<SourceFile> files = source_files(read.files, read.formats);
    ASSERT_EQ(files.size(), meshes + 1);
    for (std::size_t i = 0; i < meshes; ++i) {
      EXPECT_EQ(files[i].name, "f" + std::to_string(i));
      EXPECT_EQ(files[i].format, "OBJ");
      EXPECT_EQ(files[i].bytes, 100 + i);
      EXPECT_EQ(files[i].checksum, 7 * i);
    }
    EXPECT_EQ(files.back().name, "f" + std::to_string(meshes) + " and 1 more");
    EXPECT_EQ(files.back().format, "picture");
  }
}

TEST(SourceFilesTest, ListTheFirstMeshesAndAllOthersTogether) {
  for (const std::size_t meshes :
       {kMostListedMeshes + 1, std::size_t{1000}, std::size_t{100'000}}) {
    const Files read = some_files(meshes);
    const std::vector<SourceFile> files = source_files(read.files, read.formats);
    ASSERT_EQ(files.size(), kMostListedMeshes + 1);
    const SourceFile& others = files[kMostListedMeshes - 1];
    EXPECT_EQ(others.name, "f49 and " + std::to_string(meshes - kMostListedMeshes) + " more");
    EXPECT_EQ(others.format, "mesh");
    std::vector<std::uint64_t> checksums;
    for (std::size_t i = kMostListedMeshes - 1; i < meshes; ++i)
      checksums.push_back(7 * i);
    EXPECT_EQ(others.checksum, joined_checksum(checksums));
    EXPECT_EQ(files.back().format, "picture");
    std::uint64_t bytes = 0;
    for (const ReadFile& file : read.files)
      bytes += file.identity.bytes;
    EXPECT_EQ(bytes_of(files), bytes);
  }
}

}  // namespace
}  // namespace meshhier::importing

#include "import/join_layouts.h"

#include "storage/io/file.h"
#include "tests/support/sample_hierarchy.h"

#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::importing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class JoinLayoutsTest : public ::testing::Test {
 protected:
  /// A file of one vertex.
  void add(const AttributeLayout& layout, const std::vector<float>& row, bool is_painted = false) {
    ASSERT_EQ(row.size(), static_cast<std::size_t>(layout.channels()));
    files_.push_back({layout, 1, is_painted});
    mesh_.attributes.append(row);
  }

  std::vector<float> join() {
    counts_ = join_layouts(files_, mesh_, {scratch_, 1 << 20, cancel_});
    std::vector<float> all(mesh_.attributes.size());
    mesh_.attributes.read(0, all);
    return all;
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> system_ = storage::make_posix_file_system();
  storage::MemoryPool pool_{0};
  storage::ScratchFile scratch_{*system_, directory_.path() / "scratch", pool_};
  execution::CancelToken cancel_;
  RawMesh mesh_{scratch_};
  std::vector<JoinedFile> files_;
  JoinCounts counts_;
};

constexpr AttributeLayout kNormals{.normals = true};
constexpr AttributeLayout kBytes{.colour = ColourType::u8};
constexpr AttributeLayout kShorts{.colour = ColourType::u16, .alpha = true};
constexpr AttributeLayout kFloats{.colour = ColourType::f32};
constexpr AttributeLayout kCoordinates{.texcoords = true};
constexpr AttributeLayout kPictures{.texcoords = true, .material = true};

TEST_F(JoinLayoutsTest, EqualLayoutsStay) {
  add(kNormals, {1, 0, 0});
  add(kNormals, {0, 1, 0});
  EXPECT_THAT(join(), ElementsAre(1, 0, 0, 0, 1, 0));
  EXPECT_EQ(mesh_.layout, kNormals);
  EXPECT_EQ(counts_.dropped_of(AttributeKind::normals), 0U);
}

TEST_F(JoinLayoutsTest, NormalsOfSomeAreDropped) {
  add(kNormals, {1, 0, 0});
  add({}, {});
  EXPECT_THAT(join(), IsEmpty());
  EXPECT_EQ(mesh_.layout, AttributeLayout{});
  EXPECT_EQ(counts_.dropped_of(AttributeKind::normals), 1U);
}

TEST_F(JoinLayoutsTest, NormalsOfAllStayBesideOtherDifferences) {
  add({.normals = true, .colour = ColourType::u8}, {1, 0, 0, 7, 8, 9});
  add(kNormals, {0, 1, 0});
  EXPECT_THAT(join(), ElementsAre(1, 0, 0, 7, 8, 9, 0, 1, 0, 255, 255, 255));
  EXPECT_EQ(counts_.white_vertices, 1U);
  EXPECT_EQ(counts_.dropped_of(AttributeKind::normals), 0U);
}

TEST_F(JoinLayoutsTest, ColoursBecomeThoseOfTheWidestType) {
  add(kBytes, {0, 1, 255});
  add(kShorts, {0, 300, 65535, 9});
  EXPECT_THAT(join(), ElementsAre(0, 257, 65535, 65535, 0, 300, 65535, 9));
  EXPECT_EQ(counts_.converted_colours, 1U);
  EXPECT_EQ(counts_.white_vertices, 0U);
}

TEST_F(JoinLayoutsTest, FloatsAreTheWidest) {
  add(kFloats, {0.25F, 0.5F, 1});
  add(kShorts, {0, 65535, 0, 65535});
  add({}, {});
  EXPECT_THAT(join(), ElementsAre(0.25F, 0.5F, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1));
  EXPECT_EQ(counts_.converted_colours, 1U);
  EXPECT_EQ(counts_.white_vertices, 1U);
}

TEST_F(JoinLayoutsTest, CoordinatesWithoutPicturesAreDroppedIfOnlySomeHaveThem) {
  add(kCoordinates, {0.5F, 0.25F});
  add({}, {});
  EXPECT_THAT(join(), IsEmpty());
  EXPECT_EQ(counts_.dropped_of(AttributeKind::texcoords), 1U);
  EXPECT_EQ(counts_.untextured_files, 0U);
}

TEST_F(JoinLayoutsTest, BesidePicturesMaterialsHaveTheColour) {
  images::Material material;
  mesh_.materials.add(std::move(material));
  add(kPictures, {0.5F, 0.25F, 0});
  add(kBytes, {255, 0, 0}, true);
  add(kCoordinates, {0.125F, 0.125F});
  EXPECT_THAT(join(), ElementsAre(0.5F, 0.25F, 0, 0, 0, 1, 0, 0, 2));
  EXPECT_EQ(mesh_.layout, kPictures);
  EXPECT_EQ(counts_.untextured_files, 2U);
  EXPECT_EQ(counts_.dropped_of(AttributeKind::texcoords), 1U);
  EXPECT_EQ(counts_.white_vertices, 0U);
}

TEST_F(JoinLayoutsTest, ColoursOfVerticesStayBesidePictures) {
  mesh_.materials.add({});
  add(kPictures, {0.5F, 0.25F, 0});
  add(kBytes, {10, 20, 30});
  EXPECT_THAT(join(), ElementsAre(255, 255, 255, 0.5F, 0.25F, 0, 10, 20, 30, 0, 0, 1));
  EXPECT_EQ(counts_.white_vertices, 0U) << "white leaves the picture as it is";
  EXPECT_EQ(counts_.hidden_colours, 0U);
  EXPECT_TRUE(mesh_.layout.tints);
}

// A file's colours that say what its picture says would darken it.
TEST_F(JoinLayoutsTest, ColoursDoNotTintIfAFileHasThemBesideItsPictures) {
  mesh_.materials.add({});
  AttributeLayout both = kPictures;
  both.colour = ColourType::u8;
  add(both, {1, 2, 3, 0.5F, 0.25F, 0});
  add(kBytes, {10, 20, 30});
  AttributeLayout tinting = both;
  tinting.tints = true;
  add(tinting, {4, 5, 6, 0.5F, 0.25F, 0});
  EXPECT_THAT(join(),
              ElementsAre(1, 2, 3, 0.5F, 0.25F, 0, 10, 20, 30, 0, 0, 1, 4, 5, 6, 0.5F, 0.25F, 0));
  EXPECT_FALSE(mesh_.layout.tints);
  EXPECT_EQ(counts_.hidden_colours, 2U);
}

}  // namespace
}  // namespace meshhier::importing

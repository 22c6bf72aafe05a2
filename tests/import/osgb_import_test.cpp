// OSGB tiles as programs of photogrammetry write them. OpenSceneGraph makes them, where it is
// there.
#include "base/error.h"
#include "config/input_frame.h"
#include "images/image_codec.h"
#include "import/imported.h"
#include "import/open_picture.h"
#include "mesh_io/osgb_file.h"
#include "mesh_io/osgb_tiles.h"
#include "storage/io/file.h"
#include "tests/support/error_message.h"
#include "tests/support/gzip.h"
#include "tests/support/share.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace meshhier::importing {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using tests::Imported;

constexpr std::uint32_t kSide = 20;    ///< squares of the sheet along a side
constexpr std::uint32_t kTexels = 64;  ///< of its picture
constexpr const char* kTile = "Tile_+000_+000";

images::Image picture() {
  images::Image image(kTexels, kTexels, 3);
  for (std::uint32_t y = 0; y < kTexels; ++y) {
    for (std::uint32_t x = 0; x < kTexels; ++x)
      std::copy_n(std::array{static_cast<std::uint8_t>(3 * x), static_cast<std::uint8_t>(3 * y),
                             static_cast<std::uint8_t>(x / 8 % 2 * 200)}
                      .data(),
                  3, image.at(x, y));
  }
  return image;
}

void write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string as_text(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A bumpy sheet with a picture, in a folder of tiles.
class Osgb : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(maker()))
      GTEST_SKIP() << "OpenSceneGraph is not there";
    std::string name = (fs::temp_directory_path() / "meshhier-osgb-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    jpeg_ = as_text(images::encode_image(picture(), ImageFormat::jpeg, 95));
    write(folder_ / "sheet.jpg", jpeg_);
    write(folder_ / "sheet.mtl", "newmtl m\nKd 1 1 1\nmap_Kd sheet.jpg\n");
    write(folder_ / "sheet.obj", sheet());
  }
  void TearDown() override {
    if (!folder_.empty())
      fs::remove_all(folder_);
  }

  static fs::path maker() {
    return fs::path(MESHHIER_BINARY).parent_path() / "meshhier_osgb_maker";
  }
  static double height(std::uint32_t x, std::uint32_t y) { return (x * 7 + y * 13) % 5 * 0.25; }
  static std::string sheet() {
    std::string text = "mtllib sheet.mtl\nusemtl m\n";
    for (std::uint32_t y = 0; y <= kSide; ++y) {
      for (std::uint32_t x = 0; x <= kSide; ++x)
        text += fmt::format("v {} {} {}\nvt {} {}\n", x, y, height(x, y),
                            static_cast<double>(x) / kSide, static_cast<double>(y) / kSide);
    }
    for (std::uint32_t y = 0; y < kSide; ++y) {
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t a = y * (kSide + 1) + x + 1, b = a + 1, c = a + kSide + 1, d = c + 1;
        text += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\nf {1}/{1} {3}/{3} {2}/{2}\n", a, b, c, d);
      }
    }
    return text;
  }

  /// Makes site/ of the sheet.
  void make(const std::string& options = "") const {
    const std::string command = fmt::format("cd '{}' && '{}' sheet.obj -o site {} >log 2>&1",
                                            folder_.string(), maker().string(), options);
    ASSERT_EQ(std::system(command.c_str()), 0) << bytes_of(folder_ / "log");
  }
  fs::path tile(const std::string& ending = "") const {
    return folder_ / "site/Data" / kTile / (kTile + ending + ".osgb");
  }
  Imported import(const fs::path& path) const {
    return tests::import_files(*files_, path, {.folder = folder_});
  }
  std::string failure(const fs::path& path) const {
    return tests::error_message(ErrorCode::input, [&] { import(path); });
  }
  /// Replaces text of a file by other text of the same length.
  static void replace(const fs::path& path, const std::string& from, const std::string& to) {
    std::string bytes = bytes_of(path);
    const std::size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    ASSERT_EQ(from.size(), to.size());
    write(path, bytes.replace(at, from.size(), to));
  }

  fs::path folder_;
  std::string jpeg_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

double area_of(const Imported& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d& p = mesh.positions[a];
    area += length(cross(mesh.positions[b] - p, mesh.positions[c] - p)) / 2;
  }
  return area;
}

/// Checks that a picture shows each corner what the sheet's does; `most`: the largest difference.
void expect_picture(const Imported& mesh, storage::FileSystem& files, int most) {
  for (std::size_t i = 0; i < mesh.materials.images.size(); ++i) {
    const auto reader = open_picture(mesh.materials.images[i], files);
    ASSERT_EQ(reader->info().width, kTexels);
    ASSERT_EQ(reader->info().height, kTexels);
    std::vector<std::uint8_t> rows(std::size_t{kTexels} * kTexels * reader->info().channels);
    reader->read_rows(rows.data(), kTexels);
    const images::Image sheet = picture();
    for (std::uint32_t y = 0; y < kTexels; y += 3) {
      for (std::uint32_t x = 0; x < kTexels; x += 3) {
        const std::uint8_t* texel = &rows[(y * kTexels + x) * reader->info().channels];
        for (int k = 0; k < 2; ++k)
          ASSERT_NEAR(texel[k], sheet.at(x, y)[k], most) << x << ' ' << y;
      }
    }
  }
}

/// Checks that each corner shows the place of the picture that lies under it.
void expect_texcoords(const Imported& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.positions[mesh.triangles[t][k]];
      const Vec2f texcoord = mesh.texcoord(t, k);
      ASSERT_NEAR(texcoord.u, p.x / kSide, 1e-6);
      ASSERT_NEAR(texcoord.v, 1 - p.y / kSide, 1e-6);
    }
  }
}

TEST_F(Osgb, FinestTilesAreTheMesh) {
  make("--tiles 2 --levels 2");
  const Imported sheet = import(folder_ / "sheet.obj");
  for (const char* place : {"site", "site/Data", "site/metadata.xml"}) {
    const Imported mesh = import(folder_ / place);
    EXPECT_THAT(mesh.triangles, SizeIs(2 * kSide * kSide)) << place;
    EXPECT_NEAR(area_of(mesh), area_of(sheet), 1e-9);
    EXPECT_TRUE(mesh.layout.material && mesh.layout.normals) << "normals are of the OBJ's reader";
    EXPECT_THAT(mesh.warnings, IsEmpty());
    expect_texcoords(mesh);
    EXPECT_THAT(mesh.companions(), SizeIs(4 * 20)) << "4 files of level 1 a tile, 16 of level 2";
  }
}

TEST_F(Osgb, RangesMayBeDistances) {
  make("--levels 2 --distance");
  EXPECT_THAT(import(tile()).triangles, SizeIs(2 * kSide * kSide));
}

TEST_F(Osgb, PicturesThatAreFilesStayInTheFile) {
  make();
  const Imported mesh = import(tile());
  ASSERT_THAT(mesh.materials.images, SizeIs(4));
  for (const images::ImageSource& image : mesh.materials.images) {
    EXPECT_FALSE(image.is_packed);
    EXPECT_EQ(bytes_of(image.file).substr(image.offset, image.bytes), jpeg_);
  }
  expect_picture(mesh, *files_, 8);
}

TEST_F(Osgb, PicturesInMemoryAndPackedFilesAreRead) {
  for (const char* options : {"--pictures data", "--pictures dxt", "--compressor zlib",
                              "--pictures data --compressor zlib"}) {
    fs::remove_all(folder_ / "site");
    make(options);
    const Imported mesh = import(tile());
    EXPECT_THAT(mesh.triangles, SizeIs(2 * kSide * kSide)) << options;
    ASSERT_THAT(mesh.materials.images, SizeIs(4)) << options;
    for (const images::ImageSource& image : mesh.materials.images) {
      EXPECT_TRUE(image.is_packed) << options;
      if (std::string(options).find("pictures") != std::string::npos) {
        EXPECT_LT(image.bytes, 64U) << "its start: it is decoded when its rows are read";
      }
    }
    expect_texcoords(mesh);
    expect_picture(mesh, *files_, std::string(options).find("dxt") == std::string::npos ? 8 : 40);
  }
}

TEST_F(Osgb, PicturesElsewhereAreFound) {
  make("--pictures external");
  fs::copy(folder_ / "sheet.jpg", tile().parent_path() / "sheet.jpg");
  const Imported mesh = import(tile());
  ASSERT_THAT(mesh.materials.images, SizeIs(1));
  EXPECT_EQ(mesh.materials.images[0].file, tile().parent_path() / "sheet.jpg");
  fs::remove(tile().parent_path() / "sheet.jpg");
  const Imported without = import(tile());
  EXPECT_EQ(without.count("missing_images"), 4U) << "one a file";
  EXPECT_THAT(without.warnings, ElementsAre(HasSubstr("picture")));
}

TEST_F(Osgb, WhereAFinerFileIsMissingTheCoarserPartStands) {
  make("--levels 2");
  const std::size_t whole = import(tile()).triangles.size();
  fs::remove(tile("_L2_5"));
  const Imported mesh = import(tile());
  EXPECT_LT(mesh.triangles.size(), whole);
  EXPECT_GT(mesh.triangles.size(), whole - 2 * kSide * kSide / 16);
  EXPECT_EQ(mesh.count("missing_tiles"), 1U);
  EXPECT_THAT(mesh.warnings,
              ElementsAre(HasSubstr("1 file that tiles name is not there (the first is "
                                    "Tile_+000_+000_L2_5.osgb in ")));
  EXPECT_THAT(mesh.companions(), testing::Contains("no " + tile("_L2_5").string()));
  fs::remove(tile("_L1_0"));
  EXPECT_EQ(import(tile()).count("unnamed_tiles"), 4U) << "those that it named";
}

TEST_F(Osgb, FoldersAreFoundAsProgramsLeaveThem) {
  make("--tiles 2");
  const auto expect_whole = [&](const fs::path& place) {
    const Imported mesh = import(folder_ / place);
    EXPECT_THAT(mesh.triangles, SizeIs(2 * kSide * kSide)) << place;
    EXPECT_EQ(mesh.count("unnamed_tiles"), 0U) << place;
  };
  fs::create_directories(folder_ / "p/Productions");
  fs::rename(folder_ / "site", folder_ / "p/Productions/Production_1");
  expect_whole("p");
  fs::create_directories(folder_ / "t");
  fs::rename(folder_ / "p/Productions/Production_1/Data", folder_ / "t/terra_osgbs");
  expect_whole("t");
  expect_whole("t/terra_osgbs");
  fs::remove(folder_ / "t/terra_osgbs" / kTile / (std::string(kTile) + ".osgb"));
  expect_whole("t");
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "t/terra_osgbs")) {
    if (entry.is_regular_file())
      fs::copy(entry.path(), folder_ / "p" / entry.path().filename());
  }
  expect_whole("p");
  fs::rename(folder_ / "t/terra_osgbs", folder_ / "p/two");
  fs::create_directories(folder_ / "p/one/b");
  fs::copy(folder_ / "p/Tile_+001_+001.osgb", folder_ / "p/one/b/b.osgb");
  for (const auto& entry : fs::directory_iterator(folder_ / "p")) {
    if (entry.is_regular_file())
      fs::remove(entry.path());
  }
  EXPECT_THROW(import(folder_ / "p"), Error) << "in p/one and in p/two";
}

TEST_F(Osgb, TheOrderDoesNotDependOnThreads) {
  make("--tiles 2 --levels 2");
  const auto import_by = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return import(folder_ / "site");
  };
  const Imported one = import_by(1), many = import_by(5);
  EXPECT_EQ(one.positions, many.positions);
  EXPECT_EQ(one.triangles, many.triangles);
  EXPECT_EQ(one.materials, many.materials);
  EXPECT_EQ(one.companions(), many.companions());
}

TEST_F(Osgb, TheFirstFailureInTheOrderOfTheTreeIsTold) {
  make("--levels 2");
  for (const char* ending : {"_L1_2", "_L2_3"})  // the one of L1_0, which is read before L1_2
    write(tile(ending), "nothing");
  EXPECT_THAT(failure(tile()), HasSubstr("_L2_3.osgb"));
}

TEST_F(Osgb, FilesInACircleAreRefused) {
  make();
  fs::remove(tile("_L1_0"));
  fs::copy(tile(), tile("_L1_0"));
  EXPECT_THAT(failure(tile()), HasSubstr("files are in a circle"));
}

TEST_F(Osgb, NamesDoNotLeaveTheFolder) {
  make();
  const std::string name = std::string(kTile) + "_L1_0.osgb";
  fs::rename(tile("_L1_0"), folder_ / "site/out.osgb");
  const std::string outside = "../.././././././out.osgb";
  replace(tile(), name, outside);
  const Imported mesh = import(tile());
  EXPECT_EQ(mesh.count("missing_tiles"), 1U);
  EXPECT_THAT(mesh.companions(), Each(testing::Not(HasSubstr("site/out"))));
}

TEST_F(Osgb, ATruncatedFileIsNamed) {
  make("--compressor zlib");
  const std::string whole = bytes_of(tile("_L1_1"));
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, std::size_t{30}, whole.size() / 2}) {
    write(tile("_L1_1"), whole.substr(0, length));
    EXPECT_THAT(failure(tile()), HasSubstr("_L1_1.osgb")) << length;
  }
}

TEST_F(Osgb, BillionsOfVerticesAreRefused) {
  make();
  const fs::path finer = tile("_L1_0");
  std::string bytes = bytes_of(finer);
  std::size_t claims = 0;
  // Counts of arrays: there are 10 x 10 vertices and some in a quarter.
  for (std::size_t i = 0; i + 4 < bytes.size(); ++i) {
    if (static_cast<unsigned char>(bytes[i]) == 121 && bytes[i + 1] == 0 && bytes[i + 2] == 0 &&
        bytes[i + 3] == 0) {
      std::string more = bytes;
      more.replace(i, 4, "\xFF\xFF\xFF\x7F");
      write(finer, more);
      claims += failure(tile()).find("_L1_0.osgb") != std::string::npos ? 1 : 0;
    }
  }
  EXPECT_GT(claims, 0U);
}

TEST_F(Osgb, DamageIsToldOrDoesNotMatter) {
  make();
  const fs::path finer = tile("_L1_0");
  const std::string bytes = bytes_of(finer);
  const auto is_told = [&](std::size_t at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(~damaged[at]);
    write(finer, damaged);
    return !failure(tile()).empty();
  };
  EXPECT_TRUE(is_told(0)) << "the mark of the format";
  std::size_t told = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    // Texels say nothing of the format.
    if (tests::share().has(i / 7) && i % 7 == 0 && (i <= 700 || i % 91 == 0))
      told += is_told(i) ? 1 : 0;
  }
  // A small share may hold bytes alone that mean nothing.
  EXPECT_TRUE(told > 10 || tests::share().count > 1) << told;
}

TEST_F(Osgb, PlugInsAreNotLoaded) {
  make();
  replace(tile("_L1_0"), "osg::Geode", "osgSim::Ge");
  const std::size_t whole = import(folder_ / "sheet.obj").triangles.size();
  const Imported mesh = import(tile());
  EXPECT_EQ(mesh.count("unknown_parts"), 1U);
  EXPECT_LT(mesh.triangles.size(), whole);
  EXPECT_THAT(mesh.warnings, ElementsAre(HasSubstr("1 part of kinds that OpenSceneGraph")));
}

TEST_F(Osgb, APackedTileIsRead) {
  make("--levels 0");
  write(folder_ / "a.osgb.gz", tests::gzip(bytes_of(tile())));
  const Imported mesh = import(folder_ / "a.osgb.gz");
  EXPECT_THAT(mesh.triangles, SizeIs(2 * kSide * kSide));
  expect_picture(mesh, *files_, 8);
}

TEST_F(Osgb, MetadataPlacesTiles) {
  make("--srs EPSG:32632 --origin 512345,5401234,100");
  config::Config config;
  for (const fs::path& path : {folder_ / "site", folder_ / "site/metadata.xml", tile()}) {
    config.input = path;
    const config::Config placed = config::with_input_frame(*files_, config);
    EXPECT_EQ(placed.up, UpAxis::z) << path;
    EXPECT_EQ(placed.placement.crs, "EPSG:32632") << path;
    EXPECT_EQ(placed.placement.offset, (std::array<double, 3>{512345, 5401234, 100})) << path;
  }
}

TEST_F(Osgb, MetadataMaySayThatThereIsNoMap) {
  make();
  config::Config config;
  config.input = folder_ / "site";
  for (const char* srs : {"<SRS>LOCAL</SRS>", "<SRS></SRS>", ""}) {
    write(folder_ / "site/metadata.xml",
          fmt::format("<?xml version=\"1.0\"?>\n<ModelMetadata version=\"1\">{}"
                      "<SRSOrigin>1,2,3</SRSOrigin></ModelMetadata>",
                      srs));
    const config::Config placed = config::with_input_frame(*files_, config);
    EXPECT_EQ(placed.placement.unplaced_by, folder_ / "site/metadata.xml");
    EXPECT_FALSE(placed.placement.offset || placed.placement.crs);
  }
  write(folder_ / "site/metadata.xml",
        "<ModelMetadata><SRS>ENU:48.1,11.6,520</SRS><SRSOrigin>0,0,0</SRSOrigin></ModelMetadata>");
  const config::Config placed = config::with_input_frame(*files_, config);
  EXPECT_EQ(placed.placement.latitude, 48.1);
  EXPECT_EQ(placed.placement.longitude, 11.6);
  EXPECT_EQ(placed.placement.height, 520);
}

TEST(OsgbFile, WithoutTheProgramOneLineSaysWhatToInstall) {
  ::setenv("MESHHIER_OSGB", "/nowhere", 1);
  EXPECT_THAT(mesh_io::missing_for_osgb(), testing::AllOf(HasSubstr("which is not in /nowhere"),
                                                          HasSubstr("libopenscenegraph-dev")));
  ::unsetenv("MESHHIER_OSGB");
}

}  // namespace
}  // namespace meshhier::importing

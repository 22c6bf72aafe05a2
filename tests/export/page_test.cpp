#include "base/error.h"
#include "export/base64.h"
#include "export/page_file.h"
#include "export/page_story.h"
#include "hierarchy/lattice.h"
#include "storage/format/hierarchy_reader.h"
#include "storage/format/layout.h"
#include "tests/support/gzip.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::exporting {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string kViewer =
    "<title>meshhier</title>\n<!-- meshhier: hierarchy -->\n<script></script>";
const std::string kPicture = "\x89PNG\r\n\x1a\nrest of it";

std::span<const std::byte> page_bytes(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string decoded(const std::string& text) {
  const std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 255);
    }
  }
  return bytes;
}

class PageTest : public testing::Test {
 protected:
  PageTest() {
    tests::Sample sample = tests::make_sample(
        tests::sphere(8000, 0.01F), {.partitions = 16, .tile_vertices = 120, .colours = true});
    tests::write_sample(*files_, hierarchy(), sample);
  }

  fs::path hierarchy() const { return directory_.path() / "a.hier"; }
  fs::path page() const { return directory_.path() / "a.html"; }
  fs::path unpacked() const { return directory_.path() / "b.hier"; }

  std::string text_of(const fs::path& path) {
    const auto bytes = storage::read_file(*files_, path, 1 << 30);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  /// Returns the account.
  std::string write(std::uint64_t size, const std::string& link = "") {
    execution::NoProgress progress;
    return write_page(*files_, hierarchy(), kViewer,
                      {.output = page(), .replace = true, .size = size, .link = link, .name = "a"},
                      progress, execution::CancelToken());
  }

  nlohmann::json embedded() {
    const std::string text = text_of(page());
    const std::size_t begin = text.find('{');
    return nlohmann::json::parse(text.substr(begin, text.find("\n</script>", begin) - begin));
  }

  /// Writes the files in a page as those of a hierarchy; returns the tiles.
  std::vector<NodeId> unpack() {
    files_->remove_all(unpacked());
    std::vector<NodeId> tiles;
    const nlohmann::json all = embedded();
    for (const auto& [name, content] : all["files"].items()) {
      std::string bytes = decoded(content.get<std::string>());
      if (bytes.starts_with("\x1f\x8b"))
        bytes = tests::gunzip(bytes);
      files_->make_directories((unpacked() / name).parent_path());
      storage::write_file(*files_, unpacked() / name, page_bytes(bytes));
      if (const auto tile = storage::tile_of(name))
        tiles.push_back(*tile);
    }
    return tiles;
  }

  Error error_of(std::uint64_t size) {
    try {
      write(size);
    } catch (const Error& error) {
      return error;
    }
    return {ErrorCode::internal, "no error"};
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
};

TEST_F(PageTest, WhereAllFitsTilesArePackedAndNothingIsLost) {
  const std::string account = write(100'000'000);
  EXPECT_THAT(account, HasSubstr("all of the mesh"));
  EXPECT_THAT(account, Not(HasSubstr("did not fit")));
  const storage::HierarchyReader original(*files_, hierarchy());
  ASSERT_EQ(unpack().size(), original.records().size());
  const storage::HierarchyReader reader(*files_, unpacked());
  EXPECT_EQ(reader.manifest().compression, storage::Compression::meshopt);
  EXPECT_FALSE(reader.manifest().quantization);
  for (const TileRecord& record : original.records()) {
    const PublishedTile before = original.read_tile(record.node);
    const PublishedTile after = reader.read_tile(record.node);
    EXPECT_EQ(after.mesh.vertices.positions, before.mesh.vertices.positions);
    EXPECT_EQ(after.mesh.vertices.attributes, before.mesh.vertices.attributes);
    EXPECT_TRUE(after.mesh.interior == before.mesh.interior);
    EXPECT_TRUE(after.mesh.border == before.mesh.border);
    EXPECT_EQ(after.parent_map, before.parent_map);
    EXPECT_TRUE(after.chains == before.chains);
    EXPECT_EQ(reader.record(record.node).error, record.error);
    EXPECT_EQ(reader.record(record.node).bound, record.bound);
  }
}

TEST_F(PageTest, WhereNotAllFitsPositionsAreRoundedToOneLattice) {
  write(100'000'000);
  const std::uint64_t all = fs::file_size(page());
  const std::string account = write(all * 2 / 3);
  EXPECT_THAT(account, HasSubstr("positions are rounded to 16 bits"));
  const std::vector<NodeId> tiles = unpack();
  const storage::HierarchyReader original(*files_, hierarchy()), reader(*files_, unpacked());
  const auto& quantization = reader.manifest().quantization;
  ASSERT_TRUE(quantization);
  EXPECT_EQ(quantization->lattice.bits, 16);
  double worst = 0;
  for (const NodeId node : tiles) {
    const auto before = original.read_tile(node).mesh.vertices.positions;
    const auto after = reader.read_tile(node).mesh.vertices.positions;
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t v = 0; v < after.size(); ++v) {
      EXPECT_EQ(after[v], quantization->lattice.nearest(before[v]));
      worst = std::max(worst, length(to_double(after[v]) - to_double(before[v])));
    }
    EXPECT_GE(reader.record(node).bound, original.record(node).bound + worst);
    EXPECT_EQ(reader.record(node).error, original.record(node).error);
  }
  EXPECT_GT(worst, 0);
  EXPECT_EQ(quantization->worst_rounding, worst);
}

TEST_F(PageTest, AnySizeIsKeptOrRefusedWithOneThatDoes) {
  write(100'000'000);
  const std::uint64_t all = fs::file_size(page());
  std::size_t most_tiles = 0;
  for (std::uint64_t size = 500; size < all + 2000; size += all / 23) {
    std::uint64_t asked = size;
    const Error error = error_of(asked);
    if (error.code() != ErrorCode::internal) {
      ASSERT_EQ(error.code(), ErrorCode::usage);
      const std::string text = error.what();
      asked = std::stoull(text.substr(text.find("--size ") + 7));
      EXPECT_GT(asked, size);
      write(asked);
    }
    EXPECT_LE(fs::file_size(page()), asked);
    const std::size_t tiles = unpack().size();
    EXPECT_GE(tiles, most_tiles) << size;
    most_tiles = tiles;
  }
}

TEST_F(PageTest, ItSaysWhatDidNotFitAndTheSizeItNamesHoldsIt) {
  write(100'000'000);
  const std::string account = write(fs::file_size(page()) / 2);
  EXPECT_THAT(
      account,
      HasSubstr(" tiles did not fit. All of them take about 1MB: give --size 1MB, or --link"));
  EXPECT_THAT(write(1'000'000), Not(HasSubstr("did not fit")));
  EXPECT_THAT(account, HasSubstr("of which the viewer takes " + std::to_string(kViewer.size())));
  EXPECT_THAT(write(fs::file_size(page()) / 2, "https://h/a.3tz"),
              HasSubstr("the page fetches them from the link"));
}

TEST_F(PageTest, WithALinkTilesAreThoseOfTheHierarchy) {
  write(100'000'000, "https://h/a.3tz");
  for (const NodeId tile : unpack())
    EXPECT_EQ(text_of(storage::tile_path(unpacked(), tile)),
              text_of(storage::tile_path(hierarchy(), tile)));
  for (const char* file : {"hierarchy.json", "tiles.bin"})
    EXPECT_EQ(text_of(unpacked() / file), text_of(hierarchy() / file));
}

TEST_F(PageTest, ADamagedTileIsNeverPutIntoAPage) {
  const fs::path tile = storage::tile_path(hierarchy(), tests::node(1, 0));
  std::string bytes = text_of(tile);
  bytes[bytes.size() / 2] ^= 1;
  storage::write_file(*files_, tile, page_bytes(bytes));
  for (const char* link : {"", "https://h/a.3tz"}) {
    try {
      write(100'000'000, link);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
      EXPECT_THAT(error.what(), HasSubstr("000000.glb"));
    }
  }
  EXPECT_FALSE(files_->exists(page()));
}

TEST_F(PageTest, ADamagedOutlineIsNeverPutIntoAPage) {
  const fs::path outline = storage::outline_path(hierarchy());
  std::string bytes = text_of(outline);
  bytes[bytes.size() / 2] ^= 1;
  storage::write_file(*files_, outline, page_bytes(bytes));
  try {
    write(100'000'000, "");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::corrupt);
    EXPECT_THAT(error.what(), HasSubstr("outline.glb"));
  }
  EXPECT_FALSE(files_->exists(page()));
}

// ---- stories

std::vector<std::byte> picture_bytes(const std::string& bytes) {
  return {page_bytes(bytes).begin(), page_bytes(bytes).end()};
}

/// Pictures "a.png" and "big.png", which is too large; nothing else is there.
std::vector<std::byte> open_some(const std::string& address, std::uint64_t most) {
  if (address == "a.png")
    return picture_bytes(kPicture);
  if (address == "text.png")
    return picture_bytes("no picture");
  throw Error(ErrorCode::input, most < 100 ? "no room" : "it is not there");
}

PageStory story_with(const nlohmann::json& body) {
  const nlohmann::json story{{"type", "AnnotationPage"},
                             {"items", {{{"type", "Annotation"}, {"body", body}}}}};
  return with_pictures(story.dump(), "s", 1000, open_some);
}

nlohmann::json image_body(const std::string& id) {
  return {{"id", id}, {"type", "Image"}};
}

nlohmann::json body_of(const PageStory& story) {
  return nlohmann::json::parse(story.text)["items"][0].value("body", nlohmann::json());
}

const std::string kInline = "data:image/png;base64," + base64(page_bytes(kPicture));

TEST(PageStoryTest, PicturesAreInItWhereverABodyHasThem) {
  const nlohmann::json text{{"type", "TextualBody"}, {"value", "told"}};
  EXPECT_EQ(body_of(story_with(image_body("a.png"))), image_body(kInline));
  EXPECT_EQ(body_of(story_with({text, image_body("a.png")})),
            nlohmann::json({text, image_body(kInline)}));
  const nlohmann::json choice{{"type", "Choice"}, {"items", {image_body("a.png"), text}}};
  EXPECT_EQ(body_of(story_with(choice))["items"], nlohmann::json({image_body(kInline), text}));
  EXPECT_EQ(story_with({image_body("a.png"), image_body("a.png")}).pictures, 2U);
}

TEST(PageStoryTest, ThoseThatCannotBeHadAreRemovedAndTold) {
  const nlohmann::json text{{"type", "TextualBody"}, {"value", "told"}};
  const PageStory story =
      story_with({image_body("none.png"), text, image_body("text.png"), image_body("a.png")});
  EXPECT_EQ(body_of(story), nlohmann::json({text, image_body(kInline)}));
  EXPECT_EQ(story.pictures, 1U);
  EXPECT_THAT(story.left_out, ElementsAre("none.png: it is not there",
                                          "text.png: it is no JPEG, PNG, WebP, GIF or AVIF"));
  EXPECT_EQ(body_of(story_with(image_body("none.png"))), nlohmann::json());
  EXPECT_THAT(story_with(image_body("https://me:word@h/a.png?key=1")).left_out,
              ElementsAre("https://h/a.png: it is not there"));
}

TEST(PageStoryTest, WhereNothingChangesTheTextIsTheSame) {
  for (const std::string text :
       {R"({ "items": [] })", R"({"body": {"type": "Image", "id": "data:image/png;base64,AAAA"}})",
        R"({"thumbnail": {"type": "Image", "id": "none.png"}})", R"({"body": "none.png"})",
        R"({"body": {"type": "Image"}, "at": 0.1})"}) {
    const PageStory story = with_pictures(text, "s", 1000, open_some);
    EXPECT_EQ(story.text, text);
    EXPECT_THAT(story.left_out, IsEmpty());
  }
}

TEST(PageStoryTest, WhatIsNoStoryIsRefused) {
  for (const std::string& text :
       {std::string("["), std::string("[]"), std::string("1"), std::string(),
        std::string(100'000, '['), "{\"a\":" + std::string(80, '[') + std::string(80, ']') + "}"})
    EXPECT_THROW((void)with_pictures(text, "s", 1000, open_some), Error) << text.substr(0, 20);
}

TEST(PageStoryTest, KindsOfPicturesAreKnownByTheirContent) {
  const auto type = [](const std::string& bytes) {
    return std::string(picture_type(picture_bytes(bytes)));
  };
  EXPECT_EQ(type(kPicture), "image/png");
  EXPECT_EQ(type("\xff\xd8\xff\xe0"), "image/jpeg");
  EXPECT_EQ(type("RIFF1234WEBPVP8 "), "image/webp");
  EXPECT_EQ(type("GIF89a"), "image/gif");
  EXPECT_EQ(type(std::string("\0\0\0\x1c", 4) + "ftypavif"), "image/avif");
  for (const char* other :
       {"", "RIFF", "<svg xmlns=", "%PDF-1.7", "BM", "RIFF1234WAVE", "ftypavif"})
    EXPECT_EQ(type(other), "") << other;
}

TEST(PageStoryTest, Base64IsThatOfTheStandard) {
  const auto text = [](const std::string& bytes) { return base64(page_bytes(bytes)); };
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("f"), "Zg==");
  EXPECT_EQ(text("fo"), "Zm8=");
  EXPECT_EQ(text("foobar"), "Zm9vYmFy");
  for (const std::size_t count : {0, 1, 2, 3, 4, 100})
    EXPECT_EQ(base64_size(count), text(std::string(count, 'x')).size());
}

}  // namespace
}  // namespace meshhier::exporting

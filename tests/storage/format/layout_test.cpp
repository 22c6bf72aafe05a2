#include "storage/format/layout.h"

#include <optional>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace meshhier::storage {
namespace {

TEST(Layout, FilesOfAHierarchyHaveTheirDocumentedNames) {
  const std::filesystem::path hierarchy = "some/where/david.hier";
  EXPECT_EQ(manifest_path(hierarchy), "some/where/david.hier/hierarchy.json");
  EXPECT_EQ(index_path(hierarchy), "some/where/david.hier/tiles.bin");
  EXPECT_EQ(outline_path(hierarchy), "some/where/david.hier/outline.glb");
  EXPECT_EQ(preview_path(hierarchy), "some/where/david.hier/preview.webp");
  EXPECT_EQ(objects_path(hierarchy), "some/where/david.hier/objects.bin");
  EXPECT_EQ(level_directory(hierarchy, Level{7}), "some/where/david.hier/tiles/07");
  EXPECT_EQ(tile_path(hierarchy, {Level{7}, 42}), "some/where/david.hier/tiles/07/000042.glb");
}

TEST(Layout, NumbersGrowBeyondTheirLeastDigits) {
  EXPECT_EQ(level_directory("h", Level{132}), "h/tiles/132");
  EXPECT_EQ(tile_path("h", {Level{31}, 2147483647}), "h/tiles/31/2147480000/2147483647.glb");
}

TEST(Layout, NoDirectoryHasMoreThanTenThousandTiles) {
  const Level level{14};
  EXPECT_EQ(tile_path({}, {level, 9999}), "tiles/14/009999.glb");
  EXPECT_EQ(tile_path({}, {level, 10000}), "tiles/14/010000/010000.glb");
  EXPECT_EQ(tile_path({}, {level, 1234567}), "tiles/14/1230000/1234567.glb");
  for (const std::uint32_t nodes : {1U, 10000U, 10001U, 30000U, 65536U}) {
    std::set<std::filesystem::path> used;
    for (std::uint32_t i = 0; i < nodes; ++i)
      used.insert(tile_path("h", {level, i}).parent_path());
    const auto all = tile_directories("h", level, nodes);
    EXPECT_EQ(std::set(all.begin(), all.end()), used) << nodes;
    EXPECT_EQ(all.size(), used.size());
    EXPECT_EQ(all.front(), level_directory("h", level));
  }
}

TEST(Layout, TilesAreFoundByTheirNamesAlone) {
  for (const std::uint32_t index : {0U, 9999U, 10000U, 19999U, 4294967295U}) {
    for (const int level : {0, 9, 14, 132}) {
      const NodeId node{static_cast<Level>(level), index};
      EXPECT_EQ(tile_of(tile_path({}, node).generic_string()), node);
    }
  }
}

TEST(Layout, WorkGoesOnBesideTheOutputInHiddenDirectories) {
  EXPECT_EQ(work_path("a/b.hier"), "a/.b.hier.meshhier-work");
  EXPECT_EQ(replaced_path("a/b.hier"), "a/.b.hier.meshhier-old");
  EXPECT_EQ(work_path("b.hier"), ".b.hier.meshhier-work");
  EXPECT_EQ(work_path("/b.hier"), "/.b.hier.meshhier-work");
  EXPECT_EQ(unfinished_path("a/b.json"), "a/.b.json.meshhier-part");
  EXPECT_EQ(built_path("a/.b.hier.meshhier-work"), "a/.b.hier.meshhier-work/hierarchy");
}

TEST(Layout, RunsOfVerifyWorkBesideTheHierarchyAndApart) {
  const std::filesystem::path first = verify_scratch_path("a/b.hier", 0xab);
  EXPECT_EQ(first, "a/.b.hier.meshhier-verify-000000ab");
  EXPECT_NE(first, verify_scratch_path("a/b.hier", 0xac));
}

TEST(Layout, NamesOfWhatWasLeftAreKnownAgain) {
  const auto known = [](const std::filesystem::path& path) {
    const std::optional<LeftoverName> name = leftover_name(path.filename().string());
    return name ? std::optional(std::pair(name->kind, name->output)) : std::nullopt;
  };
  for (const std::string output : {"b.hier", "b", ".b", "x.meshhier-work"}) {
    const std::filesystem::path path = std::filesystem::path("a") / output;
    EXPECT_EQ(known(work_path(path)), std::pair(Leftover::build, output));
    EXPECT_EQ(known(replaced_path(path)), std::pair(Leftover::replaced, output));
    EXPECT_EQ(known(input_note_path(path)), std::pair(Leftover::input_note, output));
    EXPECT_EQ(known(unfinished_path(path)), std::pair(Leftover::unfinished, output));
    EXPECT_EQ(known(verify_scratch_path(path, 0xab)), std::pair(Leftover::verify, output));
  }
  for (const char* other : {"b.hier", ".b.hier", "", ".", ".meshhier-work", "b.meshhier-work",
                            ".b.meshhier-", ".b.meshhier-works", ".b.meshhier-verify-1"})
    EXPECT_EQ(known(other), std::nullopt) << other;
}

TEST(Layout, FilesOfAHierarchyAreKnownByTheirNames) {
  for (const auto& path :
       {manifest_path({}), index_path({}), outline_path({}), preview_path({}), tileset_path({}),
        tileset_path({}, {static_cast<Level>(7), 3}), tile_path({}, {static_cast<Level>(0), 0}),
        tile_path({}, {static_cast<Level>(32), 4294967295U})}) {
    EXPECT_TRUE(is_hierarchy_file(path.string())) << path;
    EXPECT_FALSE(is_stream_file(path.string())) << path;
  }
  for (const auto& path :
       {progressive_index_path({}), detail_path({}, 0), detail_path({}, 7), detail_path({}, 100)}) {
    EXPECT_TRUE(is_stream_file(path.string())) << path;
    EXPECT_FALSE(is_hierarchy_file(path.string())) << path;
  }
  EXPECT_TRUE(tile_of("tiles/00/000000.glb"));
  EXPECT_FALSE(tile_of("outline.glb"));
}

TEST(Layout, NoOtherNameIsAFileOfAHierarchy) {
  for (const char* name : {"",
                           "tiles",
                           "tiles/",
                           "tiles/00",
                           "tiles/00/",
                           "tiles/0/000000.glb",
                           "tiles/00/00000.glb",
                           "tiles/000/000000.glb",
                           "tiles/00/0000000.glb",
                           "tiles/00/000000.glb.gz",
                           "tiles/00/000000.json",
                           "tiles/aa/000000.glb",
                           "tiles/00/00000a.glb",
                           "tiles/00//000000.glb",
                           "/tiles/00/000000.glb",
                           "tiles/../tiles.bin",
                           "tiles/00/99999999999.glb",
                           "tiles/14/010000.glb",
                           "tiles/14/010000/009999.glb",
                           "tiles/14/010000/020000.glb",
                           "tiles/14/10000/010000.glb",
                           "tiles/14/000000/000001.glb",
                           "tiles/14/010001/010001.glb",
                           "tiles/256/000000.glb",
                           "tiles/14/010000/010000/010000.glb",
                           "tilesets/00/000000.glb",
                           "Tiles.bin",
                           "tiles.bin/",
                           "hierarchy.json ",
                           "detail_1.bin",
                           "detail_001.bin",
                           "detail_.bin",
                           "detail_01.bin2",
                           "base.bin/x"}) {
    EXPECT_FALSE(is_hierarchy_file(name)) << name;
    EXPECT_FALSE(is_stream_file(name)) << name;
  }
}

TEST(Layout, NoTwoThingsShareAName) {
  std::set<std::filesystem::path> names{manifest_path("h"), index_path("h"), outline_path("h"),
                                        preview_path("h"),  lock_path("h"),  journal_path("h"),
                                        built_path("h")};
  std::size_t count = names.size();
  EXPECT_EQ(count, 7U);
  for (int level = 0; level < 4; ++level) {
    for (std::uint32_t i = 0; i < 4; ++i, ++count)
      names.insert(tile_path("h", {static_cast<Level>(level), i}));
  }
  EXPECT_EQ(names.size(), count);
}

}  // namespace

TEST(Layout, AStoryLiesBesideItsHierarchy) {
  EXPECT_EQ(story_path("models/a b.hier"), "models/a b.hier.story.json");
  EXPECT_EQ(told_of("models/a b.hier.story.json"), "models/a b.hier");
  EXPECT_EQ(told_of("a.3tz.story.json"), "a.3tz");
  for (const char* name : {"", ".story.json", "models/.story.json", "a.hier.story.jso", "a.hier"})
    EXPECT_EQ(told_of(name), std::nullopt) << name;
}

}  // namespace meshhier::storage

#include "inspection/inspect.h"

#include "base/error.h"
#include "storage/format/layout.h"
#include "storage/format/level_summary.h"
#include "tests/support/meshes.h"
#include "tests/support/sample_hierarchy.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::inspection {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using tests::node;

class InspectTest : public testing::Test {
 protected:
  InspectTest() : sample_(tests::make_sample(tests::sphere(1000), {6, 40, false, true, {}})) {
    for (TileRecord& record : sample_.records) {
      if (sample_.tree.is_partition(record.node))
        record.compactness = 1.5F + 0.25F * static_cast<float>(record.node.index);
    }
    tests::write_sample(*files_, path(), sample_);
    // Only manifest and index are read: the rest need not be there.
    fs::remove_all(path() / "tiles");
    fs::remove(storage::outline_path(path()));
  }
  fs::path path() const { return directory_.path() / "a.hier"; }
  std::string text(const InspectOptions& options = {}) {
    return inspect_text(*files_, path(), options);
  }
  nlohmann::ordered_json json(const InspectOptions& options = {}) {
    return inspect_json(*files_, path(), options);
  }

  tests::TemporaryDirectory directory_;
  std::unique_ptr<storage::FileSystem> files_ = storage::make_posix_file_system();
  tests::Sample sample_;
};

TEST_F(InspectTest, JsonTellsTheSource) {
  const auto json = this->json();
  EXPECT_EQ(json["source"]["vertices"], 578);
  EXPECT_EQ(json["source"]["triangles"], 1152);
  EXPECT_EQ(json["source"]["attributes"], "8-bit colours");
  EXPECT_EQ(json["parameters"]["partition"]["count"], 6);
}

TEST_F(InspectTest, PlacesAreToldBesideVertices) {
  EXPECT_EQ(json()["source"]["places"], 578);
  EXPECT_THAT(text(), Not(HasSubstr("places")));
  sample_.manifest.source.vertices = 600;
  const std::string manifest = storage::to_json_text(sample_.manifest);
  storage::write_file(*files_, storage::manifest_path(path()), std::as_bytes(std::span(manifest)));
  EXPECT_EQ(json()["source"]["vertices"], 600);
  EXPECT_EQ(json()["source"]["places"], 578);
  EXPECT_THAT(text(), HasSubstr("600 vertices at 578 places (0 of no triangle)"));
}

TEST_F(InspectTest, CopiesAreToldOfLevelsAndTiles) {
  EXPECT_EQ(json()["levels"][3]["copies_total"], 0);
  EXPECT_THAT(text({.level = {}, .node = node(3, 2)}), Not(HasSubstr("copies")));
  sample_.record(node(3, 2)).copy_count = 12;
  sample_.record(node(3, 4)).copy_count = 1;
  fs::remove_all(path());
  tests::write_sample(*files_, path(), sample_);
  EXPECT_EQ(json()["levels"][3]["copies_total"], 13);
  EXPECT_EQ(json()["levels"][2]["copies_total"], 0);
  EXPECT_EQ(json({.level = {}, .node = node(3, 2)})["tile"]["copies"], 12);
  EXPECT_THAT(text({.level = {}, .node = node(3, 2)}), HasSubstr(" ghosts, 12 copies; "));
  EXPECT_THAT(text({.level = {}, .node = node(3, 4)}), HasSubstr(" ghosts, 1 copy; "));
  EXPECT_THAT(text(), HasSubstr("|        13         0 |"));
}

TEST_F(InspectTest, SplitsAreToldOfLevelsAndTiles) {
  EXPECT_EQ(json()["levels"][3]["splits_total"], 0);
  EXPECT_THAT(text({.level = {}, .node = node(3, 2)}), Not(HasSubstr("splits")));
  sample_.manifest.computed_normals = true;
  sample_.record(node(3, 2)).split_count = 12;
  sample_.record(node(3, 4)).split_count = 1;
  fs::remove_all(path());
  tests::write_sample(*files_, path(), sample_);
  EXPECT_EQ(json()["levels"][3]["splits_total"], 13);
  EXPECT_EQ(json()["levels"][2]["splits_total"], 0);
  EXPECT_EQ(json({.level = {}, .node = node(3, 2)})["tile"]["splits"], 12);
  EXPECT_THAT(text({.level = {}, .node = node(3, 2)}), HasSubstr(" ghosts, 12 splits; "));
  EXPECT_THAT(text({.level = {}, .node = node(3, 4)}), HasSubstr(" ghosts, 1 split; "));
  EXPECT_THAT(text(), HasSubstr("|         0        13 |"));
}

TEST_F(InspectTest, RawBytesCountComputedNormals) {
  const auto raw_bytes = [&] { return json()["sizes"]["all"]["raw_bytes"].get<std::uint64_t>(); };
  const std::uint64_t before = raw_bytes();
  std::uint64_t vertices = 0;
  for (const PublishedTile& tile : sample_.tiles)
    vertices += tile.mesh.vertices.size();
  constexpr std::uint64_t kSplits = 5;
  sample_.manifest.computed_normals = true;
  sample_.record(node(3, 2)).split_count = kSplits;
  fs::remove_all(path());
  tests::write_sample(*files_, path(), sample_);
  constexpr std::uint64_t kNormal = 4, kPosition = 12, kColour = 8;
  EXPECT_EQ(raw_bytes(), before + kNormal * vertices + (kNormal + kPosition + kColour) * kSplits);
}

TEST_F(InspectTest, JsonTellsThePartitions) {
  const auto partitions = json()["partitions"];
  EXPECT_EQ(partitions["count"], 6);
  EXPECT_EQ(partitions["vertices_min"], 96);
  EXPECT_EQ(partitions["vertices_max"], 97);
  EXPECT_DOUBLE_EQ(partitions["vertices_mean"].get<double>(), 578 / 6.0);
  // The sample's partition i has 1.5 + i / 4.
  EXPECT_DOUBLE_EQ(partitions["compactness_mean"].get<double>(), 2.125);
  EXPECT_DOUBLE_EQ(partitions["compactness_median"].get<double>(), 2.0);
  EXPECT_DOUBLE_EQ(partitions["compactness_p95"].get<double>(), 2.75);
}

TEST_F(InspectTest, JsonTellsEveryLevel) {
  const auto levels = json()["levels"];
  ASSERT_EQ(levels.size(), 4U);
  const std::vector<int> tiles{1, 2, 2, 6};
  const std::vector<int> shown{1, 2, 4, 6};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto& level = levels[i];
    EXPECT_EQ(level["level"], i);
    EXPECT_EQ(level["tiles"], tiles[i]);
    EXPECT_EQ(level["shown_tiles"], shown[i]);
    EXPECT_EQ(level["shown_triangles_exact"], i != 2);
    EXPECT_EQ(level["vertices_min"], i == 3 ? 96 : 40);
    EXPECT_EQ(level["vertices_max"], i == 3 ? 97 : 40);
    EXPECT_EQ(level["error_max"], 0.25 * (3.0 - static_cast<double>(i)));
    EXPECT_EQ(level["bound_max"], 0.5 * (3.0 - static_cast<double>(i)));
    EXPECT_EQ(level["off_target"], 0);
    EXPECT_LE(level["bytes_min"], level["bytes_mean"]);
    EXPECT_LE(level["bytes_mean"], level["bytes_max"]);
  }
  EXPECT_EQ(levels[3]["triangles_total"], 1152);
  EXPECT_EQ(levels[3]["shown_triangles"], 1152);
  EXPECT_EQ(levels[0]["border_ratio"], 0);
  EXPECT_GT(levels[3]["border_ratio"], 0);
}

TEST_F(InspectTest, JsonTellsBytes) {
  const auto json = this->json();
  std::uint64_t tiles = 0;
  for (const TileRecord& record : sample_.records)
    tiles += record.file_bytes;
  EXPECT_EQ(json["tile_bytes"], tiles);
  EXPECT_EQ(json["outline"]["bytes"], sample_.manifest.outline_bytes);
  EXPECT_EQ(json["tileset"]["bytes"], sample_.manifest.tileset_bytes);
  EXPECT_EQ(json["total_bytes"], tiles + sample_.manifest.outline_bytes +
                                     fs::file_size(storage::tileset_path(path())) +
                                     fs::file_size(storage::index_path(path())) +
                                     fs::file_size(storage::manifest_path(path())));
}

TEST_F(InspectTest, SizesAreToldAgainstRawFloatsAndIndices) {
  std::uint64_t bytes = 0, raw_bytes = 0, vertices = 0, triangles = 0;
  for (const TileRecord& r : sample_.records) {
    if (raw(r.node.level) != 3)
      continue;
    bytes += r.file_bytes;
    // Light of 16 bits with a stride of 8; indices of 16 bits.
    raw_bytes += (r.own_count + r.ghost_count) * (12 + 8) + (r.interior_count + r.border_count) * 6;
    vertices += r.own_count;
    triangles += r.interior_count + r.drawn_border_count;
  }
  const auto sizes = json()["sizes"]["partitions"];
  EXPECT_EQ(sizes["bytes"], bytes);
  EXPECT_EQ(sizes["raw_bytes"], raw_bytes);
  const auto part = [&](std::uint64_t of) {
    return static_cast<double>(bytes) / static_cast<double>(of);
  };
  EXPECT_DOUBLE_EQ(sizes["bytes_per_vertex"].get<double>(), part(vertices));
  EXPECT_DOUBLE_EQ(sizes["bytes_per_triangle"].get<double>(), part(triangles));
  EXPECT_DOUBLE_EQ(sizes["raw_ratio"].get<double>(), part(raw_bytes));
  EXPECT_EQ(json()["sizes"]["all"]["bytes"], json()["tile_bytes"]);
  EXPECT_THAT(text(), HasSubstr("bytes a vertex and"));
}

TEST_F(InspectTest, TheStorageIsTold) {
  EXPECT_EQ(json()["storage"].dump(),
            R"({"compression":"none","positions":null,"normals":"none","texture":null})");
  EXPECT_THAT(text(), HasSubstr("storage      none, positions exact"));
  sample_.manifest.compression = storage::Compression::meshopt;
  sample_.manifest.quantization =
      storage::Quantization{make_lattice({{0, 0, 0}, {2, 2, 2}}, 8), 0.01};
  const std::string manifest = storage::to_json_text(sample_.manifest);
  storage::write_file(*files_, storage::manifest_path(path()), std::as_bytes(std::span(manifest)));
  EXPECT_EQ(json()["storage"]["positions"].dump(),
            R"({"bits":8,"step":0.015625,"worst_rounding":0.01})");
  EXPECT_THAT(text(), HasSubstr("storage      meshopt, positions on a lattice of 8 bits, step "
                                "0.01562, off by 0.01 at most"));
}

TEST_F(InspectTest, ItIsToldWhereNormalsComeFrom) {
  const auto rewrite = [&] {
    const std::string manifest = storage::to_json_text(sample_.manifest);
    storage::write_file(*files_, storage::manifest_path(path()),
                        std::as_bytes(std::span(manifest)));
  };
  EXPECT_THAT(text(), HasSubstr("\nnormals      none\n"));
  sample_.manifest.computed_normals = true;
  rewrite();
  EXPECT_EQ(json()["storage"]["normals"], "computed");
  EXPECT_THAT(text(), HasSubstr("\nnormals      computed, 8 bits\n"));
  sample_.manifest.computed_normals = false;
  sample_.manifest.source.attributes.normals = true;
  rewrite();
  EXPECT_EQ(json()["storage"]["normals"], "given");
  EXPECT_THAT(text(), HasSubstr("\nnormals      given\n"));
}

TEST_F(InspectTest, ALevelIsToldTileByTile) {
  const auto json = this->json({.level = static_cast<Level>(2), .node = {}});
  ASSERT_EQ(json["levels"].size(), 1U);
  EXPECT_EQ(json["levels"][0]["level"], 2);
  ASSERT_EQ(json["tiles"].size(), 2U);
  EXPECT_EQ(json["tiles"][0]["node"], "2/0");
  EXPECT_EQ(json["tiles"][1]["node"], "2/2");
  const std::string text = this->text({.level = static_cast<Level>(2), .node = {}});
  EXPECT_THAT(text, HasSubstr("tile 2/0: 40 vertices"));
  EXPECT_THAT(text, HasSubstr("tile 2/2: 40 vertices"));
  EXPECT_THAT(text, Not(HasSubstr("tile 3/")));
}

TEST_F(InspectTest, AnEarlyNodeIsToldAsItsPartition) {
  const TileRecord& record = sample_.record(node(3, 2));
  for (NodeId asked : {node(2, 1), node(3, 2)}) {
    const auto tile = json({.level = {}, .node = asked})["tile"];
    EXPECT_EQ(tile["node"], "3/2");
    EXPECT_EQ(tile["vertices"], record.own_count);
    EXPECT_EQ(tile["border_triangles"], record.border_count);
    EXPECT_EQ(tile["bytes"], record.file_bytes);
    EXPECT_THAT(text({.level = {}, .node = asked}), HasSubstr("tile 3/2: "));
  }
}

TEST_F(InspectTest, TextShowsItAll) {
  const std::string text = this->text();
  EXPECT_THAT(text, HasSubstr("578 vertices (0 of no triangle), 1,152 triangles"));
  EXPECT_THAT(text, HasSubstr("partition.count 6"));
  EXPECT_THAT(text, HasSubstr("6 of 96 to 97 vertices"));
  EXPECT_THAT(text, HasSubstr("mean 2.125, median 2.000, p95 2.750"));
  EXPECT_THAT(text, HasSubstr("11 tiles"));
  EXPECT_THAT(text, HasSubstr("\noutline "));
  EXPECT_THAT(text, HasSubstr("8-bit colours"));
  EXPECT_THAT(text, HasSubstr("<="));
  EXPECT_EQ(text, this->text());
}

TEST_F(InspectTest, TextShowsNoControlCharactersOfAManifest) {
  storage::Manifest manifest = sample_.manifest;
  manifest.generator = manifest.source.file_name = std::string("\x1b[2J").append(1000, 'x');
  manifest.config = {{"\x1b[2J", "\x1b[2J"}};
  const std::string json = storage::to_json_text(manifest);
  storage::write_file(*files_, storage::manifest_path(path()), std::as_bytes(std::span(json)));
  const std::string shown = text();
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
  EXPECT_THAT(shown, HasSubstr("?[2J ?[2J"));
  EXPECT_THAT(shown, Not(HasSubstr(std::string(300, 'x'))));
}

TEST_F(InspectTest, WhatIsNotThereIsAUsageError) {
  for (const InspectOptions& options : {InspectOptions{.level = static_cast<Level>(4), .node = {}},
                                        InspectOptions{.level = {}, .node = node(2, 4)},
                                        InspectOptions{.level = {}, .node = node(9, 0)}}) {
    try {
      text(options);
      FAIL() << "expected an error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_THAT(error.what(), HasSubstr("a.hier: there is no "));
    }
  }
}

TEST(Summary, CountsTilesOffTheirTargetButNotPartitions) {
  const Tree tree(100, 2);
  std::vector<TileRecord> records(3);
  records[0].own_count = 30;
  records[0].target_count = 40;
  records[1].node = {static_cast<Level>(1), 0};
  records[1].own_count = 50;
  records[1].target_count = 64;
  records[2] = records[1];
  records[2].node.index = 1;
  const auto levels = storage::summarize_levels(tree, records);
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[0].off_target, 1U);
  EXPECT_EQ(levels[1].off_target, 0U);
  EXPECT_EQ(levels[1].vertices.spread(), 0);
}

TEST(Summary, ForcedCollapsesAreManyFromAHundredthOfTheVerticesOn) {
  std::vector<TileRecord> records(2);
  records[0].torn_count = 6;
  records[1].forced_count = 4;
  const storage::ForcedCollapses forced = storage::summarize_forced_collapses(records, 1000);
  EXPECT_EQ(forced.vertices, 10U);
  EXPECT_DOUBLE_EQ(forced.share, 0.01);
  EXPECT_EQ(storage::forced_collapses_text(forced), "");
  records[1].forced_count = 5;
  EXPECT_THAT(storage::forced_collapses_text(storage::summarize_forced_collapses(records, 1000)),
              HasSubstr("warning: 11 vertices (1.1 % of the input's)"));
}

TEST_F(InspectTest, ForcedCollapsesAreTold) {
  EXPECT_THAT(text(), Not(HasSubstr("warning")));
  EXPECT_EQ(json()["forced_collapses"]["vertices"], 0U);
  sample_.record(node(0, 0)).torn_count = 100;
  fs::remove_all(path());
  tests::write_sample(*files_, path(), sample_);
  EXPECT_THAT(text(), HasSubstr("warning: 100 vertices (17.3 % of the input's)"));
  EXPECT_EQ(json()["forced_collapses"]["vertices"], 100U);
  EXPECT_DOUBLE_EQ(json()["forced_collapses"]["share"], 100.0 / 578);
}

TEST(Summary, OnePartitionIsOneLevel) {
  const Tree tree(100, 1);
  std::vector<TileRecord> records(1);
  records[0].own_count = 100;
  records[0].interior_count = 150;
  records[0].compactness = 0;  // no area
  const auto levels = storage::summarize_levels(tree, records);
  ASSERT_EQ(levels.size(), 1U);
  EXPECT_EQ(levels[0].shown_triangles, 150U);
  EXPECT_EQ(storage::summarize_compactness(tree, records).count, 0U);
}

}  // namespace
}  // namespace meshhier::inspection

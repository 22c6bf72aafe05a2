#include "storage/format/tile_glb.h"

#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/glb.h"
#include "storage/format/showable.h"
#include "storage/io/hash.h"
#include "support/decode_failure.h"
#include "support/open_glb.h"
#include "support/same_tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using storage::decode_tile;
using storage::encode_tile;
using storage::TileFormat;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using Bytes = std::vector<std::byte>;
using Json = nlohmann::ordered_json;

void expect_wedges_there(const std::vector<TileTriangle>& triangles,
                         const std::vector<CornerWedges>& wedges, const Copies& copies) {
  ASSERT_EQ(wedges.size(), copies.empty() ? 0 : triangles.size());
  for (std::size_t t = 0; t < wedges.size(); ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t place = raw(triangles[t][c]);
      ASSERT_LE(wedges[t][c], copies.first_of(place + 1) - copies.first_of(place));
    }
  }
}

void expect_consistent_copies(const TileMesh& mesh) {
  const Copies& copies = mesh.copies;
  ASSERT_EQ(copies.vertices.size(), copies.size());
  ASSERT_EQ(copies.vertices.attributes.size(),
            copies.size() * static_cast<std::size_t>(mesh.vertices.channels));
  ASSERT_TRUE(std::is_sorted(copies.places.begin(), copies.places.end()));
  for (std::size_t i = 0; i < copies.size(); ++i) {
    ASSERT_LT(copies.places[i], mesh.vertices.size());
    ASSERT_EQ(copies.vertices.positions[i], mesh.vertices.positions[copies.places[i]]);
  }
  expect_wedges_there(mesh.interior, mesh.interior_wedges, copies);
  expect_wedges_there(mesh.border, mesh.border_wedges, copies);
}

/// Checks the promises of TileMesh and PublishedTile for any tile.
void expect_consistent(const PublishedTile& tile, const Tree& tree) {
  const TileMesh& mesh = tile.mesh;
  ASSERT_LE(mesh.own_count, storage::kMaxOwnVertices);
  ASSERT_LE(mesh.boundary_count, mesh.own_count);
  ASSERT_EQ(mesh.ghosts.size() + mesh.own_count, mesh.vertices.size());
  ASSERT_EQ(mesh.vertices.attributes.size(),
            mesh.vertices.size() * static_cast<std::size_t>(mesh.vertices.channels));
  ASSERT_TRUE(std::is_sorted(mesh.ghosts.begin(), mesh.ghosts.end()));
  ASSERT_EQ(tile.chains.size(), mesh.ghosts.size());
  for (std::size_t g = 0; g < mesh.ghosts.size(); ++g) {
    const NodeId neighbour{tile.node.level, mesh.ghosts[g].tile};
    ASSERT_TRUE(tree.contains(neighbour));
    ASSERT_EQ(tile.chains[g].size(), tree.chain_length(tile.node, neighbour));
    ASSERT_EQ(tile.chains[g][0], mesh.ghosts[g].index);
  }
  for (const auto* triangles : {&mesh.interior, &mesh.border}) {
    for (const TileTriangle& t : *triangles) {
      for (const TileVertex v : t)
        ASSERT_LT(raw(v), mesh.vertices.size());
    }
  }
  expect_consistent_copies(mesh);
}

SampleHierarchy full_sample(std::uint32_t partitions = 5) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8, .texcoords = true};
  return make_sample(torus(200, 0.05F), partitions, {layout, {1.5, 0, -1e7}});
}

TEST(TileGlb, GivesEveryTileBackForAnyLayoutAndTree) {
  for (const AttributeLayout& layout : sample_layouts()) {
    for (const std::uint32_t partitions : {1U, 2U, 3U, 5U, 8U, 11U}) {
      const SampleHierarchy sample = make_sample(torus(250, 0.05F), partitions, {layout, {}});
      for (const PublishedTile& tile : sample.tiles) {
        const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back =
            decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
        expect_same_mesh(tile, back);
        const bool exact = sample.tree.is_partition(tile.node) || layout.colour == ColourType::none;
        if (exact) {
          EXPECT_EQ(bits_of(tile.mesh.vertices.attributes), bits_of(back.mesh.vertices.attributes));
        }
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
      }
    }
  }
}

TEST(TileGlb, TheRootAloneHasAFirstView) {
  for (const storage::Compression compression :
       {storage::Compression::none, storage::Compression::meshopt_zlib}) {
    SampleHierarchy sample = full_sample();
    sample.format.compression = compression;
    PublishedTile& root = sample.tiles.front();
    root.first_view = Standpoint{101.25, -13};
    const Bytes bytes = encode_tile(root, sample.tree, sample.format);
    const PublishedTile back = decode_tile(bytes, root.node, sample.tree, sample.format, kTileName);
    EXPECT_EQ(back.first_view, root.first_view);
    EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
  }
}

TEST(TileGlb, SANITIZED_ExtrasThatAreNoFirstViewAreRefused) {
  const SampleHierarchy sample = full_sample();
  const auto failure_with = [&](const PublishedTile& tile, const Json& extras) {
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    glb.json["extras"] = extras;
    return decode_failure(glb.close(), tile.node, sample);
  };
  const PublishedTile& root = sample.tiles.front();
  const Json good = {{"firstView", {1.5, -2}}};
  EXPECT_EQ(failure_with(root, good), "");
  EXPECT_THAT(failure_with(root, Json::object()), HasSubstr("not 2 finite numbers"));
  EXPECT_THAT(failure_with(root, {{"firstView", {1, 2, 3}}}), HasSubstr("not 2 finite numbers"));
  EXPECT_THAT(failure_with(root, {{"firstView", {0, 90.5}}}), HasSubstr("degrees"));
  EXPECT_THAT(failure_with(root, {{"firstView", {1, 2}}, {"more", 1}}), HasSubstr("not expected"));
  EXPECT_THAT(failure_with(sample.tiles.back(), good), HasSubstr("not expected"));
}

TEST(TileGlb, GivesBackCopiesForAnyLayoutAndTree) {
  for (const AttributeLayout& layout : sample_layouts()) {
    for (const std::uint32_t partitions : {1U, 2U, 3U, 8U}) {
      const SampleHierarchy sample =
          with_copies(make_sample(torus(250, 0.05F), partitions, {layout, {}}));
      for (const PublishedTile& tile : sample.tiles) {
        const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back =
            decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
        expect_same_mesh(tile, back);
        expect_consistent(back, sample.tree);
        if (sample.tree.is_partition(tile.node) || layout.colour == ColourType::none)
          expect_same_attributes(tile, back);
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
      }
    }
  }
}

TEST(TileGlb, CopiesMayDifferInTheSignOfAZero) {
  SampleHierarchy sample = with_copies(make_sample(open_grid(9, 9), 3));
  const PublishedTile& tile = sample.tiles.back();
  const auto& copies = tile.mesh.copies;
  const auto differs = [&](std::size_t i) {
    return bits_of(std::vector{copies.vertices.positions[i]}) !=
           bits_of(std::vector{tile.mesh.vertices.positions[copies.places[i]]});
  };
  std::size_t others = 0;
  for (std::size_t i = 0; i < copies.size(); ++i)
    others += differs(i) ? 1 : 0;
  ASSERT_GT(others, 0U);
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  expect_same_mesh(tile, decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName));
}

TEST(TileGlb, RawAttributesOfCopiesAreKept) {
  SampleHierarchy sample = with_copies(full_sample());
  PublishedTile& tile = sample.tiles.back();
  ASSERT_FALSE(tile.mesh.copies.empty());
  tile.mesh.copies.vertices.attributes[0] *= 1.01F;
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  OpenGlb scaled(bytes);
  EXPECT_NE(scaled.extension()["rawNormals"], -1);
  EXPECT_EQ(scaled.extension()["rawColours"], -1);
  expect_same_attributes(tile,
                         decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName));
}

TEST(TileGlb, GivesBackMeshesOfEveryKind) {
  const std::vector<TestMesh> meshes{open_grid(9, 9), non_manifold(150), soup(60),
                                     duplicates(120), points(40),        points(3)};
  for (const TestMesh& mesh : meshes) {
    const SampleHierarchy sample = make_sample(mesh, 3);
    for (const PublishedTile& tile : sample.tiles) {
      const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
      expect_same_mesh(tile, decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName));
    }
  }
}

TEST(TileGlb, PartitionsKeepEveryBitOfAwkwardAttributes) {
  const std::array values{std::numeric_limits<float>::quiet_NaN(),
                          std::bit_cast<float>(0xFFC12345U),
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(),
                          -0.0F,
                          std::numeric_limits<float>::denorm_min(),
                          std::numeric_limits<float>::max(),
                          -7.5F};
  const AttributeLayout layout{
      .normals = true, .colour = ColourType::f32, .alpha = true, .texcoords = true};
  SampleHierarchy sample = make_sample(torus(200), 3, {layout, false, {}});
  std::mt19937 random(1);
  for (PublishedTile& tile : sample.tiles) {
    if (!sample.tree.is_partition(tile.node))
      continue;
    for (float& value : tile.mesh.vertices.attributes)
      value = values[random() % values.size()];
    tile.mesh.vertices.positions[0] = {-0.0F, std::numeric_limits<float>::denorm_min(), 3e38F};
    const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    const PublishedTile back = decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
    EXPECT_EQ(bits_of(tile.mesh.vertices.attributes), bits_of(back.mesh.vertices.attributes));
    expect_same_mesh(tile, back);
    EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
  }
}

TEST(TileGlb, ZUpTilesAreTurnedByTheirNodeAlone) {
  SampleHierarchy sample = full_sample();
  const PublishedTile& tile = sample.tiles.back();
  const Bytes y_up = encode_tile(tile, sample.tree, sample.format);
  sample.format.frame = {{10, 20, 30}, UpAxis::z};
  const Bytes z_up = encode_tile(tile, sample.tree, sample.format);
  // (x, y, z) becomes (x, z, -y); column by column.
  EXPECT_EQ(OpenGlb(z_up).json["nodes"][0]["matrix"],
            Json({1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 10, 30, -20, 1}));
  expect_same_mesh(tile, decode_tile(z_up, tile.node, sample.tree, sample.format, kTileName));
  EXPECT_THROW(decode_tile(y_up, tile.node, sample.tree, sample.format, kTileName), Error);
}

TEST(TileGlb, RawAttributesAreStoredOnlyWhereNeeded) {
  SampleHierarchy sample = full_sample();
  PublishedTile& tile = sample.tiles.back();
  OpenGlb plain(encode_tile(tile, sample.tree, sample.format));
  EXPECT_EQ(plain.extension()["rawNormals"], -1);
  tile.mesh.vertices.attributes[0] *= 1.01F;
  OpenGlb scaled(encode_tile(tile, sample.tree, sample.format));
  EXPECT_NE(scaled.extension()["rawNormals"], -1);
  EXPECT_EQ(scaled.extension()["rawColours"], -1);
  EXPECT_EQ(scaled.extension()["rawTexcoords"], -1);
}

TEST(TileGlb, SANITIZED_RawAttributesAboveThePartitionsAreRefused) {
  // With the same layout the partition's file is read; nothing would write back what it says.
  SampleHierarchy sample = make_sample(torus(100), 1, {{.normals = true}, {}});
  PublishedTile& tile = sample.tiles[0];
  tile.mesh.vertices.attributes[0] *= 1.01F;
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
  const SampleHierarchy deeper = make_sample(torus(100), 2, sample.format);
  EXPECT_THAT(decode_failure(bytes, tile.node, deeper), HasSubstr("the BIN chunk has"));
}

TEST(TileGlb, SimplifiedTilesKeepWhatGltfCanSay) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto root_back = [](const AttributeLayout& layout, const std::vector<float>& channels) {
    SampleHierarchy sample = make_sample(torus(100), 2, {layout, {}});
    PublishedTile& root = sample.tiles[0];
    std::copy(channels.begin(), channels.end(), root.mesh.vertices.attributes.begin());
    const Bytes bytes = encode_tile(root, sample.tree, sample.format);
    auto all = decode_tile(bytes, root.node, sample.tree, sample.format, kTileName)
                   .mesh.vertices.attributes;
    all.resize(channels.size());
    return all;
  };
  const AttributeLayout u8{.colour = ColourType::u8, .alpha = true};
  EXPECT_EQ(root_back(u8, {-3, 0.5F, 254.4F, 300}), (std::vector<float>{0, 1, 254, 255}));
  EXPECT_EQ(root_back(u8, {nan, 127.5F, 3e38F, 7}), (std::vector<float>{0, 128, 255, 7}));
  EXPECT_EQ(root_back({.colour = ColourType::u16}, {65534.5F, 70000, 12.25F}),
            (std::vector<float>{65535, 65535, 12}));
  EXPECT_EQ(root_back({.colour = ColourType::f32}, {-0.25F, 0.3F, 1.5F}),
            (std::vector<float>{0, 0.3F, 1}));
  EXPECT_EQ(root_back({.normals = true}, {0, 0, 0, 3, 0, 4, 0, nan, 0}),
            (std::vector<float>{0, 0, 1, 0.6F, 0, 0.8F, 0, 0, 1}));
  EXPECT_EQ(root_back({.texcoords = true}, {nan, -12.5F}), (std::vector<float>{0, -12.5F}));
}

TEST(TileGlb, UnitNormalsAreThoseWithinAThousandth) {
  EXPECT_TRUE(storage::is_unit_normal({0, 1, 0}));
  EXPECT_TRUE(storage::is_unit_normal({0, 1.0009F, 0}));
  EXPECT_FALSE(storage::is_unit_normal({0, 1.0011F, 0}));
  EXPECT_FALSE(storage::is_unit_normal({0, 0.9989F, 0}));
  EXPECT_FALSE(storage::is_unit_normal({0, 0, 0}));
  EXPECT_FALSE(storage::is_unit_normal({std::numeric_limits<float>::quiet_NaN(), 1, 0}));
}

/// A partition of 32768 own vertices, and so many ghosts in two neighbours.
PublishedTile wide_tile(std::uint32_t ghosts) {
  PublishedTile tile;
  tile.node = {Level{2}, 0};
  tile.mesh.own_count = storage::kMaxOwnVertices;
  tile.mesh.boundary_count = 2;
  tile.parent_map.assign(tile.mesh.own_count, 32767);
  for (std::uint32_t g = 0; g < ghosts; ++g) {
    const GhostRef ref{1 + g / 32768, g % 32768};
    tile.mesh.ghosts.push_back(ref);
    const std::array<std::uint16_t, 2> chain{static_cast<std::uint16_t>(ref.index), 7};
    tile.chains.add(std::span(chain).first(ref.tile > 1 ? 2 : 1));
    tile.mesh.border.push_back(
        {TileVertex{0}, TileVertex{1}, static_cast<TileVertex>(tile.mesh.own_count + g)});
  }
  tile.mesh.vertices.positions.resize(tile.mesh.own_count + ghosts);
  return tile;
}

TEST(TileGlb, IndicesTake32BitsFrom65536VerticesOn) {
  const Tree tree(4 * 32768, 4);
  const TileFormat format;
  for (const auto& [ghosts, type] :
       {std::pair{32767U, 5123}, std::pair{32768U, 5125}, std::pair{40000U, 5125}}) {
    const PublishedTile tile = wide_tile(ghosts);
    const Bytes bytes = encode_tile(tile, tree, format);
    EXPECT_EQ(OpenGlb(bytes).json["accessors"][1]["componentType"], type);
    expect_same_mesh(tile, decode_tile(bytes, tile.node, tree, format, kTileName));
  }
}

/// With so many copies of its last own vertex, the last of which a triangle uses.
PublishedTile wide_tile_with_copies(std::uint32_t ghosts, std::uint32_t copies) {
  PublishedTile tile = wide_tile(ghosts);
  TileMesh& mesh = tile.mesh;
  const TileVertex last{mesh.own_count - 1};
  mesh.copies.places.assign(copies, raw(last));
  mesh.copies.vertices.positions.resize(copies);
  mesh.border_wedges.resize(mesh.border.size());
  mesh.interior = {{TileVertex{0}, TileVertex{1}, last}};
  mesh.interior_wedges = {{0, 0, copies}};
  return tile;
}

TEST(TileGlb, CopiesCountForTheWidthOfIndicesNotForThatOfCopyOf) {
  const Tree tree(4 * 32768, 4);
  const TileFormat format;
  struct Case {
    std::uint32_t ghosts, copies;
    int index, copy_of;
  };
  for (const Case& c : {Case{20000, 12767, 5123, 2}, Case{20000, 12768, 5125, 2},
                        Case{32767, 1, 5125, 2}, Case{32768, 1, 5125, 4}}) {
    const PublishedTile tile = wide_tile_with_copies(c.ghosts, c.copies);
    const Bytes bytes = encode_tile(tile, tree, format);
    OpenGlb glb(bytes);
    EXPECT_EQ(glb.json["accessors"][1]["componentType"], c.index);
    const Json& view = glb.json["bufferViews"][glb.extension()["copyOf"].get<std::size_t>()];
    EXPECT_EQ(view["byteLength"], static_cast<std::uint32_t>(c.copy_of) * c.copies);
    expect_same_mesh(tile, decode_tile(bytes, tile.node, tree, format, kTileName));
  }
}

TEST(TileGlb, TilesWithoutTrianglesShowTheirVertices) {
  const SampleHierarchy sample = make_sample(points(5), 1);
  OpenGlb glb(encode_tile(sample.tiles[0], sample.tree, sample.format));
  EXPECT_EQ(glb.json["meshes"][0]["primitives"].dump(),
            R"([{"attributes":{"POSITION":0},"material":0,"mode":0}])");
  EXPECT_EQ(glb.extension()["interiorPrimitive"], -1);
  EXPECT_EQ(glb.extension()["borderPrimitive"], -1);
}

TEST(TileGlb, TheJsonIsThatOfTheDocument) {
  TestMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SampleHierarchy sample = make_sample(mesh, 2, {{}, {0.5, 0, 0}});
  OpenGlb glb(encode_tile(sample.tile({Level{1}, 0}), sample.tree, sample.format));
  EXPECT_EQ(glb.json["nodes"].dump(), R"([{"mesh":0,"translation":[0.5,0.0,0.0]}])");
  EXPECT_EQ(glb.json["accessors"][0].dump(),
            R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
            R"("min":[0.0,0.0,0.0],"max":[1.0,1.0,0.10000000149011612]})");
  EXPECT_EQ(
      glb.extension().dump(),
      R"({"version":4,"level":1,"index":0,"ownCount":2,"rimCount":2,"ghostCount":2,)"
      R"("copyCount":0,"neighbourCount":1,"chainEntryCount":2,"interiorCount":0,"borderCount":2,)"
      R"("interiorPrimitive":-1,"borderPrimitive":0,"parentMap":2,"neighbours":3,)"
      R"("ghostStarts":4,"ghostChains":5,"copyOf":-1,"rawNormals":-1,"rawColours":-1,)"
      R"("rawTexcoords":-1})");
  EXPECT_EQ(glb.json["extensionsUsed"].dump(), R"(["MESHHIER_tile"])");
  EXPECT_FALSE(glb.json.contains("extensionsRequired"));
}

// A failure here says that files of the same version have other bytes than before: existing
// hierarchies no longer match. Raise the version (docs/file_format.md), then the number here.
TEST(TileGlb, TheBytesOfAVersionStayTheSame) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8, .texcoords = true};
  SampleHierarchy sample = make_sample(open_grid(7, 6), 3, {layout, {0.5, 0, 0}});
  const auto sum_of = [](const SampleHierarchy& tiles) {
    storage::Checksum sum;
    for (const PublishedTile& tile : tiles.tiles)
      sum.add(encode_tile(tile, tiles.tree, tiles.format));
    return sum.value();
  };
  EXPECT_EQ(sum_of(sample), 1847876224033139254ULL);
  EXPECT_EQ(sum_of(with_copies(sample)), 4349102185125013716ULL);
  sample.format.screen_colours = true;  // version 3
  EXPECT_EQ(sum_of(sample), 16409328135631630208ULL);
  EXPECT_EQ(sum_of(with_copies(sample)), 13912142381089594659ULL);
}

TEST(TileGlb, WithoutCopiesTheBytesAreThoseOfVersion1ButForTheNewKeys) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8, .texcoords = true};
  SampleHierarchy sample = make_sample(open_grid(7, 6), 3, {layout, {0.5, 0, 0}});
  sample.format.screen_colours = true;
  storage::Checksum sum;
  for (const PublishedTile& tile : sample.tiles) {
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    glb.extension()["version"] = 1;
    glb.extension().erase("copyCount");
    glb.extension().erase("copyOf");
    sum.add(glb.close());
  }
  EXPECT_EQ(sum.value(), 8496102127265295638ULL);  // as version 1 had it
}

TEST(TileGlb, TilesOfVersion3AreReadAsTheyAre) {
  for (const AttributeLayout& layout : sample_layouts()) {
    SampleHierarchy sample = make_sample(torus(250, 0.05F), 3, {layout, {}});
    const SampleHierarchy now = sample;
    sample.format.screen_colours = true;
    for (const PublishedTile& tile : sample.tiles) {
      const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
      const PublishedTile back =
          decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName);
      EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
      EXPECT_THAT(decode_failure(bytes, tile.node, now),
                  HasSubstr("version of MESHHIER_tile is 3, expected 4"));
    }
  }
}

TEST(TileGlb, SANITIZED_TruncationAtEveryByteIsRefused) {
  const SampleHierarchy sample = make_sample(torus(100), 3);
  const PublishedTile& tile = sample.tiles.back();
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(decode_failure(cut, tile.node, sample), "") << size;
    if (size < 12)
      continue;
    // The same with a header that tells the new length.
    storage::store_little(static_cast<std::uint32_t>(size), cut.data() + 8);
    EXPECT_NE(decode_failure(cut, tile.node, sample), "") << size;
  }
}

TEST(TileGlb, SANITIZED_RandomFlipsAreRefusedOrHarmless) {
  const SampleHierarchy sample = full_sample();
  std::mt19937 random(7);
  std::size_t refused = 0;
  for (int round = 0; round < 3000; ++round) {
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    const std::size_t flips = 1 + random() % 3;
    for (std::size_t i = 0; i < flips; ++i) {
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    }
    try {
      expect_consistent(decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName),
                        sample.tree);
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
      EXPECT_THAT(error.what(), StartsWith(kTileName));
    }
  }
  EXPECT_GT(refused, 1000U);
}

TEST(TileGlb, SANITIZED_RandomNumbersInTheJsonAreRefused) {
  const SampleHierarchy sample = full_sample();
  std::mt19937 random(8);
  const std::array<Json, 7> values{-1, 0, 3, 4294967295U, 1e300, "x", Json::array()};
  for (int round = 0; round < 2000; ++round) {
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    Json flat = glb.json.flatten();
    auto place = flat.begin();
    std::advance(place, static_cast<std::ptrdiff_t>(random() % flat.size()));
    const Json& value = values[random() % values.size()];
    const bool same = place.value() == value;
    if (place.key().ends_with("rimCount"))  // a boundary may be larger than it need be
      continue;
    glb.json[Json::json_pointer(place.key())] = value;
    EXPECT_EQ(decode_failure(glb.close(), tile.node, sample).empty(), same) << place.key() << value;
  }
}

/// One change to a good file of the last tile of full_sample(), and what is said of it.
struct TileDamage {
  const char* name;
  std::function<void(OpenGlb&)> apply;
  const char* message;
};

void PrintTo(const TileDamage& damage, std::ostream* out) {
  *out << damage.name;
}

class DamagedTile : public testing::TestWithParam<TileDamage> {};

TEST_P(DamagedTile, SANITIZED_IsRefusedByName) {
  const SampleHierarchy sample = full_sample();
  const PublishedTile& tile = sample.tiles.back();
  OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
  GetParam().apply(glb);
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, DamagedTile,
    testing::Values(
        TileDamage{"no_extension", [](OpenGlb& g) { g.json.erase("extensions"); },
                   "extension MESHHIER_tile is missing"},
        TileDamage{"newer", [](OpenGlb& g) { g.extension()["version"] = 5; }, "newer meshhier"},
        TileDamage{"older", [](OpenGlb& g) { g.extension()["version"] = 1; },
                   "version of MESHHIER_tile is 1, expected 4"},
        TileDamage{"other_level", [](OpenGlb& g) { g.extension()["level"] = 1; }, "level is 1"},
        TileDamage{"other_index", [](OpenGlb& g) { g.extension()["index"] = 3; }, "index is 3"},
        TileDamage{"missing_count", [](OpenGlb& g) { g.extension().erase("ghostCount"); },
                   "\"ghostCount\" is missing"},
        TileDamage{"negative_count", [](OpenGlb& g) { g.extension()["borderCount"] = -5; },
                   "\"borderCount\" is -5"},
        TileDamage{"huge_count", [](OpenGlb& g) { g.extension()["interiorCount"] = 4294967295U; },
                   "the BIN chunk has"},
        TileDamage{"too_many_own", [](OpenGlb& g) { g.extension()["ownCount"] = 32769; },
                   "expected an integer from 0 to 32768"},
        TileDamage{"none_own",
                   [](OpenGlb& g) { g.extension()["ownCount"] = g.extension()["rimCount"] = 0; },
                   "without vertices"},
        TileDamage{"unknown_key", [](OpenGlb& g) { g.json["extras"] = 1; }, "is not expected"},
        TileDamage{"missing_key", [](OpenGlb& g) { g.json.erase("accessors"); }, "/accessors"},
        TileDamage{"moved_view", [](OpenGlb& g) { g.json["bufferViews"][3]["byteOffset"] = 0; },
                   "/bufferViews/3/byteOffset"},
        TileDamage{"wrong_max", [](OpenGlb& g) { g.json["accessors"][0]["max"][1] = 99; },
                   "/accessors/0/max/1"},
        TileDamage{"wrong_origin", [](OpenGlb& g) { g.json["nodes"][0]["translation"][0] = 2; },
                   "/nodes/0/translation/0"},
        TileDamage{"position", [](OpenGlb& g) { store_nan(g.attribute("POSITION")); },
                   "position of vertex 0 is not finite"},
        TileDamage{"normal", [](OpenGlb& g) { store_nan(g.attribute("NORMAL")); },
                   "NORMAL of vertex 0 is not finite"},
        TileDamage{"index", [](OpenGlb& g) { store_u16(g.indices(0), 60000); },
                   "index 60000 of interior triangle 0"},
        TileDamage{"degenerate", [](OpenGlb& g) { std::copy_n(g.indices(0), 2, g.indices(0) + 2); },
                   "has a vertex twice"},
        TileDamage{
            "order",
            [](OpenGlb& g) { std::swap_ranges(g.indices(0), g.indices(0) + 6, g.indices(0) + 6); },
            "out of order"},
        TileDamage{"no_ghost_corner",
                   [](OpenGlb& g) {
                     for (unsigned c = 0; c < 3; ++c)
                       store_u16(g.indices(1) + 2 * c, c);
                   },
                   "border triangle 0 has 3 own corners"},
        TileDamage{"boundary", [](OpenGlb& g) { g.extension()["rimCount"] = 0; },
                   "0 of them on the boundary"},
        TileDamage{"parent_map", [](OpenGlb& g) { store_u16(g.view("parentMap") + 2, 32768); },
                   "parent map entry 1 is 32768"},
        TileDamage{"neighbour", [](OpenGlb& g) { store_u32(g.view("neighbours"), 77); },
                   "neighbour 0 is tile 77"},
        TileDamage{"neighbour_of_itself", [](OpenGlb& g) { store_u32(g.view("neighbours"), 4); },
                   "neighbour 0 is tile 4"},
        TileDamage{"ghost_start", [](OpenGlb& g) { store_u32(g.view("ghostStarts") + 4, 0); },
                   "of neighbour 0 are not a run"},
        TileDamage{"ghost_end",
                   [](OpenGlb& g) { store_u32(g.view("ghostStarts") + 4, 4000000000U); },
                   "of neighbour 0 are not a run"},
        TileDamage{"chain", [](OpenGlb& g) { store_u16(g.view("ghostChains"), 40000); },
                   "ghost chain entry 0 is 40000"},
        TileDamage{"ghost_order", [](OpenGlb& g) { store_u16(g.view("ghostChains"), 32767); },
                   "do not ascend"}),
    [](const auto& test) { return std::string(test.param.name); });

/// The first copy of a vertex, as index.
unsigned first_copy_of(OpenGlb& glb, unsigned vertex) {
  const auto count = glb.extension()["copyCount"].get<unsigned>();
  const unsigned places =
      glb.extension()["ownCount"].get<unsigned>() + glb.extension()["ghostCount"].get<unsigned>();
  for (unsigned i = 0; i < count; ++i) {
    if (load_u16(glb.view("copyOf") + 2 * i) == vertex)
      return places + i;
  }
  ADD_FAILURE() << "vertex " << vertex << " has no copy";
  return places;
}

/// One change to a good file with copies, of a partition.
class DamagedCopies : public testing::TestWithParam<TileDamage> {};

TEST_P(DamagedCopies, SANITIZED_AreRefusedByName) {
  const SampleHierarchy sample = with_copies(full_sample());
  const PublishedTile& tile = sample.tiles.back();
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  ASSERT_EQ(decode_failure(bytes, tile.node, sample), "");
  OpenGlb glb(bytes);
  GetParam().apply(glb);
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, DamagedCopies,
    testing::Values(
        TileDamage{"no_count", [](OpenGlb& g) { g.extension().erase("copyCount"); },
                   "\"copyCount\" is missing"},
        TileDamage{"negative_count", [](OpenGlb& g) { g.extension()["copyCount"] = -1; },
                   "\"copyCount\" is -1"},
        TileDamage{"one_less",
                   [](OpenGlb& g) {
                     g.extension()["copyCount"] = g.extension()["copyCount"].get<int>() - 1;
                   },
                   "the BIN chunk has"},
        TileDamage{"huge_count", [](OpenGlb& g) { g.extension()["copyCount"] = 4294967295U; },
                   "expected less than 2^32"},
        TileDamage{"no_view", [](OpenGlb& g) { g.extension()["copyOf"] = -1; }, "/copyOf"},
        TileDamage{"of_a_copy",
                   [](OpenGlb& g) {
                     const auto last = g.extension()["copyCount"].get<unsigned>() - 1;
                     store_u16(g.view("copyOf") + 2 * last, first_copy_of(g, 1));
                   },
                   "expected one of the first"},
        TileDamage{"of_none", [](OpenGlb& g) { store_u16(g.view("copyOf"), 65535); },
                   "copy 0 is of vertex 65535"},
        TileDamage{"order", [](OpenGlb& g) { store_u16(g.view("copyOf") + 2, 0); },
                   "copy 1 is of vertex 0, expected one of the first"},
        TileDamage{"elsewhere",
                   [](OpenGlb& g) {
                     const unsigned copy = first_copy_of(g, 1);
                     std::copy_n(g.attribute("POSITION"), 12, g.attribute("POSITION") + 12 * copy);
                   },
                   "copy 0 does not lie where its vertex 1 does"},
        TileDamage{
            "position",
            [](OpenGlb& g) { store_nan(g.attribute("POSITION") + 12 * first_copy_of(g, 2)); },
            "is not finite"},
        TileDamage{"same_copy_twice",
                   [](OpenGlb& g) {
                     const unsigned copy = first_copy_of(g, 2);
                     store_triangle(g.indices(0), {0, copy, copy});
                   },
                   "interior triangle 0 (0, "},
        TileDamage{"index_behind_the_copies",
                   [](OpenGlb& g) {
                     const auto count = g.extension()["copyCount"].get<unsigned>();
                     store_u16(g.indices(0), first_copy_of(g, 1) + count);
                   },
                   "is not below the"},
        TileDamage{"turned",
                   [](OpenGlb& g) {
                     store_triangle(g.indices(0), {first_copy_of(g, 1), 0, 1});
                   },
                   "interior triangle 0 (1, 0, 1) is turned or out of order"},
        TileDamage{"turned_wedges",
                   [](OpenGlb& g) {
                     store_triangle(g.indices(0), {first_copy_of(g, 1), 2, 1});
                   },
                   "interior triangle 0 (1, 2, 1) is turned or out of order"},
        TileDamage{"order_of_wedges",
                   [](OpenGlb& g) {
                     store_triangle(g.indices(0), {0, 1, first_copy_of(g, 2) + 1});
                     store_triangle(g.indices(0) + 6, {0, 1, first_copy_of(g, 2)});
                   },
                   "interior triangle 1 (0, 1, 2) is turned or out of order"},
        TileDamage{"copy_of_a_ghost_inside",
                   [](OpenGlb& g) {
                     const auto count = g.extension()["copyCount"].get<unsigned>();
                     store_triangle(g.indices(0), {0, 1, first_copy_of(g, 1) + count - 1});
                   },
                   "interior triangle 0 has 2 own corners"},
        TileDamage{"copy_behind_the_boundary",
                   [](OpenGlb& g) {
                     auto inner = g.extension()["rimCount"].get<unsigned>();
                     while (inner % 4 == 0)
                       ++inner;
                     const auto own = g.extension()["ownCount"].get<unsigned>();
                     store_triangle(g.indices(1), {0, first_copy_of(g, inner), own});
                   },
                   "border triangle 0 has 2 own corners, 1 of them on the boundary"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(TileGlb, SANITIZED_APlaceTwiceInATriangleIsRefusedAboveThePartitions) {
  const SampleHierarchy sample = with_copies(full_sample());
  const PublishedTile& root = sample.tiles.front();
  OpenGlb glb(encode_tile(root, sample.tree, sample.format));
  store_triangle(glb.indices(0), {0, 1, first_copy_of(glb, 1)});
  EXPECT_THAT(decode_failure(glb.close(), root.node, sample),
              HasSubstr("interior triangle 0 (0, 1, 1) has a place twice, above the partitions"));
}

TEST(TileGlb, SANITIZED_AQuantizedCopyElsewhereIsRefused) {
  for (const int bits : {12, 20}) {
    const SampleHierarchy sample = quantized(with_copies(make_sample(torus(200), 3)), bits);
    const PublishedTile& tile = sample.tiles.back();
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    const std::size_t stride = bits <= 16 ? 8 : 12;
    std::copy_n(glb.attribute("POSITION"), stride,
                glb.attribute("POSITION") + stride * first_copy_of(glb, 1));
    EXPECT_THAT(decode_failure(glb.close(), tile.node, sample),
                HasSubstr("copy 0 does not lie where its vertex 1 does"));
  }
}

TEST(TileGlb, SANITIZED_RandomFlipsInTilesWithCopiesAreRefusedOrHarmless) {
  const SampleHierarchy sample = with_copies(full_sample());
  std::mt19937 random(11);
  std::size_t refused = 0;
  for (int round = 0; round < 3000; ++round) {
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    try {
      expect_consistent(decode_tile(bytes, tile.node, sample.tree, sample.format, kTileName),
                        sample.tree);
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.code(), ErrorCode::corrupt);
    }
  }
  EXPECT_GT(refused, 1000U);
}

TEST(TileGlb, AChainThroughAnEarlyNodeKeepsTheNumber) {
  // The last one of three partitions is the whole second half: it has no parent tile.
  const SampleHierarchy sample = make_sample(torus(200), 3);
  const PublishedTile& tile = sample.tile({Level{2}, 0});
  ASSERT_EQ(tile.mesh.ghosts.back().tile, 2U);
  OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
  const std::size_t entries = glb.extension()["chainEntryCount"].get<std::size_t>();
  store_u16(glb.view("ghostChains") + 2 * (entries - 1), 32000);
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample), HasSubstr("without a parent tile"));
}

TEST(TileGlb, SANITIZED_DeepJsonIsRefused) {
  const SampleHierarchy sample = make_sample(torus(100), 2);
  const std::string deep = std::string(30000, '[') + std::string(30000, ']');
  EXPECT_THAT(decode_failure(storage::join_glb(deep, {}), {}, sample), HasSubstr("nested deeper"));
  const std::string open(60000, '{');
  EXPECT_THAT(decode_failure(storage::join_glb(open, {}), {}, sample), HasSubstr("not valid JSON"));
  const std::string large(70000, ' ');
  EXPECT_THAT(decode_failure(storage::join_glb(large, {}), {}, sample),
              HasSubstr("JSON chunk has"));
}

TEST(TileGlb, SANITIZED_JsonOfThousandsOfKeysIsRefused) {
  const SampleHierarchy sample = make_sample(torus(100), 2);
  std::string keys = "{\"a\":0";
  for (int i = 0; i < 5000; ++i)
    keys += ",\"" + std::to_string(i) + "\":0";
  EXPECT_THAT(decode_failure(storage::join_glb(keys + "}", {}), {}, sample),
              HasSubstr("more than 4096"));
}

TEST(TileGlb, WhatIsQuotedFromBrokenJsonIsShortAndPlain) {
  const SampleHierarchy sample = make_sample(torus(100), 2);
  for (const std::string& json : {std::string("{\x7f\x1b"), '"' + std::string(60000, 'x')}) {
    const std::string message = decode_failure(storage::join_glb(json, {}), {}, sample);
    EXPECT_LT(message.size(), 300U);
    EXPECT_EQ(message.find_first_of("\x1b\x7f"), std::string::npos) << message;
  }
}

TEST(TileGlb, SANITIZED_ForeignFilesAreRefused) {
  const SampleHierarchy sample = make_sample(torus(100), 2);
  Bytes bytes = encode_tile(sample.tiles[0], sample.tree, sample.format);
  Bytes ply{std::byte{'p'}, std::byte{'l'}, std::byte{'y'}};
  EXPECT_THAT(decode_failure(ply, {}, sample), HasSubstr("expected at least 12"));
  Bytes magic = bytes;
  magic[0] = std::byte{'G'};
  EXPECT_THAT(decode_failure(magic, {}, sample), HasSubstr("(glTF)"));
  Bytes version = bytes;
  version[4] = std::byte{1};
  EXPECT_THAT(decode_failure(version, {}, sample), HasSubstr("GLB version"));
  Bytes chunk = bytes;
  chunk[16] = std::byte{0};
  EXPECT_THAT(decode_failure(chunk, {}, sample), HasSubstr("chunk type at byte 16"));
}

}  // namespace
}  // namespace meshhier::tests

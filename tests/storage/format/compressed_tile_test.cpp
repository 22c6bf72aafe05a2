// Compressed and quantized tiles: the same meshes as the plain ones, and nothing that crashes.
#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "storage/format/glb.h"
#include "storage/format/gzip.h"
#include "storage/format/meshopt_codec.h"
#include "storage/format/tile_glb.h"
#include "storage/format/tile_pack.h"
#include "support/decode_failure.h"
#include "support/same_tile.h"
#include "tests/support/share.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace meshhier::tests {
namespace {

using storage::Compression;
using storage::decode_tile;
using storage::encode_tile;
using storage::TileFormat;
using testing::HasSubstr;
using testing::StartsWith;
using Bytes = std::vector<std::byte>;
using Json = nlohmann::ordered_json;

constexpr std::array kCompressed{storage::Compression::zlib, storage::Compression::meshopt,
                                 storage::Compression::meshopt_zlib};

void expect_same(const PublishedTile& a, const PublishedTile& b) {
  expect_same_mesh(a, b);
  expect_same_attributes(a, b);
}

/// Every tile, compressed in each way, is read as its plain twin is, and written again the same.
void expect_twins(const SampleHierarchy& sample) {
  for (const PublishedTile& tile : sample.tiles) {
    TileFormat format = sample.format;
    const PublishedTile plain = decode_tile(encode_tile(tile, sample.tree, format), tile.node,
                                            sample.tree, format, kTileName);
    for (const storage::Compression compression : kCompressed) {
      format.compression = compression;
      const Bytes bytes = encode_tile(tile, sample.tree, format);
      const PublishedTile back = decode_tile(bytes, tile.node, sample.tree, format, kTileName);
      expect_same(back, plain);
      EXPECT_EQ(encode_tile(back, sample.tree, format), bytes);
    }
  }
}

SampleHierarchy full_sample(storage::Compression compression) {
  const AttributeLayout layout{.normals = true, .colour = ColourType::u8, .texcoords = true};
  return make_sample(torus(200, 0.05F), 5, {layout, {1.5, 0, -1e7}, compression, {}});
}

TEST(CompressedTile, IsReadAsItsPlainTwinForAnyLayoutAndTree) {
  for (const AttributeLayout& layout : sample_layouts()) {
    for (const std::uint32_t partitions : {1U, 3U, 8U})
      expect_twins(make_sample(torus(250, 0.05F), partitions, {layout, {}}));
  }
}

TEST(CompressedTile, IsReadAsItsPlainTwinForMeshesOfEveryKind) {
  const std::vector<TestMesh> meshes{open_grid(9, 9), non_manifold(150), soup(60),
                                     duplicates(120), points(40),        points(3)};
  for (const TestMesh& mesh : meshes)
    expect_twins(make_sample(mesh, 3));
}

TEST(CompressedTile, QuantizedOnesAreTwinsToo) {
  for (const int bits : {8, 12, 16, 17, 24}) {
    expect_twins(quantized(make_sample(torus(250, 0.05F), 5), bits));
    expect_twins(quantized(make_sample(points(30), 2), bits));
  }
}

TEST(CompressedTile, WithCopiesOnesAreTwinsToo) {
  for (const AttributeLayout& layout : sample_layouts()) {
    for (const std::uint32_t partitions : {1U, 3U, 8U})
      expect_twins(with_copies(make_sample(torus(250, 0.05F), partitions, {layout, {}})));
  }
  for (const int bits : {8, 12, 16, 17, 24})
    expect_twins(quantized(with_copies(make_sample(open_grid(9, 9), 5)), bits));
  expect_twins(with_copies(make_sample(points(40), 3)));
}

TEST(CompressedTile, KeepsEveryBitOfAwkwardNumbers) {
  const std::array values{
      std::numeric_limits<float>::quiet_NaN(),  std::bit_cast<float>(0xFFC12345U),
      -std::numeric_limits<float>::infinity(),  -0.0F,
      std::numeric_limits<float>::denorm_min(), -7.5F};
  const AttributeLayout layout{
      .normals = true, .colour = ColourType::f32, .alpha = true, .texcoords = true};
  SampleHierarchy sample = make_sample(torus(200), 3, {layout, {}});
  std::mt19937 random(1);
  for (PublishedTile& tile : sample.tiles) {
    if (!sample.tree.is_partition(tile.node))
      continue;
    for (float& value : tile.mesh.vertices.attributes)
      value = values[random() % values.size()];
    tile.mesh.vertices.positions[0] = {-0.0F, std::numeric_limits<float>::denorm_min(), 3e38F};
  }
  expect_twins(sample);
}

TEST(CompressedTile, IsSmaller) {
  for (const storage::Compression compression : kCompressed) {
    SampleHierarchy sample = make_sample(torus(20000), 4);
    const PublishedTile& tile = sample.tiles.back();
    const std::size_t plain = encode_tile(tile, sample.tree, sample.format).size();
    sample.format.compression = compression;
    EXPECT_LT(encode_tile(tile, sample.tree, sample.format).size(), plain * 4 / 5);
  }
}

TEST(CompressedTile, TheJsonNamesTheExtensionsThatViewersNeed) {
  const auto json_of = [](const SampleHierarchy& sample) {
    const Bytes bytes = encode_tile(sample.tiles[0], sample.tree, sample.format);
    return Json::parse(storage::split_glb(bytes, kTileName).json);
  };
  SampleHierarchy sample = quantized(make_sample(torus(100), 1), 12);
  EXPECT_EQ(json_of(sample)["extensionsRequired"].dump(), R"(["KHR_mesh_quantization"])");
  EXPECT_EQ(json_of(sample)["nodes"][0]["scale"].size(), 3U);
  sample.format.compression = storage::Compression::meshopt;
  const Json json = json_of(sample);
  EXPECT_EQ(json["extensionsRequired"].dump(),
            R"(["EXT_meshopt_compression","KHR_mesh_quantization"])");
  EXPECT_EQ(json["buffers"][1]["extensions"].dump(),
            R"({"EXT_meshopt_compression":{"fallback":true}})");
  const Json& view = json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  EXPECT_EQ(view["mode"], "ATTRIBUTES");
  EXPECT_EQ(view["byteStride"], 8);
  EXPECT_FALSE(view.contains("filter"));
  SampleHierarchy fine = quantized(make_sample(torus(100), 1), 20);
  EXPECT_FALSE(json_of(fine).contains("extensionsRequired"));
  fine.format.compression = storage::Compression::meshopt;
  EXPECT_EQ(json_of(fine)["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"],
            "EXPONENTIAL");
}

TEST(CompressedTile, SANITIZED_PositionsOffTheLatticeAreRefused) {
  SampleHierarchy sample = quantized(make_sample(torus(100), 1), 20);
  const Bytes bytes = encode_tile(sample.tiles[0], sample.tree, sample.format);
  EXPECT_EQ(decode_failure(bytes, sample.tiles[0].node, sample), "");
  sample.format.lattice->step *= 4;
  sample.format.lattice->corner = {};
  EXPECT_THAT(decode_failure(bytes, sample.tiles[0].node, sample), HasSubstr("not on the lattice"));
}

TEST(CompressedTile, SANITIZED_AnotherCompressionThanTheHierarchysIsRefused) {
  std::vector<storage::Compression> all{storage::Compression::none};
  all.insert(all.end(), kCompressed.begin(), kCompressed.end());
  for (const storage::Compression written : all) {
    for (const storage::Compression read : all) {
      SampleHierarchy sample = full_sample(written);
      const Bytes bytes = encode_tile(sample.tiles[0], sample.tree, sample.format);
      sample.format.compression = read;
      EXPECT_EQ(decode_failure(bytes, sample.tiles[0].node, sample).empty(), written == read);
    }
  }
}

TEST(CompressedTile, SANITIZED_TruncationAtEveryByteIsRefused) {
  for (const storage::Compression compression : kCompressed) {
    const SampleHierarchy sample = make_sample(torus(100), 3, {{}, {}, compression, {}});
    const PublishedTile& tile = sample.tiles.back();
    const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_NE(decode_failure(cut, tile.node, sample), "") << size;
    }
  }
}

TEST(CompressedTile, SANITIZED_RandomFlipsInTheSectionsAreRefusedOrHarmless) {
  const SampleHierarchy sample = full_sample(storage::Compression::meshopt);
  std::size_t refused = 0;
  for (std::size_t round = share().index; round < 4000; round += share().count) {
    std::mt19937 random(7'000 + static_cast<std::uint32_t>(round));
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    const std::size_t bin = storage::split_glb(bytes, kTileName).bin.size();
    for (std::size_t i = 0; i <= random() % 3; ++i)
      bytes[bytes.size() - 1 - random() % bin] ^= static_cast<std::byte>(1U << random() % 8);
    refused += decode_failure(bytes, tile.node, sample).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, share().part_of(4000) / 4);
}

TEST(CompressedTile, SANITIZED_RandomFlipsInSectionsWithCopiesAreRefusedOrHarmless) {
  const SampleHierarchy sample = with_copies(full_sample(storage::Compression::meshopt));
  std::size_t refused = 0;
  for (std::size_t round = share().index; round < 4000; round += share().count) {
    std::mt19937 random(9'000 + static_cast<std::uint32_t>(round));
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    Bytes bytes = encode_tile(tile, sample.tree, sample.format);
    const std::size_t bin = storage::split_glb(bytes, kTileName).bin.size();
    bytes[bytes.size() - 1 - random() % bin] ^= static_cast<std::byte>(1U << random() % 8);
    refused += decode_failure(bytes, tile.node, sample).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, share().part_of(4000) / 4);
}

TEST(CompressedTile, SANITIZED_RandomNumbersInTheJsonAreRefused) {
  for (const storage::Compression compression :
       {storage::Compression::meshopt, storage::Compression::meshopt_zlib}) {
    SampleHierarchy sample = quantized(full_sample(compression), 14);
    const TileFormat inner{sample.format.attributes, sample.format.frame,
                           storage::Compression::meshopt, sample.format.lattice};
    const std::array<Json, 7> values{-1, 0, 3, 4294967295U, 1e300, "x", Json::array()};
    for (std::size_t round = share().index; round < 1000; round += share().count) {
      std::mt19937 random(8'000 + static_cast<std::uint32_t>(round));
      const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
      const Bytes bytes = encode_tile(tile, sample.tree, inner);
      const storage::GlbView glb = storage::split_glb(bytes, kTileName);
      Json json = Json::parse(glb.json);
      const Json flat = json.flatten();
      auto place = flat.begin();
      std::advance(place, static_cast<std::ptrdiff_t>(random() % flat.size()));
      const Json& value = values[random() % values.size()];
      const bool same = place.value() == value;
      json[Json::json_pointer(place.key())] = value;
      Bytes changed = storage::join_glb(json.dump(), glb.bin);
      if (storage::row_of(compression).pack_file != nullptr)
        changed = storage::gzip(changed);
      EXPECT_EQ(decode_failure(changed, tile.node, sample).empty(), same) << place.key() << value;
    }
  }
}

/// One change to the JSON of a good compressed tile, and what is said of it.
struct PackedDamage {
  const char* name;
  std::function<void(Json&)> apply;
  const char* message;
};

TEST(CompressedTile, SANITIZED_LyingSizesAreRefusedByName) {
  const auto view = [](Json& json, int number) -> Json& {
    return json["bufferViews"][number]["extensions"]["EXT_meshopt_compression"];
  };
  const std::vector<PackedDamage> damages{
      {"no extension", [&](Json& j) { j["bufferViews"][0].erase("extensions"); },
       "\"byteLength\" is missing"},
      {"longer", [&](Json& j) { view(j, 0)["byteLength"] = 4000000000U; }, "expected an integer"},
      {"shorter", [&](Json& j) { view(j, 0)["byteLength"] = 1; }, "cannot come from 1 compressed"},
      {"a little shorter",
       [&](Json& j) { view(j, 0)["byteLength"] = view(j, 0)["byteLength"].get<int>() - 4; },
       "the BIN chunk has"},
      {"many triangles",
       [&](Json& j) { j["extensions"]["MESHHIER_tile"]["interiorCount"] = 1000000000U; },
       "interior of 6000000000 bytes cannot come from"},
      {"many ghosts",
       [&](Json& j) { j["extensions"]["MESHHIER_tile"]["ghostCount"] = 4000000000U; },
       "cannot come from"},
      {"many copies", [&](Json& j) { j["extensions"]["MESHHIER_tile"]["copyCount"] = 4000000000U; },
       "cannot come from"},
      {"so many copies that numbers end",
       [&](Json& j) { j["extensions"]["MESHHIER_tile"]["copyCount"] = 4294967295U; },
       "expected less than 2^32"},
      {"many chains",
       [&](Json& j) { j["extensions"]["MESHHIER_tile"]["chainEntryCount"] = 4294967295U; },
       "ghostChains of 8589934590 bytes cannot come from"},
      {"filter", [&](Json& j) { view(j, 0)["filter"] = "EXPONENTIAL"; }, "JSON: /accessors/0/"},
      {"other mode", [&](Json& j) { view(j, 0)["mode"] = "TRIANGLES"; }, "/mode is"},
      {"other buffer", [&](Json& j) { view(j, 0)["buffer"] = 1; }, "/buffer is"},
      {"no fallback", [&](Json& j) { j["buffers"].erase(1); }, "buffers"},
      {"not required", [&](Json& j) { j.erase("extensionsRequired"); }, "extensionsRequired"}};
  const SampleHierarchy sample =
      make_sample(torus(200, 0.05F), 3, {{}, {}, storage::Compression::meshopt, {}});
  const PublishedTile& tile = sample.tiles.back();
  const Bytes bytes = encode_tile(tile, sample.tree, sample.format);
  const storage::GlbView glb = storage::split_glb(bytes, kTileName);
  for (const PackedDamage& damage : damages) {
    Json json = Json::parse(glb.json);
    damage.apply(json);
    EXPECT_THAT(decode_failure(storage::join_glb(json.dump(), glb.bin), tile.node, sample),
                HasSubstr(damage.message))
        << damage.name;
  }
}

TEST(MeshoptCodec, TheFilterIsForPositionsThatComeBackBitForBit) {
  const auto filtered = [](std::vector<float> values) {
    Bytes bytes(values.size() * sizeof(float));
    storage::store_all_little(std::span<const float>(values), bytes.data());
    const Bytes before = bytes;
    const bool done = storage::try_filter_positions(bytes);
    EXPECT_EQ(done, bytes != before);
    if (done) {
      EXPECT_TRUE(storage::unfilter_positions(bytes));
    }
    EXPECT_EQ(bytes, before);
    return done;
  };
  EXPECT_TRUE(filtered({1, 2, 3, 4, 5, -6.5F}));
  EXPECT_TRUE(filtered({8388607, -8388607, 0.25F}));
  EXPECT_FALSE(filtered({8388608, -1, 1, 1, 1, 1}));  // 24 bits and a sign
  EXPECT_FALSE(filtered({0.1F, 1, 1, 100, 1, 1}));
  EXPECT_FALSE(filtered({-0.0F, 1, 1}));
  EXPECT_FALSE(filtered({1e-38F, 1, 1}));
  EXPECT_TRUE(filtered({0, 0, 1}));
  for (const float odd :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()})
    EXPECT_FALSE(filtered({1, odd, 1}));
}

TEST(MeshoptCodec, SANITIZED_ExponentsThatDecodersDifferOnAreRefused) {
  const auto is_read = [](int exponent) {
    Bytes bytes(12);
    storage::store_little(static_cast<std::uint32_t>(exponent) << 24 | 1U, bytes.data());
    return storage::unfilter_positions(bytes);
  };
  EXPECT_TRUE(is_read(100));
  EXPECT_TRUE(is_read(-100));
  EXPECT_FALSE(is_read(101));
  EXPECT_FALSE(is_read(-101));
}

/// The triangles in the order that is made, and as they were: both sorted.
void expect_same_triangles(const std::vector<std::uint32_t>& corners, std::size_t vertex_count) {
  const auto sorted = [](const std::vector<std::uint32_t>& list) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i < list.size(); i += 3)
      triangles.push_back({list[i], list[i + 1], list[i + 2]});
    std::ranges::sort(triangles);
    return triangles;
  };
  EXPECT_EQ(sorted(storage::vertex_cache_order(corners, vertex_count)), sorted(corners));
}

// A million triangles, each looked at for each, would take hours.

TEST(VertexCacheOrderTest, SLOW_AMillionCopiesOfATriangleAreOrdered) {
  std::vector<std::uint32_t> corners;
  for (int i = 0; i < 1'000'000; ++i)
    corners.insert(corners.end(), {0, 1, 2});
  expect_same_triangles(corners, 3);
}

TEST(VertexCacheOrderTest, SLOW_AMillionTrianglesAroundOneVertexAreOrdered) {
  constexpr std::uint32_t kCount = 1'000'000;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < kCount; ++i)
    corners.insert(corners.end(), {0, 1 + i, 1 + (i + 1) % kCount});
  expect_same_triangles(corners, kCount + 1);
}

TEST(VertexCacheOrderTest, SLOW_AMillionTrianglesBetweenTwoHundredVerticesAreOrdered) {
  constexpr std::uint32_t kVertices = 200;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t a = 0; a < kVertices; ++a) {
    for (std::uint32_t b = a + 1; b < kVertices; ++b) {
      for (std::uint32_t c = b + 1; c < kVertices; ++c)
        corners.insert(corners.end(), {a, b, c});
    }
  }
  expect_same_triangles(corners, kVertices);
}

}  // namespace
}  // namespace meshhier::tests

// Computed normals in tiles: what is written is read, and nothing else is.
#include "base/error.h"
#include "gltf/sample_hierarchy.h"
#include "hierarchy/vertex_numbers.h"
#include "storage/format/tile_glb.h"
#include "support/decode_failure.h"
#include "support/open_glb.h"
#include "support/same_tile.h"
#include "tests/support/share.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace meshhier::tests {
namespace {

using storage::Compression;
using storage::encode_tile;
using storage::TileFormat;
using testing::HasSubstr;

PublishedTile read_shaded(const std::vector<std::byte>& bytes, NodeId node,
                          const SampleHierarchy& sample) {
  return storage::decode_tile(bytes, node, sample.tree, sample.format, "shaded.glb");
}

/// Returns samples of any layout, tree, lattice and kind of mesh, with copies and without.
std::vector<SampleHierarchy> shaded_samples() {
  std::vector<SampleHierarchy> samples;
  for (const AttributeLayout& layout : sample_layouts_without_normals()) {
    for (const std::uint32_t partitions : {1U, 3U, 8U}) {
      const SampleHierarchy sample = make_sample(torus(250, 0.05F), partitions, {layout, {}});
      samples.push_back(shaded(sample));
      samples.push_back(shaded(with_copies(sample)));
    }
  }
  for (const int bits : {8, 16, 20})
    samples.push_back(shaded(quantized(with_copies(make_sample(open_grid(9, 9), 5)), bits)));
  for (const TestMesh& mesh : {non_manifold(150), soup(60), duplicates(120), points(40), points(3)})
    samples.push_back(shaded(make_sample(mesh, 3)));
  return samples;
}

/// A tile with copies and splits of own vertices, of ghosts, and of copies of both.
SampleHierarchy full_shaded(Compression compression = Compression::none) {
  const AttributeLayout layout{.colour = ColourType::u8, .texcoords = true};
  return shaded(
      with_copies(make_sample(torus(200, 0.05F), 5, {layout, {1.5, 0, -1e7}, compression})));
}

/// Checks the promises of Shading beside a mesh.
void expect_shades(const Shading& shading, const TileMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size() + mesh.copies.size();
  ASSERT_EQ(shading.normals.size(), vertices + shading.split_of.size());
  ASSERT_TRUE(std::is_sorted(shading.split_of.begin(), shading.split_of.end()));
  ASSERT_TRUE(std::ranges::all_of(shading.normals, is_normal_code));
  const bool split = !shading.split_of.empty();
  const VertexNumbers numbers(static_cast<std::uint32_t>(mesh.vertices.size()), mesh.copies.places);
  const auto expect_triangles = [&](std::vector<TileTriangle> shaded,
                                    const std::vector<TileTriangle>& triangles,
                                    const std::vector<CornerWedges>& wedges) {
    for (TileTriangle& t : shaded) {
      for (TileVertex& v : t) {
        ASSERT_LT(raw(v), shading.normals.size());
        if (raw(v) >= vertices)
          v = static_cast<TileVertex>(shading.split_of[raw(v) - vertices]);
      }
    }
    ASSERT_EQ(shaded, split ? numbers.numbered(triangles, wedges) : shaded);
    ASSERT_EQ(shaded.size(), split ? triangles.size() : 0);
  };
  expect_triangles(shading.interior, mesh.interior, mesh.interior_wedges);
  expect_triangles(shading.border, mesh.border, mesh.border_wedges);
}

TEST(TileNormals, ComeBackHoweverTilesArePacked) {
  std::size_t splits = 0;
  for (SampleHierarchy& sample : shaded_samples()) {
    for (const Compression compression :
         {Compression::none, Compression::zlib, Compression::meshopt, Compression::meshopt_zlib}) {
      sample.format.compression = compression;
      for (const PublishedTile& tile : sample.tiles) {
        const auto bytes = encode_tile(tile, sample.tree, sample.format);
        const PublishedTile back = read_shaded(bytes, tile.node, sample);
        expect_same_mesh(tile, back);
        expect_shades(back.shading, back.mesh);
        EXPECT_EQ(encode_tile(back, sample.tree, sample.format), bytes);
        splits += back.shading.split_of.size();
      }
    }
  }
  EXPECT_GT(splits, 10000U);
}

TEST(TileNormals, DoNotChangeTheMesh) {
  for (const SampleHierarchy& sample : shaded_samples()) {
    SampleHierarchy plain = sample;
    plain.format.computed_normals = false;
    for (PublishedTile tile : sample.tiles) {
      const PublishedTile back =
          read_shaded(encode_tile(tile, sample.tree, sample.format), tile.node, sample);
      tile.shading = {};
      PublishedTile other =
          read_shaded(encode_tile(tile, plain.tree, plain.format), tile.node, plain);
      other.shading = back.shading;
      expect_same_mesh(other, back);
      expect_same_attributes(other, back);
    }
  }
}

TEST(TileNormals, RawAttributesOfSplitVerticesAreKept) {
  SampleHierarchy sample = shaded(make_sample(torus(200), 3, {{.texcoords = true}, {}}));
  PublishedTile& tile = sample.tiles.back();
  tile.mesh.vertices.attributes[2 * tile.shading.split_of.front()] =
      std::numeric_limits<float>::quiet_NaN();
  const auto bytes = encode_tile(tile, sample.tree, sample.format);
  EXPECT_NE(OpenGlb(bytes).extension()["rawTexcoords"], -1);
  expect_same_attributes(tile, read_shaded(bytes, tile.node, sample));
}

TEST(TileNormals, AreQuantizedAttributes) {
  const auto required = [](const SampleHierarchy& sample) {
    OpenGlb glb(encode_tile(sample.tiles.back(), sample.tree, sample.format));
    nlohmann::ordered_json names = glb.json["extensionsRequired"];
    names.push_back("MESHHIER_tile");
    EXPECT_EQ(glb.json["extensionsUsed"], names);
    return glb.json["extensionsRequired"].dump();
  };
  const SampleHierarchy sample = make_sample(torus(100), 2);
  EXPECT_EQ(required(shaded(sample)), R"(["KHR_mesh_quantization"])");
  EXPECT_EQ(required(shaded(quantized(sample, 12))), R"(["KHR_mesh_quantization"])");
  SampleHierarchy packed = shaded(quantized(sample, 20));
  packed.format.compression = Compression::meshopt;
  EXPECT_EQ(required(packed), R"(["EXT_meshopt_compression","KHR_mesh_quantization"])");
}

TEST(TileNormals, TakeFourBytesEach) {
  const SampleHierarchy sample = shaded(make_sample(torus(100), 2));
  OpenGlb glb(encode_tile(sample.tiles.back(), sample.tree, sample.format));
  const Shading& shading = sample.tiles.back().shading;
  const int view = glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"];
  EXPECT_EQ(glb.json["accessors"][view].dump(),
            fmt::format(R"({{"bufferView":{},"componentType":5120,"count":{},"type":"VEC3",)"
                        R"("normalized":true}})",
                        view, shading.normals.size()));
  EXPECT_EQ(glb.json["bufferViews"][view]["byteStride"], 4);
  EXPECT_EQ(glb.json["bufferViews"][view]["byteLength"], 4 * shading.normals.size());
  EXPECT_EQ(glb.extension()["splitCount"], shading.split_of.size());
}

TEST(TileNormals, ManySplitsHaveWideNumbers) {
  // 32,768 vertices of two splits each: their indices need 32 bits, the vertices' numbers do not.
  SampleHierarchy sample{Tree(32768, 1), {}, {}};
  sample.format.computed_normals = true;
  PublishedTile& tile = sample.tiles.emplace_back();
  tile.mesh.own_count = 32768;
  tile.mesh.vertices.positions.resize(tile.mesh.own_count);
  for (std::uint32_t i = 0; i + 2 < tile.mesh.own_count; ++i)
    tile.mesh.interior.push_back({TileVertex{i}, TileVertex{i + 1}, TileVertex{i + 2}});
  tile.shading.normals.assign(3 * std::size_t{tile.mesh.own_count}, kNoDirection);
  for (std::uint32_t i = 0; i < 2 * tile.mesh.own_count; ++i)
    tile.shading.split_of.push_back(i / 2);
  tile.shading.interior = tile.mesh.interior;
  tile.shading.interior[0][1] = TileVertex{32768 + 3};
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    sample.format.compression = compression;
    const auto bytes = encode_tile(tile, sample.tree, sample.format);
    OpenGlb glb(bytes);
    const int indices = glb.json["meshes"][0]["primitives"][0]["indices"];
    EXPECT_EQ(glb.json["accessors"][indices]["componentType"], 5125);
    expect_same_mesh(tile, read_shaded(bytes, tile.node, sample));
  }
}

TEST(TileNormals, SANITIZED_MoreSplitsThanCornersAreRefused) {
  SampleHierarchy sample{Tree(3, 1), {}, {}};
  sample.format.computed_normals = true;
  PublishedTile& tile = sample.tiles.emplace_back();
  tile.mesh.own_count = 3;
  tile.mesh.vertices.positions.resize(3);
  tile.mesh.interior = tile.shading.interior = {{TileVertex{0}, TileVertex{1}, TileVertex{2}}};
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    sample.format.compression = compression;
    for (const std::size_t splits : {3U, 4U}) {
      tile.shading.split_of.assign(splits, 2);
      tile.shading.normals.assign(3 + splits, kNoDirection);
      const auto bytes = encode_tile(tile, sample.tree, sample.format);
      const std::string failure = decode_failure(bytes, tile.node, sample);
      EXPECT_THAT(failure,
                  splits > 3 ? HasSubstr("more splits than corners of triangles") : HasSubstr(""));
      EXPECT_EQ(failure.empty(), splits <= 3);
    }
  }
}

TEST(TileNormals, AHierarchyHasThemInAllTilesOrInNone) {
  SampleHierarchy with = shaded(make_sample(torus(100), 2));
  SampleHierarchy without = make_sample(torus(100), 2);
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    with.format.compression = without.format.compression = compression;
    for (std::size_t i = 0; i < with.tiles.size(); ++i) {
      const NodeId node = with.tiles[i].node;
      const auto shaded_bytes = encode_tile(with.tiles[i], with.tree, with.format);
      const auto bytes = encode_tile(without.tiles[i], without.tree, without.format);
      EXPECT_NE(decode_failure(shaded_bytes, node, without), "");
      EXPECT_THAT(decode_failure(bytes, node, with), HasSubstr("\"splitCount\" is missing"));
    }
  }
}

// ---- damage

unsigned number_at(OpenGlb& glb, const char* key) {
  return glb.extension()[key].get<unsigned>();
}
unsigned vertex_count(OpenGlb& glb) {
  return number_at(glb, "ownCount") + number_at(glb, "ghostCount") + number_at(glb, "copyCount");
}
/// Returns the vertex of which the first split is.
unsigned first_split(OpenGlb& glb) {
  return load_u16(glb.view("splitOf"));
}
std::byte* normal_at(OpenGlb& glb, unsigned vertex) {
  return glb.attribute("NORMAL") + 4 * std::size_t{vertex};
}
void store_normal(std::byte* at, std::array<int, 4> code) {
  std::ranges::transform(code, at, [](int value) { return static_cast<std::byte>(value); });
}

/// One change to a good file of the last tile of full_shaded(), and what is said of it.
struct NormalDamage {
  const char* name;
  std::function<void(OpenGlb&)> apply;
  const char* message;
};
void PrintTo(const NormalDamage& damage, std::ostream* out) {
  *out << damage.name;
}

class DamagedNormals : public testing::TestWithParam<NormalDamage> {};

TEST_P(DamagedNormals, SANITIZED_AreRefusedByName) {
  const SampleHierarchy sample = full_shaded();
  const PublishedTile& tile = sample.tiles.back();
  const auto bytes = encode_tile(tile, sample.tree, sample.format);
  ASSERT_EQ(decode_failure(bytes, tile.node, sample), "");
  OpenGlb glb(bytes);
  GetParam().apply(glb);
  EXPECT_THAT(decode_failure(glb.close(), tile.node, sample), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, DamagedNormals,
    testing::Values(
        NormalDamage{"no_count", [](OpenGlb& g) { g.extension().erase("splitCount"); },
                     "\"splitCount\" is missing"},
        NormalDamage{
            "one_less",
            [](OpenGlb& g) { g.extension()["splitCount"] = number_at(g, "splitCount") - 1; },
            "the BIN chunk has"},
        NormalDamage{"huge_count", [](OpenGlb& g) { g.extension()["splitCount"] = 4294967295U; },
                     "expected less than 2^32"},
        NormalDamage{"no_view", [](OpenGlb& g) { g.extension()["splitOf"] = -1; }, "/splitOf"},
        NormalDamage{"not_normalized",
                     [](OpenGlb& g) { g.json["accessors"][1].erase("normalized"); },
                     "/accessors/1"},
        NormalDamage{"not_required", [](OpenGlb& g) { g.json.erase("extensionsRequired"); },
                     "extensionsRequired"},
        NormalDamage{"fourth_byte", [](OpenGlb& g) { normal_at(g, 3)[3] = std::byte{1}; },
                     "the normal of vertex 3 is"},
        NormalDamage{"least_number",
                     [](OpenGlb& g) {
                       store_normal(normal_at(g, 0), {-128, 0, 0, 0});
                     },
                     "the normal of vertex 0 is (-128, 0, 0, 0), expected unit length and 0"},
        NormalDamage{"too_short",
                     [](OpenGlb& g) {
                       store_normal(normal_at(g, 0), {126, 0, 0, 0});
                     },
                     "the normal of vertex 0 is (126, 0, 0, 0)"},
        NormalDamage{"too_long",
                     [](OpenGlb& g) {
                       store_normal(normal_at(g, 0), {127, 16, 0, 0});
                     },
                     "the normal of vertex 0 is"},
        NormalDamage{"of_a_split",
                     [](OpenGlb& g) {
                       store_normal(normal_at(g, vertex_count(g)), {0, 0, 0, 0});
                     },
                     "(0, 0, 0, 0)"},
        NormalDamage{"split_of_a_split",
                     [](OpenGlb& g) {
                       store_u16(g.view("splitOf") + 2 * (number_at(g, "splitCount") - 1),
                                 vertex_count(g));
                     },
                     "expected one of the first"},
        NormalDamage{"order", [](OpenGlb& g) { store_u16(g.view("splitOf"), 65535); },
                     "split 0 is of vertex 65535"},
        NormalDamage{
            "elsewhere",
            [](OpenGlb& g) { g.attribute("POSITION")[12 * vertex_count(g)] ^= std::byte{1}; },
            "split 0 has not the POSITION of its vertex"},
        NormalDamage{"other_colour",
                     [](OpenGlb& g) { make_white(&g.attribute("COLOR_0")[8 * vertex_count(g)]); },
                     "split 0 has not the COLOR_0 of its vertex"},
        NormalDamage{
            "other_texcoord",
            [](OpenGlb& g) { g.attribute("TEXCOORD_0")[8 * vertex_count(g)] ^= std::byte{1}; },
            "split 0 has not the TEXCOORD_0 of its vertex"},
        NormalDamage{"index_behind_the_splits",
                     [](OpenGlb& g) {
                       store_u16(g.indices(0), vertex_count(g) + number_at(g, "splitCount"));
                     },
                     "is not below the"},
        NormalDamage{"vertex_with_its_split",
                     [](OpenGlb& g) {
                       store_triangle(g.indices(0), {first_split(g), vertex_count(g), 20});
                     },
                     "has a vertex twice"},
        NormalDamage{"turned",
                     [](OpenGlb& g) {
                       store_triangle(g.indices(0),
                                      {first_split(g) + 2, vertex_count(g), first_split(g) + 1});
                     },
                     "is turned or out of order"},
        NormalDamage{"twins",
                     [](OpenGlb& g) {
                       const unsigned v = first_split(g);
                       store_triangle(g.indices(0), {v, v + 1, v + 2});
                       store_triangle(g.indices(0) + 6, {vertex_count(g), v + 1, v + 2});
                     },
                     "has other splits than the equal one before it"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(TileNormals, SANITIZED_TwinsOfOtherSplitsAreRefusedInPackedTiles) {
  SampleHierarchy sample = full_shaded(Compression::meshopt);
  PublishedTile tile = sample.tiles.back();
  ASSERT_TRUE(sample.tree.is_partition(tile.node));
  const auto vertices =
      static_cast<std::uint32_t>(tile.mesh.vertices.size() + tile.mesh.copies.size());
  const auto split = std::ranges::find_if(
      tile.shading.interior, [&](const TileTriangle& t) { return raw(t[1]) >= vertices; });
  ASSERT_NE(split, tile.shading.interior.end());
  const std::ptrdiff_t t = split - tile.shading.interior.begin();
  TileTriangle other = *split;
  other[1] = static_cast<TileVertex>(tile.shading.split_of[raw(other[1]) - vertices]);
  tile.mesh.interior.insert(tile.mesh.interior.begin() + t, tile.mesh.interior[t]);
  tile.mesh.interior_wedges.insert(tile.mesh.interior_wedges.begin() + t,
                                   tile.mesh.interior_wedges[t]);
  tile.shading.interior.insert(tile.shading.interior.begin() + t, other);
  EXPECT_THAT(decode_failure(encode_tile(tile, sample.tree, sample.format), tile.node, sample),
              HasSubstr("has other splits than the equal one before it"));
}

TEST(TileNormals, SANITIZED_LyingSizesOfPackedTilesAreRefused) {
  const SampleHierarchy sample = full_shaded(Compression::meshopt);
  const PublishedTile& tile = sample.tiles.back();
  const auto bytes = encode_tile(tile, sample.tree, sample.format);
  OpenGlb splits(bytes);
  splits.extension()["splitCount"] = 2000000000U;
  EXPECT_THAT(decode_failure(splits.close(), tile.node, sample),
              HasSubstr("more splits than corners"));
  OpenGlb corners(bytes);
  corners.extension()["splitCount"] =
      3 * (number_at(corners, "interiorCount") + number_at(corners, "borderCount"));
  EXPECT_NE(decode_failure(corners.close(), tile.node, sample), "");
  OpenGlb both(bytes);
  both.extension()["splitCount"] = both.extension()["interiorCount"] = 2000000000U;
  EXPECT_THAT(decode_failure(both.close(), tile.node, sample), HasSubstr("cannot come from"));
}

TEST(TileNormals, SANITIZED_RandomFlipsAreRefusedOrHarmless) {
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const SampleHierarchy sample = full_shaded(compression);
    std::size_t refused = 0;
    for (std::size_t round = share().index; round < 3000; round += share().count) {
      std::mt19937 random(13'000 + static_cast<std::uint32_t>(round));
      const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
      auto bytes = encode_tile(tile, sample.tree, sample.format);
      const std::size_t bin = OpenGlb(bytes).bin.size();
      bytes[bytes.size() - 1 - random() % bin] ^= static_cast<std::byte>(1U << random() % 8);
      if (!decode_failure(bytes, tile.node, sample).empty()) {
        ++refused;
        continue;
      }
      const PublishedTile read = read_shaded(bytes, tile.node, sample);
      expect_shades(read.shading, read.mesh);
    }
    EXPECT_GT(refused, share().part_of(3000) / 3);
  }
}

TEST(TileNormals, SANITIZED_RandomNumbersInTheJsonAreRefused) {
  const SampleHierarchy sample = full_shaded();
  const std::array<nlohmann::ordered_json, 5> values{-1, 0, 3, 4294967295U, "x"};
  for (std::size_t round = share().index; round < 1000; round += share().count) {
    std::mt19937 random(14'000 + static_cast<std::uint32_t>(round));
    const PublishedTile& tile = sample.tiles[random() % sample.tiles.size()];
    OpenGlb glb(encode_tile(tile, sample.tree, sample.format));
    const nlohmann::ordered_json flat = glb.json.flatten();
    auto place = flat.begin();
    std::advance(place, static_cast<std::ptrdiff_t>(random() % flat.size()));
    const auto& value = values[random() % values.size()];
    if (place.key().ends_with("rimCount"))  // a boundary may be larger than it need be
      continue;
    const bool same = place.value() == value;
    glb.json[nlohmann::ordered_json::json_pointer(place.key())] = value;
    EXPECT_EQ(decode_failure(glb.close(), tile.node, sample).empty(), same) << place.key() << value;
  }
}

}  // namespace
}  // namespace meshhier::tests

#include "render/tile_facets.h"

#include "base/srgb.h"
#include "render/mip_texture.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

constexpr TileVertex vertex(std::uint32_t number) {
  return static_cast<TileVertex>(number);
}

constexpr TileTriangle triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {vertex(a), vertex(b), vertex(c)};
}

/// Three own places, a ghost, and copies of places 1 and 2; an interior triangle and two border
/// ones.
PublishedTile sample_tile(const AttributeLayout& layout) {
  PublishedTile tile;
  TileMesh& mesh = tile.mesh;
  mesh.vertices.channels = mesh.copies.vertices.channels = layout.channels();
  const auto attributes = [&](float first) {
    std::vector<float> values(static_cast<std::size_t>(layout.channels()));
    for (float& value : values)
      value = first++;
    return values;
  };
  for (const float place : {0.0F, 1.0F, 2.0F, 3.0F})
    mesh.vertices.append({place, place * place, 1}, attributes(10 * (place + 1)));
  mesh.copies.vertices.append({1, 1, 1}, attributes(50));
  mesh.copies.vertices.append({2, 4, 1}, attributes(60));
  mesh.copies.places = {1, 2};
  mesh.own_count = mesh.boundary_count = 3;
  mesh.ghosts = {{1, 0}};
  mesh.interior = {triangle(0, 1, 2)};
  mesh.interior_wedges = {{0, 1, 0}};
  mesh.border = {triangle(0, 1, 3), triangle(1, 2, 3)};
  mesh.border_wedges = {{0, 0, 0}, {1, 1, 0}};
  return tile;
}

std::array<Vec3f, 3> positions(const Facet& facet) {
  return {facet[0].position, facet[1].position, facet[2].position};
}
std::array<Vec3f, 3> normals(const Facet& facet) {
  return {facet[0].normal, facet[1].normal, facet[2].normal};
}
using Three = std::array<Vec3f, 3>;

TEST(TileFacetsTest, InteriorTrianglesComeFirstThenTheBorderAskedFor) {
  const PublishedTile tile = sample_tile({});
  const std::vector<std::uint32_t> border{1};
  const auto facets = facets_of(tile, {}, border, NormalKind::own);
  ASSERT_EQ(facets.size(), 2U);
  EXPECT_EQ(positions(facets[0]), (Three{Vec3f{0, 0, 1}, {1, 1, 1}, {2, 4, 1}}));
  EXPECT_EQ(positions(facets[1]), (Three{Vec3f{1, 1, 1}, {2, 4, 1}, {3, 9, 1}}));
  EXPECT_EQ(normals(facets[0]), Three{});
  EXPECT_EQ(facets[0][0].colour, kPlainColour);
  EXPECT_EQ(facets_of(tile, {}, {}, NormalKind::own).size(), 1U);
}

TEST(TileFacetsTest, CopiesHaveNormalsOfTheirOwn) {
  const AttributeLayout layout{.normals = true};
  const std::vector<std::uint32_t> border{0, 1};
  const auto facets = facets_of(sample_tile(layout), layout, border, NormalKind::own);
  EXPECT_EQ(normals(facets[0]), (Three{Vec3f{10, 11, 12}, {50, 51, 52}, {30, 31, 32}}));
  EXPECT_EQ(normals(facets[1]), (Three{Vec3f{10, 11, 12}, {20, 21, 22}, {40, 41, 42}}));
  EXPECT_EQ(normals(facets[2]), (Three{Vec3f{50, 51, 52}, {60, 61, 62}, {40, 41, 42}}));
  for (const Facet& facet : facets_of(sample_tile(layout), layout, border, NormalKind::facets))
    EXPECT_EQ(normals(facet), Three{});
}

TEST(TileFacetsTest, ComputedNormalsAreTaken) {
  PublishedTile tile = sample_tile({});
  for (std::int8_t i = 0; i < 6; ++i)
    tile.shading.normals.push_back({i, 0, 100, 0});
  const auto facets = facets_of(tile, {}, {}, NormalKind::own);
  const auto& codes = tile.shading.normals;
  EXPECT_EQ(normals(facets[0]),
            (Three{normal_of(codes[0]), normal_of(codes[4]), normal_of(codes[2])}));
}

TEST(TileFacetsTest, SplitsLieWhereTheirVerticesDo) {
  PublishedTile tile = sample_tile({});
  for (std::int8_t i = 0; i < 8; ++i)
    tile.shading.normals.push_back({i, 0, 100, 0});
  tile.shading.split_of = {2, 4};  // those of place 2, and of the first copy
  tile.shading.interior = {triangle(0, 7, 6)};
  tile.shading.border = {triangle(0, 1, 3), triangle(4, 6, 3)};
  const std::vector<std::uint32_t> border{1};
  const auto facets = facets_of(tile, {}, border, NormalKind::own);
  const auto& codes = tile.shading.normals;
  EXPECT_EQ(positions(facets[0]), (Three{Vec3f{0, 0, 1}, {1, 1, 1}, {2, 4, 1}}));
  EXPECT_EQ(normals(facets[0]),
            (Three{normal_of(codes[0]), normal_of(codes[7]), normal_of(codes[6])}));
  EXPECT_EQ(normals(facets[1]),
            (Three{normal_of(codes[4]), normal_of(codes[6]), normal_of(codes[3])}));
  EXPECT_EQ(normals(facets_of(tile, {}, border, NormalKind::facets)[0]), Three{});
}

TEST(TileFacetsTest, ColoursAreLight) {
  for (const auto& [type, full] :
       {std::pair{ColourType::u8, 255.0}, {ColourType::u16, 65535.0}, {ColourType::f32, 1.0}}) {
    const AttributeLayout layout{.normals = true, .colour = type, .alpha = true};
    const auto facets = facets_of(sample_tile(layout), layout, {}, NormalKind::own);
    const Vec3f colour = facets[0][0].colour;
    EXPECT_EQ(colour.x, static_cast<float>(light_of(13 / full)));
    EXPECT_EQ(colour.z, static_cast<float>(light_of(15 / full)));
  }
}

TEST(TileFacetsTest, SkinsHaveTheCoordinatesOfCornersAndOfSplits) {
  PublishedTile tile = sample_tile({});
  tile.shading.split_of = {1};
  for (int i = 0; i < 7; ++i)
    tile.shading.texcoords.push_back({static_cast<float>(i), 0});
  tile.shading.interior = {triangle(0, 6, 2)};
  tile.shading.border = {triangle(0, 1, 3), triangle(4, 5, 3)};
  const MipTexture texture(images::Image(1, 1, 3));
  const std::vector<std::uint32_t> border{1};
  const auto skins = skins_of(tile, {}, texture, border);
  ASSERT_EQ(skins.size(), facets_of(tile, {}, border, NormalKind::facets).size());
  EXPECT_EQ(skins[0].texcoords, (std::array{Vec2f{0, 0}, Vec2f{6, 0}, Vec2f{2, 0}}));
  EXPECT_EQ(skins[1].texcoords, (std::array{Vec2f{4, 0}, Vec2f{5, 0}, Vec2f{3, 0}}));
  EXPECT_EQ(skins[1].texture, &texture);
}

TEST(TileFacetsTest, ColoursThatAreWhiteEverywhereAreNone) {
  AttributeLayout layout;
  layout.colour = ColourType::u8;
  std::vector<Facet> root(2);
  for (Facet& facet : root) {
    for (FacetCorner& corner : facet)
      corner.colour = {1, 1, 1};
  }
  EXPECT_EQ(drawn_layout(root, layout).colour, ColourType::none);
  root[1][2].colour = {1, 1, 0.9F};
  EXPECT_EQ(drawn_layout(root, layout).colour, ColourType::u8);
}

}  // namespace
}  // namespace meshhier::render

#include "render/repeated_facets.h"

#include "tests/render/drawn.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

std::vector<Facet> three_facets() {
  return {flat_facet({0, 0, 0}, {4, 0, 0}, {0, 4, 0}), flat_facet({1, 1, 2}, {7, 1, 2}, {1, 6, 3}),
          flat_facet({0, 0, 0}, {0, 4, 0}, {4, 0, 0})};
}

TEST(RepeatedFacetsTest, TheFirstOfEachPlaceStays) {
  std::vector<Facet> facets;
  for (int times = 0; times < 5; ++times) {
    for (Facet facet : three_facets()) {
      facet[0].colour = Vec3f{0.1F, 0.2F, 0.1F} * static_cast<float>(times);
      facets.push_back(facet);
    }
  }
  std::vector<Skin> skins;
  drop_repeated(facets, skins);
  ASSERT_EQ(facets.size(), 3U);
  EXPECT_TRUE(skins.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(facets[i][1].position, three_facets()[i][1].position);
    EXPECT_EQ(facets[i][0].colour, Vec3f{});
  }
}

TEST(RepeatedFacetsTest, SkinsStayWithTheirFacets) {
  std::vector<Facet> facets = three_facets();
  facets.insert(facets.begin() + 1, facets[0]);
  std::vector<Skin> skins(4);
  for (std::size_t i = 0; i < skins.size(); ++i)
    skins[i].texcoords[0].u = static_cast<float>(i);
  drop_repeated(facets, skins);
  ASSERT_EQ(skins.size(), 3U);
  EXPECT_EQ(skins[0].texcoords[0].u, 0);
  EXPECT_EQ(skins[1].texcoords[0].u, 2);
  EXPECT_EQ(skins[2].texcoords[0].u, 3);
}

TEST(RepeatedFacetsTest, ThePictureStaysTheSame) {
  std::vector<Facet> facets = facets_around_origin(tests::torus(700));
  const std::size_t count = facets.size();
  facets.insert(facets.end(), facets.begin(), facets.begin() + 300);
  const Camera camera(View{{-1, -2, -3}, {0, 1, 0}}, BoundsD{{-2, -2, -2}, {2, 2, 2}}, Framing{});
  const Raster whole = drawn(camera, facets);
  std::vector<Skin> skins;
  drop_repeated(facets, skins);
  EXPECT_LT(facets.size(), count + 300);
  const Raster fewer = drawn(camera, facets);
  for (std::size_t i = 0; i < whole.samples().size(); ++i) {
    ASSERT_EQ(fewer.samples()[i].depth, whole.samples()[i].depth);
    ASSERT_EQ(fewer.samples()[i].normal, whole.samples()[i].normal);
  }
}

}  // namespace
}  // namespace meshhier::render

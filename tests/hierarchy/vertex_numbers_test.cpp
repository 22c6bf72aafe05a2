#include "hierarchy/vertex_numbers.h"

#include <vector>

#include <gtest/gtest.h>

namespace meshhier {
namespace {

constexpr TileVertex vertex(std::uint32_t number) {
  return static_cast<TileVertex>(number);
}

TEST(VertexNumbers, CountTheCopiesOfAPlace) {
  const std::vector<std::uint32_t> places{1, 4, 4, 4, 7};
  EXPECT_EQ(wedges_of(places), (std::vector<Wedge>{{1, 1}, {4, 1}, {4, 2}, {4, 3}, {7, 1}}));
  EXPECT_TRUE(wedges_of({}).empty());
}

TEST(VertexNumbers, AreThoseOfPlacesThenOfCopies) {
  const VertexNumbers numbers(10, std::vector<std::uint32_t>{1, 4, 4, 7});
  EXPECT_EQ(numbers.number_of({4, 0}), 4U);
  EXPECT_EQ(numbers.number_of({1, 1}), 10U);
  EXPECT_EQ(numbers.number_of({4, 2}), 12U);
  EXPECT_EQ(numbers.number_of({7, 1}), 13U);
  for (std::uint32_t number = 0; number < 14; ++number)
    EXPECT_EQ(numbers.number_of(numbers[number]), number);
}

TEST(VertexNumbers, OfWedgesWithGapsAreInTheirOrder) {
  const VertexNumbers numbers(3, std::vector<Wedge>{{0, 5}, {2, 1}, {2, 70000}});
  EXPECT_EQ(numbers.number_of({0, 5}), 3U);
  EXPECT_EQ(numbers.number_of({2, 70000}), 5U);
  EXPECT_EQ(numbers[4], (Wedge{2, 1}));
}

TEST(VertexNumbers, GoIntoTrianglesAndBack) {
  const VertexNumbers numbers(5, std::vector<std::uint32_t>{1, 1, 3});
  const std::vector<TileTriangle> places{{vertex(0), vertex(1), vertex(3)},
                                         {vertex(1), vertex(1), vertex(4)}};
  const std::vector<CornerWedges> wedges{{0, 2, 1}, {0, 1, 0}};
  std::vector<TileTriangle> triangles = numbers.numbered(places, wedges);
  EXPECT_EQ(triangles, (std::vector<TileTriangle>{{vertex(0), vertex(6), vertex(7)},
                                                  {vertex(1), vertex(5), vertex(4)}}));
  EXPECT_EQ(numbers.split(triangles), wedges);
  EXPECT_EQ(triangles, places);
}

TEST(VertexNumbers, OfTrianglesWithoutWedgesAreTheirPlaces) {
  const VertexNumbers numbers(5, std::vector<std::uint32_t>{1});
  const std::vector<TileTriangle> places{{vertex(0), vertex(1), vertex(3)}};
  EXPECT_EQ(numbers.numbered(places, {}), places);
}

}  // namespace
}  // namespace meshhier

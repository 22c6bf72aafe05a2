#include "render/drawing_cost.h"

#include "tests/render/drawn.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

TEST(DrawingCostTest, IsTheAreaAndTheRows) {
  const Camera camera = square_camera(100);
  const std::vector<Facet> facets(3, flat_facet({0, 0, 0}, {40, 0, 0}, {0, 20, 0}));
  EXPECT_EQ(samples_to_draw(facets, camera), 3U * (400 + 20));
}

TEST(DrawingCostTest, NoFacetTakesMoreThanThePicture) {
  const std::vector<Facet> facets = {flat_facet({-1e30F, 0, 0}, {1e30F, 0, 0}, {0, 1e30F, 0})};
  EXPECT_EQ(samples_to_draw(facets, square_camera(100)), 10000U);
}

TEST(DrawingCostTest, WhatIsNotFiniteIsNotDrawn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Facet> facets = {flat_facet({nan, 0, 0}, {1, 0, 0}, {0, 1, 0})};
  EXPECT_EQ(samples_to_draw(facets, square_camera(100)), 0U);
}

}  // namespace
}  // namespace meshhier::render

#include "render/shown_view.h"

#include "tests/render/drawn.h"

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

SourceSummary with_values(const std::vector<ScalarAttribute>& values) {
  SourceSummary source;
  source.attributes.values = values;
  source.values.resize(values.size());
  for (ValueStatistics& one : source.values) {
    one.min = -2;
    one.max = 3;
  }
  return source;
}

TEST(ShownView, CutsInInputCoordinates) {
  ModelView view;
  EXPECT_TRUE(kept_of(view, {1, 2, 3}).empty());
  view.cut = {0, 0, 2, -8};  // kept: z >= 4
  const auto cut = kept_of(view, {0, 0, 10});
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_LE(cut[0].beyond({0, 0, -6}), 0);
  EXPECT_GT(cut[0].beyond({0, 0, -6.01}), 0);
  view = {};
  view.box = {0, 0, 0, 1, 1, 1};
  const auto box = kept_of(view, {0, 0, 10});
  ASSERT_EQ(box.size(), 6U);
  for (const HalfSpace& side : box)
    EXPECT_LT(side.beyond({0.5, 0.5, -9.5}), 0);
}

TEST(ShownView, StandsOnTheAxisAskedFor) {
  ModelView view;
  view.stretch = 3;
  for (const auto& [up, place] : std::vector<std::pair<std::string, Vec3d>>{{"file", {0, 0, 1}},
                                                                            {"x", {1, 0, 0}},
                                                                            {"-x", {-1, 0, 0}},
                                                                            {"y", {0, 1, 0}},
                                                                            {"-y", {0, -1, 0}},
                                                                            {"z", {0, 0, 1}},
                                                                            {"-z", {0, 0, -1}}}) {
    view.up = up;
    const Standing standing = standing_of(view, UpAxis::z);
    EXPECT_EQ(standing.upright(place), (Vec3d{0, 3, 0})) << up;
    EXPECT_EQ(standing.upwards(), place) << up;
  }
}

TEST(ShownView, TakesTheFirstAttributeForOneThatIsNotThere) {
  ModelView view;
  EXPECT_FALSE(attribute_of(view, with_values({{"a"}, {"b"}})));
  view.colours = "attribute";
  EXPECT_FALSE(attribute_of(view, with_values({})));
  view.attribute = "b";
  EXPECT_EQ(attribute_of(view, with_values({{"a"}, {"b"}}))->attribute, "b");
  view.attribute = "c";
  EXPECT_EQ(attribute_of(view, with_values({{"a"}, {"b"}}))->attribute, "a");
}

TEST(ShownView, PaintsWhatIsWithinTheToleranceInOneColour) {
  const SourceSummary source = with_values({{"d", ValueType::f32}});
  const AttributePainter painter(
      source,
      {.attribute = "d", .ramp = ColourRamp::coolwarm, .range = {{-1, 1}}, .tolerance = 0.25});
  const std::vector<float> values{-1, -0.25F, 0, 0.25F, 0.26F, 1};
  PublishedTile tile;
  tile.mesh.vertices.channels = 1;
  tile.mesh.vertices.positions.resize(values.size());
  tile.mesh.vertices.attributes = values;
  painter.paint(tile);
  const auto colour = [&](std::size_t v) {
    const auto channels = tile.mesh.vertices.attributes_of(v);
    return Vec3f{channels[0], channels[1], channels[2]};
  };
  const Vec3f band = kPlainColour;
  EXPECT_EQ(colour(0), ramp_colour(ColourRamp::coolwarm, 0));
  for (const std::size_t v : {1, 2, 3})
    EXPECT_EQ(colour(v), band);
  EXPECT_EQ(colour(4),
            ramp_colour(ColourRamp::coolwarm, (double{0.26F} - 0.25 + 0.75) / (0.75 + 0.75)));
  EXPECT_EQ(colour(5), ramp_colour(ColourRamp::coolwarm, 1));
}

TEST(ShownView, TellsWhatAPictureDoesNotShow) {
  ModelView view;
  EXPECT_EQ(not_drawn(view), "");
  view.wires = view.occlusion = true;
  view.cut = {1, 0, 0, 0};
  EXPECT_EQ(not_drawn(view), "wires, occlusion, the caps of cuts");
  view.caps = false;
  EXPECT_EQ(not_drawn(view), "wires, occlusion");
}

TEST(CutFacets, KeepWhatLiesInAllHalfSpaces) {
  SceneTile tile;
  tile.facets = {flat_facet({0, 0, 0}, {4, 0, 0}, {0, 4, 0}),
                 flat_facet({9, 0, 0}, {9, 0, 0}, {9, 0, 0}),
                 flat_facet({1, 1, 0}, {1, 1, 0}, {1, 1, 0})};
  const std::vector<HalfSpace> kept{HalfSpace{{1, 0, 0}, 2}};
  clip(tile, kept);
  double area = 0;
  for (const Facet& facet : tile.facets) {
    for (const FacetCorner& corner : facet)
      EXPECT_LE(corner.position.x, 2);
    area += length(cross(to_double(facet[1].position - facet[0].position),
                         to_double(facet[2].position - facet[0].position))) /
            2;
  }
  EXPECT_EQ(area, 6);
  EXPECT_EQ(tile.facets.size(), 3U);  // two pieces and a point
}

}  // namespace
}  // namespace meshhier::render

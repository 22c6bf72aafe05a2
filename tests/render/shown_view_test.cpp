#include "render/shown_view.h"

#include "render/interior.h"
#include "tests/render/drawn.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

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
  EXPECT_TRUE(kept_of(view, {0, 0, 1}, {1, 2, 3}).empty());
  view.cut = {0, 0, 2, -8};  // kept: z >= 4
  const auto cut = kept_of(view, {0, 0, 1}, {0, 0, 10});
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_LE(cut[0].beyond({0, 0, -6}), 0);
  EXPECT_GT(cut[0].beyond({0, 0, -6.01}), 0);
  view = {};
  view.box = {0, 0, 0, 1, 1, 1};
  const auto box = kept_of(view, {0, 0, 1}, {0, 0, 10});
  ASSERT_EQ(box.size(), 6U);
  for (const HalfSpace& side : box)
    EXPECT_LT(side.beyond({0.5, 0.5, -9.5}), 0);
}

TEST(ShownView, KeepsAStoreyWithItsFloorAndWithoutItsCeiling) {
  ModelView view;
  view.storey = {10, 13};
  const auto kept = kept_of(view, {0, 1, 0}, {0, 10, 0});
  const auto is_kept = [&](double y) {
    return std::ranges::all_of(kept, [&](const HalfSpace& half) {
      return half.beyond({5, y, -7}) <= 0;
    });
  };
  EXPECT_TRUE(is_kept(0));
  EXPECT_TRUE(is_kept(2.9));
  EXPECT_FALSE(is_kept(3));
  EXPECT_FALSE(is_kept(-0.1));
  view.cut = {1, 0, 0, -6};  // x >= 6
  EXPECT_EQ(kept_of(view, {0, 1, 0}, {0, 10, 0}).size(), 3U);
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

TEST(CutFacets, DropWhatTurnsItsBackToTheViewer) {
  const auto left_for = [](const Viewer& viewer) {
    SceneTile tile;
    tile.facets = {flat_facet({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}),  // looks along z
                   flat_facet({1, 0, 5}, {-1, 0, 5}, {0, 1, 5}),  // along -z
                   flat_facet({2, 2, 2}, {2, 2, 2}, {2, 2, 2})};  // a point
    tile.skins.resize(3);
    drop_backs(tile, viewer);
    EXPECT_EQ(tile.skins.size(), tile.facets.size());
    std::vector<float> depths;
    for (const Facet& facet : tile.facets)
      depths.push_back(facet[0].position.z);
    return depths;
  };
  EXPECT_EQ(left_for({{0, 0, 9}}), (std::vector<float>{0, 2}));
  EXPECT_EQ(left_for({{0, 0, 2}}), (std::vector<float>{0, 5, 2}));  // between the two
  EXPECT_EQ(left_for({{0, 0, -1}, true}), (std::vector<float>{5, 2}));
}

/// A closed box of squares of two triangles; its front sides look inwards, or all outwards.
TileMesh box_mesh(Vec3d size, bool is_inwards) {
  constexpr int kParts = 8;
  TileMesh mesh;
  std::map<std::array<int, 3>, TileVertex> vertices;
  const auto vertex_at = [&](const std::array<int, 3>& p) {
    const auto [at, is_new] =
        vertices.try_emplace(p, static_cast<TileVertex>(mesh.vertices.size()));
    if (is_new) {
      mesh.vertices.positions.push_back(
          to_float(Vec3d{p[0] * size.x / kParts, p[1] * size.y / kParts, p[2] * size.z / kParts}));
    }
    return at->second;
  };
  for (int i = 0; i < 6 * kParts * kParts; ++i) {
    const int face = i / (kParts * kParts), axis = face / 2;
    const auto at = [&](int right, int up) {
      std::array<int, 3> place{};
      place[axis] = face % 2 * kParts;
      place[(axis + 1) % 3] = i % kParts + right;
      place[(axis + 2) % 3] = i / kParts % kParts + up;
      return vertex_at(place);
    };
    const std::array corners{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
    for (const std::size_t last : {2, 3}) {
      TileTriangle triangle{corners[0], corners[last - 1], corners[last]};
      if ((face % 2 == 0) != is_inwards)
        std::swap(triangle[1], triangle[2]);
      mesh.interior.push_back(triangle);
    }
  }
  mesh.own_count = static_cast<std::uint32_t>(mesh.vertices.size());
  return mesh;
}

/// The same with a hole, as scans of rooms have them.
TileMesh open_box(Vec3d size, bool is_inwards) {
  TileMesh mesh = box_mesh(size, is_inwards);
  mesh.interior.pop_back();
  return mesh;
}

TEST(ShownView, LooksIntoRoomsAndNotIntoBodies) {
  constexpr Vec3d kUp{0, 0, 1};
  EXPECT_TRUE(is_interior(open_box({10, 8, 3}, true), kUp));
  EXPECT_FALSE(is_interior(open_box({10, 8, 3}, false), kUp));
  EXPECT_FALSE(is_interior(open_box({1, 1, 40}, true), kUp));  // a well has hardly any floor
  EXPECT_FALSE(is_interior(box_mesh({10, 8, 3}, true), kUp));  // a body, inside out
  EXPECT_FALSE(is_interior({}, kUp));
  ModelView view;
  EXPECT_TRUE(looks_in(view, open_box({10, 8, 3}, true), kUp));
  view.dollhouse = "off";
  EXPECT_FALSE(looks_in(view, open_box({10, 8, 3}, true), kUp));
  view.dollhouse = "on";
  EXPECT_TRUE(looks_in(view, open_box({10, 8, 3}, false), kUp));
}

TEST(ShownView, SeesParallelRaysAsLargeAtTheTargetAsInPerspective) {
  ModelView view;
  view.projection = "parallel";
  const Pose pose{{0, 0, 10}, {0, 0, 0}};
  const Framing framing{.width = 100, .height = 100, .samples = 1};
  Placement placement(view, UpAxis::y, {});
  const Sight sight = placement.look_from(pose, rays_of(view), framing);
  EXPECT_FALSE(placement.perspective());
  const Sight other = Placement({}, UpAxis::y, {}).look_from(pose, Rays::meet_in_the_eye, framing);
  EXPECT_EQ(sight.camera.pixel(), other.camera.pixel());
  const Vec3d near = sight.camera.on_grid({1, 2, 8}), far = sight.camera.on_grid({1, 2, -80});
  EXPECT_EQ(near.x, far.x);
  EXPECT_EQ(near.y, far.y);
  EXPECT_LT(near.z, far.z);
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

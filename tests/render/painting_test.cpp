#include "render/painting.h"

#include "base/bounds.h"
#include "tests/render/drawn.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

/// Each mesh is a tile.
Scene scene_of(const std::vector<tests::TestMesh>& meshes) {
  Scene scene;
  for (const tests::TestMesh& mesh : meshes)
    scene.boxes.push_back(bounds_of(mesh.positions));
  scene.load = [meshes](std::size_t i) {
    return SceneTile{facets_around_origin(meshes[i]), {}, nullptr};
  };
  return scene;
}

tests::TestMesh moved(tests::TestMesh mesh, Vec3f by) {
  for (Vec3f& position : mesh.positions)
    position = position + by;
  return mesh;
}

Camera camera_of(const Scene& scene, std::uint32_t width = 96, std::uint32_t height = 80) {
  return {View{{-1, -2, -3}, {0, 1, 0}}, scene.box(), Framing{.width = width, .height = height}};
}

TEST(PaintingTest, ThePictureDoesNotDependOnHowMuchIsDrawnAtATime) {
  const Scene scene = scene_of({tests::sphere(500), moved(tests::torus(700), {1.5F, 0.5F, -1})});
  const Camera camera = camera_of(scene);
  const images::Image whole = paint(scene, camera, {});
  for (const std::uint64_t bytes : {1U, 50000U, 123456U})
    EXPECT_EQ(paint(scene, camera, {.band_bytes = bytes}), whole) << bytes;
}

TEST(PaintingTest, TilesThatAreHeldAreDrawnAsLoadedOnes) {
  Scene scene = scene_of({tests::sphere(500), moved(tests::torus(700), {1.5F, 0.5F, -1})});
  const Camera camera = camera_of(scene);
  const images::Image loaded = paint(scene, camera, {});
  std::vector<SceneTile> tiles;
  for (std::size_t i = 0; i < scene.boxes.size(); ++i)
    tiles.push_back(scene.load(i));
  scene.held = tiles;
  scene.load = nullptr;
  EXPECT_EQ(paint(scene, camera, {}), loaded);
}

TEST(PaintingTest, TheGroundIsTransparentAndTheModelIsNot) {
  const Scene scene = scene_of({tests::sphere(2000)});
  const images::Image picture = paint(scene, camera_of(scene, 64, 64), {});
  EXPECT_EQ(picture.channels, 4U);
  EXPECT_EQ(picture.at(0, 0)[3], 0);
  EXPECT_EQ(picture.at(32, 32)[3], 255);
}

TEST(PaintingTest, NothingIsSeenOfAnEmptyScene) {
  Scene scene = scene_of({});
  const Camera camera(View{}, Vec3d{}, 1, Framing{.width = 5, .height = 3});
  EXPECT_EQ(paint(scene, camera, {}).texels, std::vector<std::uint8_t>(60));
}

TEST(PaintingTest, StepsAreToldAndMayEndIt) {
  const Scene scene = scene_of({tests::sphere(100), tests::torus(100)});
  const Camera camera = camera_of(scene);
  std::uint64_t steps = 0;
  const PaintingOptions options{.band_bytes = 60000, .step = [&] { ++steps; }};
  paint(scene, camera, options);
  EXPECT_EQ(steps, painting_steps(scene, camera, options));
  EXPECT_GT(steps, 4U);
  const auto stop = [] { throw std::runtime_error("enough"); };
  EXPECT_THROW(paint(scene, camera, {.step = stop}), std::runtime_error);
}

/// How far the brightness of a picture's inner pixels goes.
int contrast(const images::Image& picture) {
  int least = 255, most = 0;
  for (std::uint32_t y = 8; y + 8 < picture.height; ++y) {
    for (std::uint32_t x = 8; x + 8 < picture.width; ++x) {
      least = std::min<int>(least, picture.at(x, y)[1]);
      most = std::max<int>(most, picture.at(x, y)[1]);
    }
  }
  return most - least;
}

/// Waves of one degree of slope, up along z.
PublishedTile waves() {
  PublishedTile tile;
  for (int x = 0; x <= 64; x += 4) {
    for (int y = 0; y <= 64; y += 4)
      tile.mesh.vertices.positions.push_back(
          {static_cast<float>(x), static_cast<float>(y), x % 8 < 4 ? 0.0F : 0.07F});
  }
  tile.mesh.own_count = static_cast<std::uint32_t>(tile.mesh.vertices.size());
  const auto corner = [](std::uint32_t column, std::uint32_t row) {
    return static_cast<TileVertex>(17 * column + row);
  };
  for (std::uint32_t x = 0; x < 16; ++x) {
    for (std::uint32_t y = 0; y < 16; ++y) {
      tile.mesh.interior.push_back({corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)});
      tile.mesh.interior.push_back({corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)});
    }
  }
  return tile;
}

TEST(PaintingTest, HillsThatAreHardlySteepAreSeenAndColouredByHeight) {
  const PublishedTile tile = waves();
  Scene scene;
  scene.look = {.up = UpAxis::z, .terrain = terrain_of(tile, UpAxis::z)};
  ASSERT_TRUE(scene.look.terrain);
  scene.boxes = {Bounds{{0, 0, 0}, {64, 64, 0.07F}}};
  scene.load = [&](std::size_t) {
    SceneTile drawn = scene_tile(tile, {}, {});
    for (Facet& facet : drawn.facets) {
      for (FacetCorner& corner : facet)  // as smooth normals of such waves
        corner.normal = {corner.position.z > 0 ? 0.017F : -0.017F, 0, 1};
    }
    apply_look(scene.look, {}, drawn);
    return drawn;
  };
  const images::Image picture = paint(
      scene, Camera(View{}, scene.box(), Framing{.width = 64, .height = 64, .margin = 0}), {});
  EXPECT_GT(contrast(picture), 40);
}

}  // namespace
}  // namespace meshhier::render

#include "render/light_rig.h"

#include "base/bounds.h"
#include "render/reflection.h"

#include <cmath>

#include <gtest/gtest.h>

namespace meshhier::render {
namespace {

Camera looking(Vec3d direction, Vec3d up) {
  return {View{direction, up}, BoundsD{{-1, -1, -1}, {1, 1, 1}}, Framing{}};
}

TEST(LightRigTest, TheStudioMovesWithTheViewer) {
  const LightRig rig = studio({0, 1, 0});
  EXPECT_LT(rig.lamps[0].towards.x, 0);
  EXPECT_GT(rig.lamps[0].towards.y, 0);
  for (const Lamp& lamp : rig.lamps)
    EXPECT_NEAR(length(lamp.towards), 1, 1e-12);
  EXPECT_GT(rig.sky.x, rig.ground.x);
}

TEST(LightRigTest, TheSunIsInTheNorthwestOfAMapWhicheverAxisIsUp) {
  // From above, north up in the picture: z is up, y is north; or y is up, -z is north.
  for (const auto& [camera, up] : {std::pair{looking({0, 0, -1}, {0, 1, 0}), UpAxis::z},
                                   std::pair{looking({0, -1, 0}, {0, 0, -1}), UpAxis::y}}) {
    const LightRig rig = rig_of(RigName::sun, {}, camera, up);
    const Vec3d sun = rig.lamps[0].towards;
    EXPECT_LT(sun.x, -0.3);
    EXPECT_GT(sun.y, 0.3);
    EXPECT_GT(sun.z, 0.5);
    EXPECT_NEAR(rig.upward.z, 1, 1e-6);
  }
}

TEST(LightRigTest, UpIsTheModelsInEveryView) {
  const Vec3d up = upward_in(looking({0, 1, 0}, {0, 0, 1}), UpAxis::z);
  EXPECT_NEAR(up.y, 1, 1e-6);
}

TEST(ReflectionTest, MoreLightIsNotLessLightAndNoneIsMade) {
  const LightRig rig = studio({0, 1, 0});
  const Vec3d grey = reflected({.normal = {0, 0, 1}, .colour = {0.4, 0.4, 0.4}}, rig);
  const Vec3d white = reflected({.normal = {0, 0, 1}, .colour = {1, 1, 1}}, rig);
  EXPECT_GT(white.x, 2 * grey.x);
  // A white surface across the key sends back no more than falls on it, over pi.
  const Vec3d falls = rig.lamps[0].light + rig.lamps[1].light + rig.lamps[2].light + rig.sky;
  EXPECT_LT(white.x, falls.x / 3.14);
  EXPECT_GT(reflected({.normal = {0, -1, 0}, .colour = {0, 0, 0}}, rig).x, -1e-12);
}

}  // namespace
}  // namespace meshhier::render

#include "render/light_rig.h"

#include "base/angle.h"
#include "render/colour_ramp.h"

#include <cstdint>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kWarm = 0xfff4e4, kCool = 0xd4e2ff, kSkyBlue = 0xf1f5ff, kEarth = 0xffeedd;

/// From the viewer, radians to the right and up; of the sun from the south.
struct Angles {
  double right = 0, up = 0;
};

Vec3d towards(Angles from) {
  const UnitTurn around = turn_by(from.right), raised = turn_by(from.up);
  return {around.sine * raised.cosine, raised.sine, around.cosine * raised.cosine};
}

/// `ground`: what comes from below, as a part of what comes from above.
LightRig rig_of(Lamp key, double fill, double rim, double sky, double ground, Vec3d upward) {
  constexpr Angles kFill{1.1, 0.05}, kRim{2.3, 0.45};
  const Vec3d cool = screen_light(kCool);
  return {{key, Lamp{towards(kFill), cool * fill}, Lamp{towards(kRim), cool * rim}},
          upward,
          screen_light(kSkyBlue) * sky,
          screen_light(kEarth) * (ground * sky)};
}

/// From upright coordinates, y up, to the model's.
Vec3d in_model(Vec3d upright, UpAxis up) {
  return up == UpAxis::z ? Vec3d{upright.x, -upright.z, upright.y} : upright;
}

Vec3d seen(const Camera& camera, Vec3d direction) {
  const Vec3d turned = to_double(camera.turned(to_float(direction)));
  return turned * (1 / length(turned));
}

}  // namespace

LightRig studio(Vec3d upward) {
  constexpr Angles kKey{-0.75, 0.7};
  return rig_of({towards(kKey), screen_light(kWarm) * 2.9}, 0.35, 1.1, 1.25, 0.42, upward);
}

LightRig sunlight(const Camera& camera, UpAxis up) {
  constexpr Angles kSun{-2.36, 0.79};
  return rig_of({seen(camera, in_model(towards(kSun), up)), screen_light(kWarm) * 3}, 0, 0, 1.1,
                0.7, upward_in(camera, up));
}

Vec3d upward_in(const Camera& camera, UpAxis up) {
  return seen(camera, direction_of(up));
}

}  // namespace meshhier::render

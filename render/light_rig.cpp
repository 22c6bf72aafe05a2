#include "render/light_rig.h"

#include "base/angle.h"
#include "render/colour_ramp.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace meshhier::render {
namespace {

constexpr std::uint32_t kWarm = 0xfff4e4, kCool = 0xd4e2ff, kSkyBlue = 0xf1f5ff, kEarth = 0xffeedd;

struct Setup {
  LightAngles key;
  double strength = 0, fill = 0, rim = 0, sky = 0;
  double ground = 0;  ///< what comes from below, as a part of what comes from above
};

/// In the order of RigName.
constexpr std::array<Setup, 4> kSetups{{{{-0.75, 0.7}, 2.9, 0.35, 1.1, 1.25, 0.42},
                                        {{-1.4, 0.2}, 3.6, 0, 0, 0.4, 0.6},
                                        {{0, 0.1}, 0.7, 0, 0, 2.6, 0.9},
                                        {{-2.36, 0.79}, 3, 0, 0, 1.1, 0.7}}};

const Setup& setup_of(RigName name) {
  return kSetups[static_cast<std::size_t>(name)];
}

Vec3d towards(LightAngles from) {
  const UnitTurn around = turn_by(from.right), raised = turn_by(from.up);
  return {around.sine * raised.cosine, raised.sine, around.cosine * raised.cosine};
}

/// `towards_key`: by the view's axes.
LightRig rig_of(const Setup& setup, Vec3d towards_key, Vec3d upward) {
  constexpr LightAngles kFill{1.1, 0.05}, kRim{2.3, 0.45};
  const Vec3d cool = screen_light(kCool);
  return {{Lamp{towards_key, screen_light(kWarm) * setup.strength},
           Lamp{towards(kFill), cool * setup.fill}, Lamp{towards(kRim), cool * setup.rim}},
          upward,
          screen_light(kSkyBlue) * setup.sky,
          screen_light(kEarth) * (setup.ground * setup.sky)};
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

LightRig rig_of(RigName name, const std::optional<LightAngles>& key, const Camera& camera,
                UpAxis up) {
  const Setup& setup = setup_of(name);
  const Vec3d from = towards(key.value_or(setup.key));
  return rig_of(setup, name == RigName::sun ? seen(camera, in_model(from, up)) : from,
                upward_in(camera, up));
}

LightRig studio(Vec3d upward) {
  const Setup& setup = setup_of(RigName::studio);
  return rig_of(setup, towards(setup.key), upward);
}

Vec3d upward_in(const Camera& camera, UpAxis up) {
  return seen(camera, direction_of(up));
}

}  // namespace meshhier::render

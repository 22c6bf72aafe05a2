// What a surface sends to the viewer of the light that falls on it, as the viewer's page has it:
// glTF's dielectric material (Lambert below a GGX coat), and the tone curve of Khronos.
#pragma once

#include "hierarchy/vec.h"
#include "render/light_rig.h"

namespace meshhier::render {

/// Of what has no picture, and of pictures.
inline constexpr double kRoughness = 0.75, kPictureRoughness = 1;

struct Surface {
  Vec3d normal;  ///< of length 1, by the view's axes
  Vec3d colour;  ///< linear light, 0 to 1
  double roughness = kRoughness;
};

/// Linear light, 0 to more than 1, to a viewer far away.
Vec3d reflected(const Surface& surface, const LightRig& rig);

/// What a screen shows of it, 0 to 1, linear: colours stay, but what is too bright (Khronos PBR
/// Neutral, 2024).
Vec3d toned(Vec3d light);

}  // namespace meshhier::render

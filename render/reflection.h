// Computes the light that a surface sends to the viewer, as the viewer's page does: glTF's
// dielectric material (Lambert below a GGX coat), and the tone curve of Khronos.
#pragma once

#include "base/vec.h"
#include "render/light_rig.h"

namespace meshhier::render {

/// The roughness of plain surfaces, and of those with a picture.
inline constexpr double kRoughness = 0.75, kPictureRoughness = 1;

struct LitSurface {
  Vec3d normal;  ///< of length 1, by the view's axes
  Vec3d colour;  ///< linear light, 0 to 1
  double roughness = kRoughness;
};

/// Linear light, 0 to more than 1, to a viewer far away.
Vec3d reflected(const LitSurface& surface, const LightRig& rig);

/// Returns what a screen shows of the light, 0 to 1, linear: colours stay, but those that are too
/// bright (Khronos PBR Neutral, 2024).
Vec3d toned(Vec3d light);

}  // namespace meshhier::render

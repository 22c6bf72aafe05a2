// The lamps of a picture, those that the viewer's page has (viewer/src/scene/lighting.ts).
#pragma once

#include "base/vec.h"
#include "hierarchy/frame.h"
#include "render/camera.h"

#include <array>

namespace meshhier::render {

/// A lamp far away.
struct Lamp {
  Vec3d towards;  ///< of length 1, by the view's axes
  Vec3d light;    ///< of red, green and blue, on a surface across it
};

struct LightRig {
  std::array<Lamp, 3> lamps;
  Vec3d upward;       ///< where the sky is: of length 1, by the view's axes
  Vec3d sky, ground;  ///< on a surface that looks up, and down
};

/// A key at the upper left, a fill and a rim, which move with the viewer, below a bright sky.
/// `upward`: by the view's axes.
LightRig studio(Vec3d upward);
/// The sun in the northwest, as maps have it.
LightRig sunlight(const Camera& camera, UpAxis up);

/// Up, by the camera's axes.
Vec3d upward_in(const Camera& camera, UpAxis up);

}  // namespace meshhier::render

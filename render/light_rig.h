// The lamps of a picture, those that the viewer's page has (viewer/src/scene/lighting.ts).
#pragma once

#include "base/vec.h"
#include "hierarchy/frame.h"
#include "render/camera.h"

#include <array>
#include <cstdint>
#include <optional>

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

/// `studio`: a key at the upper left, a fill and a rim, which move with the viewer, below a bright
/// sky; `raking`: a key from aside; `flat`: from everywhere; `sun`: in the northwest of the model,
/// as maps have it.
enum class RigName : std::uint8_t { studio, raking, flat, sun };

/// Radians to the right and up: from the viewer, or of the sun from the south.
struct LightAngles {
  double right = 0, up = 0;
};

/// `key`: where the key light comes from; none: as the name says.
LightRig rig_of(RigName name, const std::optional<LightAngles>& key, const Camera& camera,
                UpAxis up);
/// `upward`: by the view's axes.
LightRig studio(Vec3d upward);

/// Up, by the camera's axes.
Vec3d upward_in(const Camera& camera, UpAxis up);

}  // namespace meshhier::render

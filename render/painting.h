// A picture of a scene, in a memory that does not grow with the scene or the picture's rows.
#pragma once

#include "images/image.h"
#include "render/camera.h"
#include "render/scene.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace meshhier::render {

struct PaintingOptions {
  /// Samples held at a time, but one row of pixels at least. The picture does not depend on it.
  std::uint64_t band_bytes = std::uint64_t{8} << 20;
  /// Called for each tile that is looked at, `count` of them or fewer; may throw, to end it all.
  std::function<void()> step = [] {};
};

/// How often tiles are looked at, at most.
std::uint64_t painting_steps(const Scene& scene, const Camera& camera,
                             const PaintingOptions& options);

/// Draws the scene as the viewer's page shows it, without its perspective. Alpha is how much of a
/// pixel is covered. Rows are drawn one band behind the other, on the calling thread. Throws what
/// scene.load and options.step throw.
images::Image paint(const Scene& scene, const Camera& camera, const PaintingOptions& options);

}  // namespace meshhier::render

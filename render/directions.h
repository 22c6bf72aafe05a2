// Where to look from, if nobody says it.
#pragma once

#include "base/vec.h"
#include "render/camera.h"

#include <cstdint>
#include <vector>

namespace meshhier::render {

/// So many views from all around, evenly spread over the sphere along a spiral (Saff & Kuijlaars,
/// Distributing many points on a sphere, 1997; turned by the golden angle). `up`: of each of them.
std::vector<View> views_around(std::uint32_t count, Vec3d up);

}  // namespace meshhier::render

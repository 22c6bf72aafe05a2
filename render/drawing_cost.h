// How much work it is to draw a tile: triangles may cover each other many times.
#pragma once

#include "render/camera.h"
#include "render/facet.h"

#include <cstdint>
#include <span>

namespace meshhier::render {

/// About how many samples are looked at to draw these, at most those of the whole picture for each.
/// A sum of integers. Linear.
std::uint64_t samples_to_draw(std::span<const Facet> facets, const Camera& camera);

}  // namespace meshhier::render

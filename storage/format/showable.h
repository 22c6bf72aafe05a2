// Attributes as the standard accessors of glTF may hold them (docs/file_format.md, section 4.7).
#pragma once

#include "base/vec.h"
#include "hierarchy/attributes.h"
#include "hierarchy/tile_mesh.h"

#include <vector>

namespace meshhier::storage {

/// Whether glTF lets `normal` stand as it is: its length differs from 1 by 0.001 at most (the
/// Khronos validator allows 0.00674).
bool is_unit_normal(Vec3f normal);

/// Returns all channels of all vertices: u8 and u16 colours are rounded to the nearest number of
/// their type, float colours clamped to [0, 1], normals brought to unit length ((0, 0, 1) if they
/// have none); NaN and infinities become 0.
std::vector<float> showable_attributes(const AttributeLayout& layout, const VertexArray& vertices);

}  // namespace meshhier::storage

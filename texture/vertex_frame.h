// In what frame a viewer reads a normal map.
//
// glTF viewers with tangents interpolate a vertex's normal, tangent and bitangent, bring each of
// them to unit length, and add them up by red, green and blue. A map is exact only if it was
// written for that frame, with the vertices' numbers as they are rounded in the file.
#pragma once

#include "base/lane_vector.h"
#include "base/vec.h"
#include "hierarchy/tangent_code.h"
#include "texture/chart_layout.h"
#include "texture/texel_samples.h"

#include <array>

namespace meshhier::texture {

/// In single precision, as viewers have it.
struct VertexFrame {
  FourFloats tangent{}, bitangent{}, normal{};

  FourFloats mixed(FourFloats coefficients) const {
    return tangent * coefficients[0] + bitangent * coefficients[1] + normal * coefficients[2];
  }
};

/// The tangent of a vertex: where on a surface with its normal the picture's u grows, as a
/// projection along the chart's normal has it. Nearly that of MikkTSpace, which some programs
/// compute whatever a file has.
TangentCode tangent_of(const ChartPlane& plane, const Vec3f& normal);

VertexFrame frame_of(const Vec3f& normal, const TangentCode& tangent);

/// At a point of a triangle, from its corners.
VertexFrame interpolated(const VertexFrame& a, const VertexFrame& b, const VertexFrame& c,
                         const CornerWeights& weights);

}  // namespace meshhier::texture

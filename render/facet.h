// Facets: triangles in space, which are drawn.
#pragma once

#include "base/vec.h"
#include "hierarchy/texture.h"

#include <array>
#include <cmath>

namespace meshhier::render {

/// The light of surfaces without colours, linear: 0xb9b4ab of a screen, as the viewer has it.
inline constexpr Vec3f kPlainColour{0.485150F, 0.456411F, 0.407240F};

struct FacetCorner {
  Vec3f position;
  Vec3f normal;                 ///< of any length; without direction (0, not finite): the facet's
  Vec3f colour = kPlainColour;  ///< linear light, 0 to 1
};

/// Both of its sides are seen. As with materials of glTF that are two-sided, normals are those of
/// the side from which the corners turn counter-clockwise; from the other side they are turned
/// round.
using Facet = std::array<FacetCorner, 3>;

class MipTexture;

/// Pictures of a facet, in place of its corners' colours or tinted by them.
struct Skin {
  const MipTexture* texture = nullptr;     ///< none: colours stay
  std::array<Vec2f, 3> texcoords{};        ///< of the corners
  bool is_tinted = false;                  ///< its light is multiplied by that of the colours
  const MipTexture* normal_map = nullptr;  ///< of the same coordinates: numbers, as glTF has them
  std::array<Vec3f, 3> tangents{};         ///< of the corners, of any length
  bool is_mirrored = false;                ///< the bitangent is on the other side
};

/// The direction of a vector, of length 1; 0 if it has none.
inline Vec3f unit_or_zero(Vec3f vector) {
  const Vec3d wide = to_double(vector);
  const double size = length(wide);  // squares of floats are in range
  return size > 0 && std::isfinite(size) ? to_float(wide * (1 / size)) : Vec3f{};
}

}  // namespace meshhier::render

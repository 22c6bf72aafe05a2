// The normal map of a simplified tile: what its triangles are too few to show of the shading of the
// original surface (Cohen, Olano & Manocha, Appearance-preserving simplification, 1998).
//
// Charts are those of a picture (charted_tile.h). Each texel has the original's direction at its
// point of the finer surfaces (finer_points.h), found level by level: a tile passes on what its
// texels have, and the lookup between them does not blur (normal_texels.h). Then the map is written
// for the tile's own frame, a little sharper than it is, as viewers filter texels once more
// (chart_map.h).
#pragma once

#include "base/vec.h"
#include "hierarchy/tile_mesh.h"
#include "images/image.h"
#include "texture/bake.h"
#include "texture/corners.h"
#include "texture/normal_texels.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace meshhier::texture {

/// Normals of a triangle's corners, of any length; 0: it has no direction there.
using CornerNormals = std::array<Vec3f, 3>;

/// A surface whose directions are known: at its corners, or on texels.
struct NormalSurface {
  std::span<const Vec3f> positions;
  std::span<const TileTriangle> triangles;   ///< numbers of positions
  std::span<const CornerNormals> normals;    ///< one a triangle; empty: it has texels
  std::span<const CornerTexcoords> corners;  ///< likewise, in `texels`
  const NormalTexels* texels = nullptr;
  std::span<const std::uint32_t> beside{};  ///< as TexturedSurface has it
};

struct BakedNormalMap {
  images::Image map;                     ///< 3 channels, as glTF has it; flat between charts; empty
                                         ///< if the tile wants none
  std::vector<CornerTexcoords> corners;  ///< one a triangle; multiples of 1 / 65535
  std::vector<CornerTangents> tangents;  ///< one a triangle
  NormalTexels texels;                   ///< for the next coarser tile
  float texel = 0;                       ///< size of a texel on the surface
  std::uint32_t vertices = 0;  ///< of all charts: a vertex counts once for each that it is in
  double own_degrees = 0;      ///< mean angle between the tile's own shading and the original's
  double map_degrees = 0;      ///< the same with the map, before it is encoded; without a map as
                               ///< `texels` lets expect
};

/// Bakes the map of a tile, with larger texels or smaller ones. Deterministic, single-threaded.
class NormalBaker {
 public:
  /// `tile`: the coarse tile with its normals at corners, and a triangle. `finer`: what it was made
  /// of and what lies around it, in a fixed order. All of them must outlive it. `side`: of a map,
  /// texels at most, as BakeSize has it. O(t) if triangles are in order.
  NormalBaker(const NormalSurface& tile, std::span<const NormalSurface> finer, std::uint32_t side);
  ~NormalBaker();
  NormalBaker(const NormalBaker&) = delete;
  NormalBaker& operator=(const NormalBaker&) = delete;

  /// No texel is smaller than `least_texel`. A tile whose own shading is off by less than
  /// `least_degrees` wants no map. Equal triangles get equal corners. Does not depend on what was
  /// baked before. O(t log t) the first time, for charts, and O(t + texels) then.
  BakedNormalMap bake(float least_texel, double least_degrees = 0);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace meshhier::texture

// The finer surfaces that a tile's picture and normal map are baked from.
#pragma once

#include "pipeline/tiles/forest.h"
#include "pipeline/tiles/texture_store.h"
#include "texture/bake.h"
#include "texture/corners.h"
#include "texture/finer_points.h"
#include "texture/normal_bake.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace meshhier::pipeline {

/// Returns a tile's places and triangles, interior ones first, without picture or directions.
/// `parents`: BakeSource::parents.
BakeSource bare_source(const TileMesh& mesh, std::vector<std::uint16_t> parents);

/// A finer surface, or the part of it that lies near the border of the tile.
struct FinerSurface {
  std::shared_ptr<const BakeSource> source;
  std::vector<TileTriangle> triangles{};  ///< empty: all
  std::vector<texture::CornerTexcoords> corners{};
  std::vector<texture::CornerNormals> normals{};
  std::vector<std::uint32_t> beside{};  ///< for each place one of the tile's, or kNoVertex

  texture::FinerShape shape() const;
  texture::TexturedSurface surface() const;
  texture::NormalSurface normal_surface() const;
};

/// Returns the node's tiles of a finer level, then those of its neighbours, as far as they are near
/// the border of its tile. `source(tile)`: returns that tile's surface, with parents in the node's
/// level. Those without triangles are left out.
std::vector<FinerSurface> finer_surfaces(
    const Forest& forest, NodeId node, Level finer, const TileMesh& mesh,
    const std::function<std::shared_ptr<const BakeSource>(NodeId tile)>& source);

}  // namespace meshhier::pipeline

// A scene: all that a picture shows, tile by tile, as it is more than memory holds.
#pragma once

#include "base/bounds.h"
#include "hierarchy/attributes.h"
#include "hierarchy/frame.h"
#include "hierarchy/published.h"
#include "render/facet.h"
#include "render/light_rig.h"
#include "render/mip_texture.h"
#include "render/raster.h"
#include "render/shade.h"
#include "render/terrain.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meshhier::render {

/// A tile, ready to be drawn.
struct SceneTile {
  std::vector<Facet> facets;
  std::vector<Skin> skins;                    ///< of the facets; empty: they have their colours
  std::unique_ptr<const MipTexture> texture;  ///< what the skins show
  std::unique_ptr<const MipTexture> normal_map{};

  void draw(Raster& raster) const;
};

/// The interior triangles of a tile, and the border triangles asked for: which of tile.mesh.border.
/// `layout`: of its attributes. Those that hide exactly behind another are left out
/// (drop_repeated()). Decodes its picture, and throws Error(input) if that is broken. Requires as
/// facets_of().
SceneTile scene_tile(const PublishedTile& tile, const AttributeLayout& layout,
                     std::span<const std::uint32_t> border);
/// The same with all of its border.
SceneTile scene_tile(const PublishedTile& tile, const AttributeLayout& layout);

/// How all of a scene is shown.
struct Look {
  Light light = Light::lamps;  ///< that falls on it
  bool has_pictures = false;
  UpAxis up = UpAxis::y;
  std::optional<Terrain> terrain{};  ///< it is one: the sun is on it, and slopes are lit steeper
  std::optional<RigName> rig{};      ///< none: the sun over terrains, a studio around all else
  std::optional<LightAngles> key{};  ///< where its key light comes from
  bool takes_heights = true;         ///< a terrain without colours has those of heights
  std::optional<HeightRange> heights{};  ///< the colours of heights are shown
  double stretch = 1;                    ///< heights are shown so many times as high
  bool is_flat = false;                  ///< each facet has its own normal
  bool has_cavities = true;              ///< as that of Lighting

  RigName shown_rig() const {
    return rig.value_or(terrain && terrain->is_upright ? RigName::sun : RigName::studio);
  }
};

/// Terrains under the sun, or seen from their front, get steeper slopes, and those without colours
/// the colours of heights. `layout`: of the tile, as it is drawn.
void apply_look(const Look& look, const AttributeLayout& layout, SceneTile& tile);

Lighting lighting_of(const Look& look, const Camera& camera);

struct Scene {
  std::vector<Bounds> boxes;                        ///< of the tiles; all that they draw is there
  std::function<SceneTile(std::size_t tile)> load;  ///< the same whenever it is asked
  Look look{};
  std::span<const SceneTile> held{};  ///< all of the tiles: none is loaded; or empty

  BoundsD box() const;
};

}  // namespace meshhier::render

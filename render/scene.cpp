#include "render/scene.h"

#include "hierarchy/cut.h"
#include "images/image_codec.h"
#include "render/repeated_facets.h"
#include "render/tile_facets.h"

#include <numeric>

namespace meshhier::render {

void SceneTile::draw(Raster& raster) const {
  if (skins.empty())
    return raster.draw(facets);
  for (std::size_t i = 0; i < facets.size(); ++i)
    raster.draw(facets[i], skins[i]);
}

SceneTile scene_tile(const PublishedTile& tile, const AttributeLayout& layout,
                     std::span<const std::uint32_t> border) {
  SceneTile result;
  result.facets = facets_of(tile, layout, border, NormalKind::own);
  const TileImage& image = tile.image;
  if (!image.empty()) {
    const std::uint64_t texels = std::uint64_t{image.width} * image.height;
    result.texture = std::make_unique<const MipTexture>(
        images::decode_image(image.bytes, "the picture of tile " + to_text(tile.node), texels),
        Wraps{Wrap::clamp, Wrap::clamp}, image.alpha);
    result.skins = skins_of(tile, layout, *result.texture, border);
  }
  if (const TileImage& map = tile.normal_map; !map.empty()) {
    const std::uint64_t texels = std::uint64_t{map.width} * map.height;
    result.normal_map = std::make_unique<const MipTexture>(
        images::decode_image(map.bytes, "the normal map of tile " + to_text(tile.node), texels),
        Wraps{Wrap::clamp, Wrap::clamp}, AlphaMode::opaque, TexelKind::numbers);
    add_normal_map(tile, *result.normal_map, border, result.skins);
  }
  drop_repeated(result.facets, result.skins);
  return result;
}

SceneTile scene_tile(const PublishedTile& tile, const AttributeLayout& layout) {
  std::vector<std::uint32_t> border(tile.mesh.border.size());
  std::iota(border.begin(), border.end(), 0U);
  return scene_tile(tile, layout, border);
}

void apply_look(const Look& look, const AttributeLayout& layout, SceneTile& tile) {
  const auto& terrain = look.terrain;
  if (terrain && (look.shown_rig() == RigName::sun || !terrain->is_upright))
    shade_steeper(*terrain, terrain->relief(terrain->is_upright ? look.stretch : 1), tile.facets);
  if (look.heights)
    colour_by_height(*look.heights, tile.facets);
  else if (terrain && look.takes_heights && !look.has_pictures && !layout.has_colours())
    colour_by_height({terrain->along, terrain->low, terrain->high}, tile.facets);
  if (look.is_flat) {
    for (Facet& facet : tile.facets) {
      for (FacetCorner& corner : facet)
        corner.normal = {};
    }
  }
}

Lighting lighting_of(const Look& look, const Camera& camera) {
  return {.kind = look.light,
          .rig = rig_of(look.shown_rig(), look.key, camera, look.up),
          .roughness = look.has_pictures ? kPictureRoughness : kRoughness,
          .has_cavities = look.has_cavities};
}

BoundsD Scene::box() const {
  BoundsD box;
  for (const Bounds& tile : boxes) {
    if (!tile.empty())
      box.add(BoundsD{to_double(tile.min), to_double(tile.max)});
  }
  return box;
}

}  // namespace meshhier::render

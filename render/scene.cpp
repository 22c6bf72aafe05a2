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
  if (!look.terrain)
    return;
  shade_steeper(*look.terrain, tile.facets);
  if (!look.has_pictures && !layout.has_colours())
    colour_by_height(*look.terrain, tile.facets);
}

Lighting lighting_of(const Look& look, const Camera& camera) {
  const bool is_sunlit = look.terrain && look.terrain->is_upright;
  return {.kind = look.light,
          .rig = is_sunlit ? sunlight(camera, look.up) : studio(upward_in(camera, look.up)),
          .roughness = look.has_pictures ? kPictureRoughness : kRoughness};
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

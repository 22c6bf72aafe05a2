#include "inspection/clip_scene.h"

#include "export/triangle_clipper.h"

#include <utility>
#include <vector>

namespace meshhier::inspection {
namespace {

/// Colours, which are light already, and tangents.
constexpr std::size_t kMixedChannels = 6;

exporting::ClippedCorner corner_of(const render::FacetCorner& from, Vec2f texcoord,
                                   const Vec3f& tangent) {
  exporting::ClippedCorner corner;
  corner.position = from.position;
  corner.normal = from.normal;
  corner.attributes = {from.colour.x, from.colour.y, from.colour.z,
                       tangent.x,     tangent.y,     tangent.z};
  corner.texcoord = texcoord;
  return corner;
}

render::FacetCorner facet_corner(const exporting::ClippedCorner& from) {
  return {from.position, from.normal, {from.attributes[0], from.attributes[1], from.attributes[2]}};
}

Vec3f tangent_of(const exporting::ClippedCorner& from) {
  return {from.attributes[3], from.attributes[4], from.attributes[5]};
}

}  // namespace

render::SceneTile clip_scene(render::SceneTile tile, const exporting::Region& region) {
  const exporting::CornerMixer mixer({}, kMixedChannels);
  const exporting::TriangleClipper clipper(region, mixer);
  std::vector<render::Facet> facets;
  std::vector<render::Skin> skins;
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    const render::Facet& facet = tile.facets[i];
    const render::Skin skin = tile.skins.empty() ? render::Skin{} : tile.skins[i];
    exporting::ClippedPolygon triangle;
    for (std::size_t k = 0; k < 3; ++k)
      triangle.push_back(corner_of(facet[k], skin.texcoords[k], skin.tangents[k]));
    for (const exporting::ClippedPolygon& piece : clipper.pieces(std::move(triangle))) {
      for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
        facets.push_back(
            {facet_corner(piece[0]), facet_corner(piece[k]), facet_corner(piece[k + 1])});
        if (tile.skins.empty())
          continue;
        render::Skin& made = skins.emplace_back(skin);
        made.texcoords = {piece[0].texcoord, piece[k].texcoord, piece[k + 1].texcoord};
        made.tangents = {tangent_of(piece[0]), tangent_of(piece[k]), tangent_of(piece[k + 1])};
      }
    }
  }
  tile.facets = std::move(facets);
  tile.skins = std::move(skins);
  return tile;
}

}  // namespace meshhier::inspection

#include "render/cut_facets.h"

#include "base/clip_polygon.h"

#include <algorithm>

namespace meshhier::render {
namespace {

Vec3f mixed_vector(const Vec3f& from, const Vec3f& to, double part) {
  const Vec3d a = to_double(from);
  return to_float(a + (to_double(to) - a) * part);
}

FacetCorner facet_corner(const CutCorner& corner) {
  return {to_float(corner.place), corner.normal, corner.colour};
}

}  // namespace

CutCorner mixed(const CutCorner& from, const CutCorner& to, double part) {
  const auto at = [part](float a, float b) { return static_cast<float>(a + (b - a) * part); };
  return {from.place + (to.place - from.place) * part,
          mixed_vector(from.normal, to.normal, part),
          mixed_vector(from.colour, to.colour, part),
          {at(from.texcoord.u, to.texcoord.u), at(from.texcoord.v, to.texcoord.v)},
          mixed_vector(from.tangent, to.tangent, part)};
}

void clip(CutPolygon& polygon, std::span<const HalfSpace> kept) {
  CutPolygon left;
  for (const HalfSpace& half : kept) {
    clip_at(
        polygon, [&](const CutCorner& corner) { return half.beyond(corner.place); },
        [](const CutCorner& from, const CutCorner& to, double a, double b) {
          return mixed(from, to, a / (a - b));
        },
        left);
    polygon.swap(left);
  }
}

CutPolygon polygon_of(const SceneTile& tile, std::size_t facet) {
  const Skin skin = tile.skins.empty() ? Skin{} : tile.skins[facet];
  CutPolygon polygon;
  for (std::size_t k = 0; k < 3; ++k) {
    const FacetCorner& corner = tile.facets[facet][k];
    polygon.push_back({to_double(corner.position), corner.normal, corner.colour, skin.texcoords[k],
                       skin.tangents[k]});
  }
  return polygon;
}

void CutFacets::add(std::size_t facet, const CutCorner& a, const CutCorner& b, const CutCorner& c) {
  facets_.push_back({facet_corner(a), facet_corner(b), facet_corner(c)});
  if (tile_.skins.empty())
    return;
  Skin& skin = skins_.emplace_back(tile_.skins[facet]);
  skin.texcoords = {a.texcoord, b.texcoord, c.texcoord};
  skin.tangents = {a.tangent, b.tangent, c.tangent};
}

void drop_backs(SceneTile& tile, const Viewer& viewer) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    const Facet& facet = tile.facets[i];
    const Vec3d corner = to_double(facet[0].position);
    const Vec3d normal =
        cross(to_double(facet[1].position) - corner, to_double(facet[2].position) - corner);
    if (dot(normal, viewer.seen_from(corner)) <= 0 && normal != Vec3d{})
      continue;
    tile.facets[count] = facet;
    if (!tile.skins.empty())
      tile.skins[count] = tile.skins[i];
    ++count;
  }
  tile.facets.resize(count);
  tile.skins.resize(std::min(count, tile.skins.size()));
}

void clip(SceneTile& tile, std::span<const HalfSpace> kept) {
  if (kept.empty())
    return;
  CutFacets cut(tile);
  for (std::size_t i = 0; i < tile.facets.size(); ++i) {
    CutPolygon polygon = polygon_of(tile, i);
    clip(polygon, kept);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
      cut.add(i, polygon[0], polygon[k], polygon[k + 1]);
  }
  cut.put();
}

}  // namespace meshhier::render

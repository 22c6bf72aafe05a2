#include "render/tile_facets.h"

#include "hierarchy/shown_corners.h"
#include "render/vertex_light.h"

#include <algorithm>
#include <cstddef>

namespace meshhier::render {
namespace {

/// The corners that a tile's vertices are, each by its number in the file.
class TileCorners {
 public:
  TileCorners(const PublishedTile& tile, const AttributeLayout& layout, NormalKind normals)
      : tile_(tile),
        given_normals_(layout.part(AttributeKind::normals)),
        light_(layout),
        normals_(normals) {}

  Facet facet(const TileTriangle& t) const { return {corner(t[0]), corner(t[1]), corner(t[2])}; }
  Facet point(TileVertex number) const { return facet({number, number, number}); }

 private:
  /// A vertex among the first ones of places, or among copies.
  struct Source {
    const VertexArray& array;
    std::size_t index;
  };

  std::size_t vertex_count() const { return tile_.mesh.vertices.size() + tile_.mesh.copies.size(); }

  Source source(std::size_t vertex) const {
    const std::size_t places = tile_.mesh.vertices.size();
    return vertex < places ? Source{tile_.mesh.vertices, vertex}
                           : Source{tile_.mesh.copies.vertices, vertex - places};
  }

  FacetCorner corner(TileVertex number) const {
    const std::size_t n = vertex_count();
    const std::size_t vertex =
        raw(number) < n ? raw(number) : tile_.shading.split_of[raw(number) - n];
    const Source from = source(vertex);
    const auto attributes = from.array.attributes_of(from.index);
    return {from.array.positions[from.index], normal(raw(number), attributes),
            light_.of(attributes)};
  }

  Vec3f normal(std::size_t number, std::span<const float> attributes) const {
    if (normals_ == NormalKind::facets)
      return {};
    if (!tile_.shading.normals.empty())
      return normal_of(tile_.shading.normals[number]);
    return given_normals_.count > 0 ? channels(attributes, given_normals_) : Vec3f{};
  }

  static Vec3f channels(std::span<const float> attributes, const AttributePart& part) {
    const auto three = part.of(attributes);
    return {three[0], three[1], three[2]};
  }

  const PublishedTile& tile_;
  AttributePart given_normals_;
  VertexLight light_;
  NormalKind normals_;
};

/// The interior triangles, then the border triangles asked for, with numbers of the file.
std::vector<TileTriangle> drawn_triangles(const PublishedTile& tile,
                                          std::span<const std::uint32_t> border) {
  std::vector<TileTriangle> triangles = shown_interior(tile);
  const std::vector<TileTriangle> all_border = shown_border(tile);
  for (const std::uint32_t i : border)
    triangles.push_back(all_border[i]);
  return triangles;
}

}  // namespace

std::vector<Facet> facets_of(const PublishedTile& tile, const AttributeLayout& layout,
                             std::span<const std::uint32_t> border, NormalKind normals) {
  const TileCorners corners(tile, layout, normals);
  std::vector<Facet> facets;
  for (const TileTriangle& triangle : drawn_triangles(tile, border))
    facets.push_back(corners.facet(triangle));
  return facets;
}

std::vector<Facet> points_of(const PublishedTile& tile, const AttributeLayout& layout) {
  const TileCorners corners(tile, layout, NormalKind::own);
  std::vector<Facet> points;
  for (std::uint32_t v = 0; v < tile.mesh.own_count; ++v)
    points.push_back(corners.point(static_cast<TileVertex>(v)));
  return points;
}

std::vector<Skin> skins_of(const PublishedTile& tile, const AttributeLayout& layout,
                           const MipTexture& texture, std::span<const std::uint32_t> border) {
  const auto at = [&](TileVertex number) { return tile.shading.texcoords[raw(number)]; };
  const bool is_tinted = layout.tints && layout.has_colours();
  std::vector<Skin> skins;
  for (const TileTriangle& t : drawn_triangles(tile, border))
    skins.push_back({&texture, {at(t[0]), at(t[1]), at(t[2])}, is_tinted});
  return skins;
}

void add_normal_map(const PublishedTile& tile, const MipTexture& normal_map,
                    std::span<const std::uint32_t> border, std::vector<Skin>& skins) {
  const Shading& shading = tile.shading;
  const std::vector<TileTriangle> triangles = drawn_triangles(tile, border);
  skins.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TileTriangle& t = triangles[i];
    Skin& skin = skins[i];
    skin.normal_map = &normal_map;
    for (std::size_t k = 0; k < 3; ++k) {
      const TangentCode& tangent = shading.tangents[raw(t[k])];
      skin.texcoords[k] = shading.texcoords[raw(t[k])];
      skin.tangents[k] = {float(tangent[0]), float(tangent[1]), float(tangent[2])};
      skin.is_mirrored = tangent[3] < 0;
    }
  }
}

AttributeLayout drawn_layout(std::span<const Facet> root, AttributeLayout layout) {
  const auto is_white = [](const Facet& facet) {
    return std::ranges::all_of(facet, [](const FacetCorner& corner) {
      return corner.colour == Vec3f{1, 1, 1};
    });
  };
  if (std::ranges::all_of(root, is_white))
    layout.colour = ColourType::none;
  return layout;
}

}  // namespace meshhier::render

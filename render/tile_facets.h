// The triangles of a tile, as they are drawn.
#pragma once

#include "hierarchy/attributes.h"
#include "hierarchy/published.h"
#include "render/facet.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meshhier::render {

/// Which normals a tile is drawn with. `own`: the computed ones, else those of the input, else
/// facets.
enum class NormalKind { own, facets };

/// The interior triangles of a tile, then the border triangles asked for. `layout`: of its
/// attributes; colours are those of a screen. `border`: which of tile.mesh.border, each below its
/// size. Requires a tile that is consistent by itself, as storage::decode_tile checks it. Linear.
std::vector<Facet> facets_of(const PublishedTile& tile, const AttributeLayout& layout,
                             std::span<const std::uint32_t> border, NormalKind normals);

/// The own vertices of a tile, each as a facet without area. Requires as facets_of(). Linear.
std::vector<Facet> points_of(const PublishedTile& tile, const AttributeLayout& layout);

/// The skins of the same facets: the tile's own coordinates in `texture`, its picture; tinted as
/// `layout` has it. Requires a tile that has texture coordinates of its own, and triangles.
std::vector<Skin> skins_of(const PublishedTile& tile, const AttributeLayout& layout,
                           const MipTexture& texture, std::span<const std::uint32_t> border);

/// Gives the skins of the same facets the tile's normal map; without skins, those that let colours
/// stay. Requires a tile that has one.
void add_normal_map(const PublishedTile& tile, const MipTexture& normal_map,
                    std::span<const std::uint32_t> border, std::vector<Skin>& skins);

/// `layout` as it is drawn where the root tile has these facets: without colours if all of them are
/// white. Such colours say nothing, and would hide the form.
AttributeLayout drawn_layout(std::span<const Facet> root, AttributeLayout layout);

}  // namespace meshhier::render
